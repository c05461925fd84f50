// Unit square standing on y = 0: n equal cells a side.
DefineConstant[
  n = {32, Name "cells along a side"},
  quads = {1, Name "quadrilaterals (1) or triangles (0)"}
];

Point(1) = {0, 0, 0};
Point(2) = {1, 0, 0};
Point(3) = {1, 1, 0};
Point(4) = {0, 1, 0};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Curve Loop(1) = {1:4};
Plane Surface(1) = {1};
Transfinite Curve{1:4} = n + 1;
Transfinite Surface{1};
If (quads)
  Recombine Surface{1};
EndIf

Physical Surface("block") = {1};
Physical Curve("foot") = {1};
Physical Curve("right") = {2};
Physical Curve("top") = {3};
Physical Curve("left") = {4};
