// A block B x B x H on z = 0, of n x n x 1 bricks.
DefineConstant[
  B = {20, Name "width and depth"},
  H = {10, Name "height"},
  n = {2, Name "cells along the width"}
];
Point(1) = {0, 0, 0};
Point(2) = {B, 0, 0};
Point(3) = {B, B, 0};
Point(4) = {0, B, 0};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Transfinite Curve{1:4} = n + 1;
Transfinite Surface{1};
Recombine Surface{1};
out[] = Extrude{0, 0, H}{ Surface{1}; Layers{1}; Recombine; };
Physical Volume("block") = {out[1]};
Physical Surface("bottom") = {1};
Physical Surface("top") = {out[0]};
Physical Surface("sides") = {out[2], out[3], out[4], out[5]};
