// A quarter of the section of a rubber disc: x is the radius, y the axis, y = 0 the middle. mm.
DefineConstant[
  radius = 20,
  half_height = 5,
  n = 20, // cells along the radius, finer towards the rim
  m = 8, // cells along the half height, finer towards the plate
  quads = 1 // 0: triangles
];
Point(1) = {0, 0, 0};
Point(2) = {radius, 0, 0};
Point(3) = {radius, half_height, 0};
Point(4) = {0, half_height, 0};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Transfinite Curve {1} = n + 1 Using Progression 0.88;
Transfinite Curve {-3} = n + 1 Using Progression 0.88;
Transfinite Curve {2} = m + 1 Using Progression 0.85;
Transfinite Curve {-4} = m + 1 Using Progression 0.85;
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Transfinite Surface {1};
If (quads)
  Recombine Surface {1};
EndIf
Physical Surface("disc") = {1};
Physical Curve("middle") = {1};
Physical Curve("plate") = {3};
Physical Curve("axis") = {4};
