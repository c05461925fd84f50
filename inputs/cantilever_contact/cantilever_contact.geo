// A cantilever 10 long and 0.5 high, clamped at x = 0, of n x n/20 cells.
DefineConstant[ n = {40, Name "n"} ];
Point(1) = {0, 0, 0};
Point(2) = {10, 0, 0};
Point(3) = {10, 0.5, 0};
Point(4) = {0, 0.5, 0};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Transfinite Curve {1, 3} = n + 1;
Transfinite Curve {2, 4} = Ceil(n/20) + 1;
Transfinite Surface {1};
Recombine Surface {1};
Physical Surface("beam") = {1};
Physical Curve("clamped") = {4};
Physical Curve("upper_face") = {3};
