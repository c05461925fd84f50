// A sector of a thick cylinder around the origin, 60 degrees of it, with `n` facets on its outer face of radius 1; above it a
// block whose lower face is an arc of radius 0.15 that touches the cylinder in (0, 1).
DefineConstant[
  n = {10, Name "facets of the cylinder on 60 degrees"},
  m = {16, Name "facets of the block's lower face"}
];
a = 0.15; w = 0.1; base = 0.6;

Point(1) = {0, 0, 0};
Point(2) = {Cos(2*Pi/3), Sin(2*Pi/3), 0};
Point(3) = {Cos(Pi/3), Sin(Pi/3), 0};
Point(4) = {base*Cos(2*Pi/3), base*Sin(2*Pi/3), 0};
Point(5) = {base*Cos(Pi/3), base*Sin(Pi/3), 0};
Circle(1) = {2, 1, 3};
Circle(2) = {4, 1, 5};
Line(3) = {4, 2};
Line(4) = {5, 3};
Curve Loop(1) = {2, 4, -1, -3};
Plane Surface(1) = {1};
Transfinite Curve {1, 2} = n + 1;
Transfinite Curve {3, 4} = 5;
Transfinite Surface {1};
Recombine Surface {1};

top = 1.25; side = 1 + a - Sqrt(a*a - w*w);
Point(10) = {0, 1 + a, 0};
Point(11) = {-w, side, 0};
Point(12) = {w, side, 0};
Point(13) = {w, top, 0};
Point(14) = {-w, top, 0};
Circle(11) = {11, 10, 12};
Line(12) = {12, 13};
Line(13) = {13, 14};
Line(14) = {14, 11};
Curve Loop(2) = {11, 12, 13, 14};
Plane Surface(2) = {2};
Transfinite Curve {11, 13} = m + 1;
Transfinite Curve {12, 14} = m + 1;
Transfinite Surface {2};
Recombine Surface {2};

Physical Surface("cylinder") = {1};
Physical Surface("block") = {2};
Physical Curve("core") = {2};
Physical Curve("cylinder_face") = {1};
Physical Curve("block_face") = {11};
Physical Curve("grip") = {13};
