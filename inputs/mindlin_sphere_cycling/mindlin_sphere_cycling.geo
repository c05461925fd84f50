// Half of a block, cut at y = 0: the box from (-L, 0, -L) to (L, L, 0) in hexahedra, with a fine patch of cubes around the
// origin and cells that grow from there to L.
DefineConstant[
  L = {2.5, Name "half-width and depth"},
  patch = {0.17, Name "half-width and depth of the refined patch; larger than the contact radius"},
  n = {5, Name "cells along the patch's depth and half its width"}
];

// progression q from the patch's cell size to the outer border in m cells, by bisection
m = n;
low = 1; high = 9;
For step In {1:60}
  q = (low + high) / 2;
  If (patch / n * q * (q^m - 1) / (q - 1) > L - patch)
    high = q;
  Else
    low = q;
  EndIf
EndFor

// Corners (i, j, k) at (x(i), y(j), -y(k)).
x[] = {-L, -patch, patch, L};
y[] = {0, patch, L};
p[] = {};
For k In {0:2}
  For j In {0:2}
    For i In {0:3}
      id = newp;
      Point(id) = {x[i], y[j], -y[k]};
      p[] += id;
    EndFor
  EndFor
EndFor
// Lines along x: lx[i + 3 (j + 3 k)], along y: ly[j + 2 (i + 4 k)], along z: lz[k + 2 (i + 4 j)].
lx[] = {};
For k In {0:2}
  For j In {0:2}
    For i In {0:2}
      id = newl;
      Line(id) = {p[i + 4 * (j + 3 * k)], p[i + 1 + 4 * (j + 3 * k)]};
      lx[] += id;
      If (i == 0)
        Transfinite Curve{-id} = m + 1 Using Progression q;
      ElseIf (i == 1)
        Transfinite Curve{id} = 2 * n + 1;
      Else
        Transfinite Curve{id} = m + 1 Using Progression q;
      EndIf
    EndFor
  EndFor
EndFor
ly[] = {};
For k In {0:2}
  For i In {0:3}
    For j In {0:1}
      id = newl;
      Line(id) = {p[i + 4 * (j + 3 * k)], p[i + 4 * (j + 1 + 3 * k)]};
      ly[] += id;
      If (j == 0)
        Transfinite Curve{id} = n + 1;
      Else
        Transfinite Curve{id} = m + 1 Using Progression q;
      EndIf
    EndFor
  EndFor
EndFor
lz[] = {};
For j In {0:2}
  For i In {0:3}
    For k In {0:1}
      id = newl;
      Line(id) = {p[i + 4 * (j + 3 * k)], p[i + 4 * (j + 3 * (k + 1))]};
      lz[] += id;
      If (k == 0)
        Transfinite Curve{id} = n + 1;
      Else
        Transfinite Curve{id} = m + 1 Using Progression q;
      EndIf
    EndFor
  EndFor
EndFor
// Faces across z: fz[i + 3 (j + 2 k)], across y: fy[i + 3 (k + 2 j)], across x: fx[j + 2 (k + 2 i)].
fz[] = {};
For k In {0:2}
  For j In {0:1}
    For i In {0:2}
      id = newll;
      Curve Loop(id) = {lx[i + 3 * (j + 3 * k)], ly[j + 2 * (i + 1 + 4 * k)], -lx[i + 3 * (j + 1 + 3 * k)], -ly[j + 2 * (i + 4 * k)]};
      Plane Surface(id) = {id};
      fz[] += id;
    EndFor
  EndFor
EndFor
fy[] = {};
For j In {0:2}
  For k In {0:1}
    For i In {0:2}
      id = newll;
      Curve Loop(id) = {lx[i + 3 * (j + 3 * k)], lz[k + 2 * (i + 1 + 4 * j)], -lx[i + 3 * (j + 3 * (k + 1))], -lz[k + 2 * (i + 4 * j)]};
      Plane Surface(id) = {id};
      fy[] += id;
    EndFor
  EndFor
EndFor
fx[] = {};
For i In {0:3}
  For k In {0:1}
    For j In {0:1}
      id = newll;
      Curve Loop(id) = {ly[j + 2 * (i + 4 * k)], lz[k + 2 * (i + 4 * (j + 1))], -ly[j + 2 * (i + 4 * (k + 1))], -lz[k + 2 * (i + 4 * j)]};
      Plane Surface(id) = {id};
      fx[] += id;
    EndFor
  EndFor
EndFor
Transfinite Surface{fx[], fy[], fz[]};
Recombine Surface{fx[], fy[], fz[]};
volume[] = {};
For k In {0:1}
  For j In {0:1}
    For i In {0:2}
      id = newv;
      Surface Loop(id) = {fz[i + 3 * (j + 2 * k)], fz[i + 3 * (j + 2 * (k + 1))], fy[i + 3 * (k + 2 * j)],
                          fy[i + 3 * (k + 2 * (j + 1))], fx[j + 2 * (k + 2 * i)], fx[j + 2 * (k + 2 * (i + 1))]};
      Volume(id) = {id};
      volume[] += id;
    EndFor
  EndFor
EndFor
Transfinite Volume{volume[]};
Physical Volume("block") = volume[];
Physical Surface("top") = fz[{0:5}];
Physical Surface("base") = fz[{12:17}];
Physical Surface("cut") = fy[{0:5}];
