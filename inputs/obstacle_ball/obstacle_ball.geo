// A quarter of a square membrane (one layer of hexahedra, n x n) over a quarter of a flattened ball (tetrahedra) around
// the origin, of which the part is there that the membrane can touch. The membrane is level with the ball's top. Own
// points, so own nodes.
SetFactory("OpenCASCADE");
DefineConstant[
  n = {16, Name "cells along a side of the membrane"},
  side = {2, Name "of the quarter"},
  thickness = {0.01, Name "of the membrane"},
  height = {0.01, Name "of the ball, whose radius is 1"},
  reach = {0.9, Name "radius of the part of the ball that is there"},
  depth = {0.2, Name "how deep it reaches below the origin"},
  ratio = {0.7, Name "size of the ball's facets / that of the membrane's; the meshes do not match"}
];

// The profile at y = 0, turned by a right angle.
Point(1) = {0, 0, height};
Point(2) = {reach, 0, height * Sqrt(1 - reach * reach)};
Point(3) = {reach, 0, -depth};
Point(4) = {0, 0, -depth};
Point(5) = {0, 0, 0};
Point(6) = {1, 0, 0};
Ellipse(1) = {1, 5, 6, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Curve Loop(1) = {1:4};
Plane Surface(1) = {1};
ball[] = Extrude{ {0, 0, 1}, {0, 0, 0}, Pi / 2 }{ Surface{1}; };
Recursive Delete{ Point{5, 6}; }
p = newp;
Point(p) = {0, 0, height};
l[] = Extrude{side, 0, 0}{ Point{p}; Layers{n}; };
f[] = Extrude{0, side, 0}{ Curve{l[1]}; Layers{n}; Recombine; };
v[] = Extrude{0, 0, thickness}{ Surface{f[1]}; Layers{1}; Recombine; };
e = 1e-4;
top = height + thickness;
rim() = Surface In BoundingBox{side - e, -e, height - e, side + e, side + e, top + e};
rim() += Surface In BoundingBox{-e, side - e, height - e, side + e, side + e, top + e};

Field[1] = MathEval;
Field[1].F = Sprintf("%g + 0.5 * Abs(z)", ratio * side / n);
Background Field = 1;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;

Physical Volume("ball") = {ball[1]};
Physical Surface("cap") = {ball[2]};
Physical Volume("membrane") = {v[1]};
Physical Surface("underside") = {f[1]};
Physical Surface("rim") = rim();
