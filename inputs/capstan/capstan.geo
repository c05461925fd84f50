// A belt over a quarter of a drum: centre (0, 0), from angle 0 to 90 degrees, and a straight tail at each end.
DefineConstant[
  R = 10,   // of the drum, inner radius of the belt
  t = 0.1,  // thickness of the belt
  L = 2,    // length of a tail
  n = 60,   // cells along the quarter
  k = 8     // cells along a tail
];
Point(1) = {0, 0, 0};
Point(2) = {R, 0, 0};   Point(3) = {R + t, 0, 0};
Point(4) = {0, R, 0};   Point(5) = {0, R + t, 0};
Point(6) = {R, -L, 0};  Point(7) = {R + t, -L, 0};
Point(8) = {-L, R, 0};  Point(9) = {-L, R + t, 0};
Circle(1) = {2, 1, 4};  Circle(2) = {3, 1, 5};
Line(3) = {2, 3};       Line(4) = {4, 5};
Line(5) = {6, 7};       Line(6) = {7, 3};   Line(7) = {6, 2};
Line(8) = {4, 8};       Line(9) = {5, 9};   Line(10) = {8, 9};
Curve Loop(1) = {3, 2, -4, -1};   Plane Surface(1) = {1};
Curve Loop(2) = {5, 6, -3, -7};   Plane Surface(2) = {2};
Curve Loop(3) = {4, 9, -10, -8};  Plane Surface(3) = {3};
Transfinite Curve{1, 2} = n + 1;
Transfinite Curve{3, 4, 5, 10} = 3;
Transfinite Curve{6, 7, 8, 9} = k + 1;
Transfinite Surface{1, 2, 3};
Recombine Surface{1, 2, 3};
Physical Surface("belt") = {1, 2, 3};
Physical Curve("inner") = {1, 7, 8};
Physical Curve("loaded") = {5};
Physical Curve("held") = {10};
