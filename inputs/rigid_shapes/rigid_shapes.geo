// Three blocks side by side, in hexahedra: a quarter of one under a sphere, a slice of the half of one under a cylinder
// along y, and one under a plane. The first two are fine next to the edge or line of contact and graded from there.
DefineConstant[
  L = {16, Name "half-width and depth of the blocks under the sphere and the cylinder"},
  patch = {1.25, Name "side of the refined part; larger than the half-width of the contact"},
  n = {8, Name "cells along the refined part"},
  thickness = {1, Name "thickness of the slice under the cylinder"},
  H = {8, Name "side of the block under the plane"},
  n_plane = {4, Name "cells along the block under the plane"},
  x_cylinder = {30, Name "place of the line under the cylinder"},
  x_plane = {60, Name "place of the block under the plane"}
];

// Ends of the layers as fractions of L: n equal cells up to patch, then m graded ones; q by bisection.
m = Ceil(0.7 * n);
low = 1; high = 5;
For step In {1:60}
  q = (low + high) / 2;
  If (patch / n * q * (q^m - 1) / (q - 1) > L - patch)
    high = q;
  Else
    low = q;
  EndIf
EndFor
ones[] = {}; ends[] = {};
For k In {1:n}
  ones[] += 1; ends[] += patch / L * k / n;
EndFor
For k In {1:m}
  ones[] += 1; ends[] += (patch + patch / n * q * (q^k - 1) / (q - 1)) / L;
EndFor

// A point becomes a line along x, a face in the plane z = 0, and a volume below it. Extrude gives the far side first,
// then what was swept, then the faces over the lines: for `v` those at y = 0, x = end, y = end, x = start.
p = newp;
Point(p) = {0, 0, 0};
l[] = Extrude{L, 0, 0}{ Point{p}; Layers{ones[], ends[]}; };
f[] = Extrude{0, L, 0}{ Curve{l[1]}; Layers{ones[], ends[]}; Recombine; };
v[] = Extrude{0, 0, -L}{ Surface{f[1]}; Layers{ones[], ends[]}; Recombine; };
Physical Volume("sphere_block") = {v[1]};
Physical Surface("sphere_top") = {f[1]};
Physical Surface("sphere_base") = {v[0]};
Physical Surface("sphere_cut_y") = {v[2]};
Physical Surface("sphere_cut_x") = {v[5]};

p = newp;
Point(p) = {x_cylinder, 0, 0};
l[] = Extrude{L, 0, 0}{ Point{p}; Layers{ones[], ends[]}; };
f[] = Extrude{0, thickness, 0}{ Curve{l[1]}; Layers{2}; Recombine; };
v[] = Extrude{0, 0, -L}{ Surface{f[1]}; Layers{ones[], ends[]}; Recombine; };
Physical Volume("cylinder_block") = {v[1]};
Physical Surface("cylinder_top") = {f[1]};
Physical Surface("cylinder_base") = {v[0]};
Physical Surface("cylinder_sides") = {v[2], v[4]};
Physical Surface("cylinder_cut_x") = {v[5]};

p = newp;
Point(p) = {x_plane, 0, 0};
l[] = Extrude{H, 0, 0}{ Point{p}; Layers{n_plane}; };
f[] = Extrude{0, H, 0}{ Curve{l[1]}; Layers{n_plane}; Recombine; };
v[] = Extrude{0, 0, -H}{ Surface{f[1]}; Layers{n_plane}; Recombine; };
Physical Volume("plane_block") = {v[1]};
Physical Surface("plane_top") = {f[1]};
Physical Surface("plane_base") = {v[0]};
Physical Surface("plane_cut_y") = {v[2]};
Physical Surface("plane_cut_x") = {v[5]};
