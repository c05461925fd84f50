// A wheel's tyre: a ring around (0, outer), so that it stands on y = 0. Quadrilaterals.
DefineConstant[
  outer = {1, Name "outer radius"},
  hub = {0.5, Name "radius of the hub, which is not meshed"},
  n = {16, Name "cells around a quarter"},
  layers = {4, Name "cells from hub to rim"}
];
Point(1) = {0, outer, 0};
For k In {0:3}
  Point(10 + k) = {hub * Cos(k * Pi / 2), outer + hub * Sin(k * Pi / 2), 0};
  Point(20 + k) = {outer * Cos(k * Pi / 2), outer + outer * Sin(k * Pi / 2), 0};
  Line(30 + k) = {10 + k, 20 + k};
EndFor
For k In {0:3}
  next = (k + 1) % 4;
  Circle(10 + k) = {10 + k, 1, 10 + next};
  Circle(20 + k) = {20 + k, 1, 20 + next};
EndFor
Transfinite Curve {10:13, 20:23} = n + 1;
Transfinite Curve {30:33} = layers + 1;
For k In {0:3}
  Curve Loop(k + 1) = {30 + k, 20 + k, -(30 + (k + 1) % 4), -(10 + k)};
  Plane Surface(k + 1) = {k + 1};
EndFor
Transfinite Surface {1:4};
Recombine Surface {1:4};
Physical Surface("tyre") = {1:4};
Physical Curve("hub") = {10:13};
Physical Curve("rim") = {20:23};
