// A block of width B and height H on y = 0, of square cells.
DefineConstant[
  B = {20, Name "width"},
  H = {10, Name "height"},
  h = {2.5, Name "cell size"}
];
Point(1) = {0, 0, 0};
Point(2) = {B, 0, 0};
Point(3) = {B, H, 0};
Point(4) = {0, H, 0};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Transfinite Curve{1, 3} = Ceil(B / h) + 1;
Transfinite Curve{2, 4} = Ceil(H / h) + 1;
Transfinite Surface{1};
Recombine Surface{1};
Physical Surface("block") = {1};
Physical Curve("bottom") = {1};
Physical Curve("top") = {3};
Physical Curve("sides") = {2, 4};
