// A quarter of the section of a thick tube.
DefineConstant[
  inner = 1,
  outer = 2,
  n = 4, // cells through the wall
  m = 6, // cells around the quarter
  quads = 1 // 0: triangles
];
Point(1) = {0, 0, 0};
Point(2) = {inner, 0, 0};
Point(3) = {outer, 0, 0};
Point(4) = {0, outer, 0};
Point(5) = {0, inner, 0};
Line(1) = {2, 3};
Circle(2) = {3, 1, 4};
Line(3) = {4, 5};
Circle(4) = {5, 1, 2};
Transfinite Curve {1, 3} = n + 1;
Transfinite Curve {2, 4} = m + 1;
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Transfinite Surface {1};
If (quads)
  Recombine Surface {1};
EndIf
Physical Surface("tube") = {1};
Physical Curve("bore") = {4};
Physical Curve("bottom") = {1};
Physical Curve("left") = {3};
