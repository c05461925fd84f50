// Half of a round indenter (the lower right quarter of a disc) on a block, cut at the axis x = 0: a cylinder in plane
// strain, a sphere when the axis is an axis of revolution. Under the contact both bodies have a patch of square cells;
// from there the cells grow with the distance. The bodies have their own points, so their own nodes.
DefineConstant[
  R = {50, Name "radius of the indenter"},
  L = {50, Name "width (of the half) and depth of the block"},
  overlap = {0, Name "how deep the undeformed indenter reaches into the block"},
  patch = {1.5, Name "side of the refined patches; larger than the contact half-width"},
  h = {0.05, Name "cell size in the patch of the block"},
  ratio = {1.1, Name "cell size in the patch of the indenter / h; not 1, so that the meshes do not match"},
  growth = {0.25, Name "growth of the cell size with the distance from the patch"}
];

n_block = Round(patch / h);
n_indenter = Round(patch / (ratio * h));

// Block: the patch is 1-2-3-4, the rest of the rectangle 5-6-7.
Point(1) = {0, 0, 0};
Point(2) = {patch, 0, 0};
Point(3) = {patch, -patch, 0};
Point(4) = {0, -patch, 0};
Point(5) = {L, 0, 0};
Point(6) = {L, -L, 0};
Point(7) = {0, -L, 0};
Line(1) = {4, 3};
Line(2) = {3, 2};
Line(3) = {2, 1};
Line(4) = {1, 4};
Line(5) = {2, 5};
Line(6) = {5, 6};
Line(7) = {6, 7};
Line(8) = {7, 4};
Curve Loop(1) = {1, 2, 3, 4};
Curve Loop(2) = {-5, -2, -1, -8, -7, -6};
Plane Surface(1) = {1};
Plane Surface(2) = {2};
Transfinite Curve{1:4} = n_block + 1;

// Indenter: centre 10, lowest point 11, patch 11-12-13-14.
y = -overlap;
rise = R - Sqrt(R * R - patch * patch);
Point(10) = {0, y + R, 0};
Point(11) = {0, y, 0};
Point(12) = {patch, y + rise, 0};
Point(13) = {patch, y + rise + patch, 0};
Point(14) = {0, y + patch, 0};
Point(15) = {R, y + R, 0};
Circle(11) = {11, 10, 12};
Line(12) = {12, 13};
Line(13) = {13, 14};
Line(14) = {14, 11};
Circle(15) = {12, 10, 15};
Line(16) = {15, 10};
Line(17) = {10, 14};
Curve Loop(3) = {11, 12, 13, 14};
Curve Loop(4) = {15, 16, 17, -13, -12};
Plane Surface(3) = {3};
Plane Surface(4) = {4};
Transfinite Curve{11:14} = n_indenter + 1;

Transfinite Surface{1, 3};
Recombine Surface{1, 3};

Field[1] = MathEval;
Field[1].F = Sprintf("%g + %g*Max(0, Max(x, Abs(y)) - %g)", h, growth, patch);
Background Field = 1;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
Mesh.Algorithm = 6;

Physical Surface("block") = {1, 2};
Physical Surface("indenter") = {3, 4};
Physical Curve("block_top") = {3, 5};
Physical Curve("block_base") = {7};
Physical Curve("block_axis") = {4, 8};
Physical Curve("indenter_rim") = {11, 15};
Physical Curve("indenter_cut") = {16};
Physical Curve("indenter_axis") = {14, 17};
