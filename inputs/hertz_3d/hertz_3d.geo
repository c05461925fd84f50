// Quarter of a sphere-ended column on a quarter of a block, cut at the planes x = 0 and y = 0, in hexahedra. Hertz's
// theory knows the sphere only by its radius of curvature near the contact, so the column is as good as a whole sphere
// while its half-width L is many contact radii. Each body is 2 x 2 x 2 transfinite pieces: fine up to `patch`, graded
// from there to L. The bodies have their own points, so their own nodes.
DefineConstant[
  R = {40, Name "radius of the sphere"},
  L = {16, Name "half-width, height of the column and depth of the block"},
  overlap = {0, Name "how deep the undeformed sphere reaches into the block"},
  patch = {1.25, Name "side of the refined patch; larger than the contact radius"},
  n = {10, Name "cells along the patch of the block"},
  ratio = {1.1, Name "cell size in the patch of the column / that of the block; not 1: the meshes do not match"}
];

// Makes one body: corners (i, j, k) at places x(i), x(j) and layer k, with nc cells along the patch and graded ones
// outside. The first layer is a sphere (radius R, centre 0 0 zc) when `round` is set, otherwise the plane z = 0; the
// others follow at `side` (+1 up, -1 down). Leaves volume[], first[] (contact face), last[] (far face), cut_x[], cut_y[].
Macro Body
  x[] = {0, patch, L};
  // progression q from the patch's cell size to the outer border in m cells, by bisection
  m = Ceil(0.7 * nc);
  low = 1; high = 5;
  For step In {1:60}
    q = (low + high) / 2;
    If (patch / nc * q * (q^m - 1) / (q - 1) > L - patch)
      high = q;
    Else
      low = q;
    EndIf
  EndFor
  centre = newp;
  Point(centre) = {0, 0, zc};
  p[] = {};
  For k In {0:2}
    For j In {0:2}
      For i In {0:2}
        z = side * x[k];
        If (round && k < 2)
          // layers 0 and 1 are concentric spheres, met on the rays from the centre
          depth = Sqrt(R * R - x[i] * x[i] - x[j] * x[j]);
          shrink = 1 - x[k] / R;
          id = newp;
          Point(id) = {x[i] * shrink, x[j] * shrink, zc - depth * shrink};
        Else
          id = newp;
          Point(id) = {x[i], x[j], z + (round ? zc - R : 0)};
        EndIf
        p[] += id;
      EndFor
    EndFor
  EndFor
  // Lines along x, y and z between corners: lx[i + 2 (j + 3 k)], ly[j + 2 (i + 3 k)], lz[k + 2 (i + 3 j)]. In the loop the
  // names i, j, k serve lx; ly has i along y and j across x; lz has i along z, j across x and k across y.
  lx[] = {}; ly[] = {}; lz[] = {};
  For k In {0:2}
    For j In {0:2}
      For i In {0:1}
        a = p[i + 3 * (j + 3 * k)]; b = p[i + 1 + 3 * (j + 3 * k)];
        c = p[j + 3 * (i + 3 * k)]; d = p[j + 3 * (i + 1 + 3 * k)];
        e = p[j + 3 * (k + 3 * i)]; f = p[j + 3 * (k + 3 * (i + 1))];
        id = newl;
        If (round && k < 2)
          Circle(id) = {a, centre, b};
          Circle(id + 1) = {c, centre, d};
        Else
          Line(id) = {a, b};
          Line(id + 1) = {c, d};
        EndIf
        Line(id + 2) = {e, f};
        lx[] += id; ly[] += id + 1; lz[] += id + 2;
        If (i == 0)
          Transfinite Curve{id, id + 1, id + 2} = nc + 1;
        Else
          Transfinite Curve{id, id + 1, id + 2} = m + 1 Using Progression q;
        EndIf
      EndFor
    EndFor
  EndFor
  // Faces across x, y and z: fx[j + 2 (k + 2 i)], fy[i + 2 (k + 2 j)], fz[i + 2 (j + 2 k)], made for one place w across
  // at a time.
  fx[] = {}; fy[] = {}; fz[] = {};
  For w In {0:2}
    For v In {0:1}
      For u In {0:1}
        id = newll;
        Curve Loop(id) = {lx[u + 2 * (v + 3 * w)], ly[v + 2 * (u + 1 + 3 * w)], -lx[u + 2 * (v + 1 + 3 * w)], -ly[v + 2 * (u + 3 * w)]};
        If (round && w < 2)
          Surface(id) = {id} In Sphere{centre};
        Else
          Plane Surface(id) = {id};
        EndIf
        fz[] += id;
        id = newll;
        Curve Loop(id) = {lx[u + 2 * (w + 3 * v)], lz[v + 2 * (u + 1 + 3 * w)], -lx[u + 2 * (w + 3 * (v + 1))], -lz[v + 2 * (u + 3 * w)]};
        Surface(id) = {id};
        fy[] += id;
        id = newll;
        Curve Loop(id) = {ly[u + 2 * (w + 3 * v)], lz[v + 2 * (w + 3 * (u + 1))], -ly[u + 2 * (w + 3 * (v + 1))], -lz[v + 2 * (w + 3 * u)]};
        Surface(id) = {id};
        fx[] += id;
      EndFor
    EndFor
  EndFor
  Transfinite Surface{fx[], fy[], fz[]};
  Recombine Surface{fx[], fy[], fz[]};
  volume[] = {};
  For k In {0:1}
    For j In {0:1}
      For i In {0:1}
        id = newv;
        Surface Loop(id) = {fz[i + 2 * (j + 2 * k)], fz[i + 2 * (j + 2 * (k + 1))], fy[i + 2 * (k + 2 * j)],
                            fy[i + 2 * (k + 2 * (j + 1))], fx[j + 2 * (k + 2 * i)], fx[j + 2 * (k + 2 * (i + 1))]};
        Volume(id) = {id};
        volume[] += id;
      EndFor
    EndFor
  EndFor
  Transfinite Volume{volume[]};
  first[] = fz[{0:3}];
  last[] = fz[{8:11}];
  cut_x[] = fx[{0:3}];
  cut_y[] = fy[{0:3}];
Return

round = 0; side = -1; nc = n; zc = 0;
Call Body;
Physical Volume("block") = volume[];
Physical Surface("block_top") = first[];
Physical Surface("block_base") = last[];
Physical Surface("block_cut_x") = cut_x[];
Physical Surface("block_cut_y") = cut_y[];

round = 1; side = 1; nc = Round(n / ratio); zc = R - overlap;
Call Body;
Physical Volume("sphere") = volume[];
Physical Surface("sphere_cap") = first[];
Physical Surface("sphere_top") = last[];
Physical Surface("sphere_cut_x") = cut_x[];
Physical Surface("sphere_cut_y") = cut_y[];
