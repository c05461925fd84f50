// A block of width B and height H with a tether of length T at its uphill (left) side. With a depth: both extruded along z, and
// on a ground of their own instead of a rigid plane.
DefineConstant[
  B = {0.2, Name "width of the block"},
  H = {0.1, Name "height of block and tether"},
  T = {1, Name "length of the tether"},
  n = {4, Name "cells along the height"},
  depth = {0, Name "along z; 0: plane, without ground"}
];
Geometry.AutoCoherence = 0;

x[] = {-T, 0, B};
For i In {0:2}
  Point(1 + i) = {x[i], 0, 0};
  Point(4 + i) = {x[i], H, 0};
  Line(10 + i) = {1 + i, 4 + i};
  Transfinite Curve{10 + i} = n + 1;
EndFor
For i In {0:1}
  Line(20 + i) = {1 + i, 2 + i};
  Line(30 + i) = {4 + i, 5 + i};
  Transfinite Curve{20 + i, 30 + i} = (i == 0 ? n : 2 * n) + 1;
  Curve Loop(40 + i) = {20 + i, 11 + i, -(30 + i), -(10 + i)};
  Plane Surface(50 + i) = {40 + i};
  Transfinite Surface{50 + i};
  Recombine Surface{50 + i};
EndFor

If (depth == 0)
  Physical Surface("tether") = {50};
  Physical Surface("block") = {51};
  Physical Curve("tether_end") = {10};
  Physical Curve("bottom") = {21};
Else
  Geometry.AutoCoherence = 1;
  // Extrude gives the far face, the volume, then the faces over the curves of the loop, in its order.
  front[] = Extrude{0, 0, depth}{ Surface{50}; Layers{n}; Recombine; };
  back[] = Extrude{0, 0, depth}{ Surface{51}; Layers{n}; Recombine; };
  Physical Volume("tether") = {front[1]};
  Physical Volume("block") = {back[1]};
  Physical Surface("tether_end") = {front[5]};
  Physical Surface("bottom") = {back[2]};
  Point(1001) = {-0.25 * B, -H, -0.3 * depth};
  Point(1002) = {1.25 * B, -H, -0.3 * depth};
  Point(1003) = {1.25 * B, 0, -0.3 * depth};
  Point(1004) = {-0.25 * B, 0, -0.3 * depth};
  For i In {1:4}
    Line(1010 + i) = {1000 + i, 1001 + i % 4};
  EndFor
  Curve Loop(1020) = {1011, 1012, 1013, 1014};
  Plane Surface(1030) = {1020};
  Transfinite Curve{1011, 1013} = 2 * n;
  Transfinite Curve{1012, 1014} = n;
  Transfinite Surface{1030};
  Recombine Surface{1030};
  ground[] = Extrude{0, 0, 1.6 * depth}{ Surface{1030}; Layers{n + 1}; Recombine; };
  Physical Volume("ground") = {ground[1]};
  Physical Surface("ground_base") = {ground[2]};
  Physical Surface("ground_top") = {ground[4]};
EndIf
