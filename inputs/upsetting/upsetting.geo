// The upper half of a round billet's section: x is the radius, y the axis, y = 0 the middle plane. mm.
DefineConstant[
  radius = {10, Name "radius"},
  half_height = {15, Name "half of the height"},
  n = {10, Name "cells along the radius, finer towards the rim"},
  m = {16, Name "cells along the half height, finer towards the face"},
  side = {0.9, Name "size of a cell over that of its neighbour further in, along the radius"},
  face = {0.93, Name "the same along the height"}
];
Point(1) = {0, 0, 0};
Point(2) = {radius, 0, 0};
Point(3) = {radius, half_height, 0};
Point(4) = {0, half_height, 0};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Transfinite Curve {1, -3} = n + 1 Using Progression side;
Transfinite Curve {2, -4} = m + 1 Using Progression face;
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Transfinite Surface {1};
Recombine Surface {1};
Physical Surface("billet") = {1};
Physical Curve("middle") = {1};
Physical Curve("skin") = {2, 3};
Physical Curve("axis") = {4};
