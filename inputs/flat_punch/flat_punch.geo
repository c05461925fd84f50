// Half of an elastic half-plane, cut at x = 0, under a flat punch of half-width a. On both sides of the punch's edge the
// half-plane has a patch of square cells; from there they grow with the distance. Own points for each body.
DefineConstant[
  a = {1, Name "half-width of the punch"},
  L = {50, Name "width (of the half) and depth of the half-plane"},
  n = {30, Name "cells of the half-plane under half of the punch"},
  n_punch = {20, Name "cells along half of the punch"},
  growth = {0.2, Name "growth of the cell size with the distance from the patches"}
];

h = a / n;
Point(1) = {0, 0, 0};
Point(2) = {a, 0, 0};
Point(3) = {2 * a, 0, 0};
Point(4) = {2 * a, -a, 0};
Point(5) = {a, -a, 0};
Point(6) = {0, -a, 0};
Point(7) = {L, 0, 0};
Point(8) = {L, -L, 0};
Point(9) = {0, -L, 0};
Line(1) = {2, 1};
Line(2) = {3, 2};
Line(3) = {4, 3};
Line(4) = {5, 4};
Line(5) = {6, 5};
Line(6) = {1, 6};
Line(7) = {5, 2};
Line(8) = {7, 3};
Line(9) = {8, 7};
Line(10) = {9, 8};
Line(11) = {6, 9};
Curve Loop(1) = {1, 6, 5, 7};
Curve Loop(2) = {2, -7, 4, 3};
Curve Loop(3) = {8, -3, -4, -5, 11, 10, 9};
Plane Surface(1) = {1};
Plane Surface(2) = {2};
Plane Surface(3) = {3};
Transfinite Curve{1:7} = n + 1;

// Punch: a square on top.
Point(11) = {0, 0, 0};
Point(12) = {a, 0, 0};
Point(13) = {a, a, 0};
Point(14) = {0, a, 0};
Line(21) = {11, 12};
Line(22) = {12, 13};
Line(23) = {13, 14};
Line(24) = {14, 11};
Curve Loop(4) = {21, 22, 23, 24};
Plane Surface(4) = {4};
Transfinite Curve{21:24} = n_punch + 1;

Transfinite Surface{1, 2, 4};
Recombine Surface{1, 2, 4};

Field[1] = MathEval;
Field[1].F = Sprintf("%g + %g*Max(0, Max(x - %g, Abs(y) - %g))", h, growth, 2 * a, a);
Background Field = 1;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
Mesh.Algorithm = 6;

Physical Surface("half_plane") = {1, 2, 3};
Physical Surface("punch") = {4};
Physical Curve("half_plane_top") = {1, 2, 8};
Physical Curve("half_plane_base") = {10};
Physical Curve("half_plane_axis") = {6, 11};
Physical Curve("punch_face") = {21};
Physical Curve("punch_top") = {23};
Physical Curve("punch_axis") = {24};
