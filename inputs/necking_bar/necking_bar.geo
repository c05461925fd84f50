// A quarter of a round bar's section: x is the radius, y the axis. The bar is a little thinner in the middle (y = 0). mm.
DefineConstant[
  radius = 6.413,
  half_length = 26.667,
  middle = 0.982, // radius in the middle over radius at the end
  n = 5, // cells along the radius
  m = 15 // cells along the half length, finer towards the middle
];
Point(1) = {0, 0, 0};
Point(2) = {middle * radius, 0, 0};
Point(3) = {radius, half_length, 0};
Point(4) = {0, half_length, 0};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Transfinite Curve {1, 3} = n + 1;
Transfinite Curve {2} = m + 1 Using Progression 1.12;
Transfinite Curve {-4} = m + 1 Using Progression 1.12;
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Transfinite Surface {1};
Recombine Surface {1};
Physical Surface("bar") = {1};
Physical Curve("middle") = {1};
Physical Curve("end") = {3};
Physical Curve("axis") = {4};
Physical Point("neck") = {2};
