// The section of a round blank, half of it: x is the radius, y the axis; the lower face is y = 0. Above its outer part the
// section of the blank holder, a flat ring. mm.
DefineConstant[
  blank = {36, Name "radius of the blank"},
  t = {1, Name "thickness of the blank"},
  inside = {22, Name "inner radius of the blank holder"},
  n = {24, Name "cells along the radius"},
  layers = {1, Name "cells through the thickness"}
];
Point(1) = {0, 0, 0};
Point(2) = {blank, 0, 0};
Point(3) = {blank, t, 0};
Point(4) = {0, t, 0};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Transfinite Curve {1, 3} = n + 1;
Transfinite Curve {2, 4} = layers + 1;

Point(11) = {inside, t, 0};
Point(12) = {blank + 4, t, 0};
Point(13) = {blank + 4, t + 6, 0};
Point(14) = {inside, t + 6, 0};
Line(11) = {11, 12};
Line(12) = {12, 13};
Line(13) = {13, 14};
Line(14) = {14, 11};
Curve Loop(2) = {11, 12, 13, 14};
Plane Surface(2) = {2};
Transfinite Curve {11, 13} = 5;
Transfinite Curve {12, 14} = 2;
Transfinite Surface {1, 2};
Recombine Surface {1, 2};
Physical Surface("sheet") = {1};
Physical Curve("lower") = {1};
Physical Curve("rim") = {2};
Physical Curve("upper") = {3};
Physical Curve("axis") = {4};
Physical Surface("ring") = {2};
Physical Curve("ring_face") = {11};
Physical Curve("ring_top") = {13};
