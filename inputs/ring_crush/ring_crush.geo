// A thin ring of quadrilaterals, one layer or more: mid-radius R, thickness t. `oval` makes the mid-line an ellipse with
// half-axes R (1 + oval) along x and R (1 - oval) along y. It is cut at the axes, where symmetry holds it.
DefineConstant[
  R = {1, Name "radius of the middle line"},
  t = {0.02, Name "thickness"},
  oval = {0, Name "imperfection / R"},
  n = {24, Name "cells around a quarter"},
  layers = {1, Name "cells through the thickness"}
];

centre = newp;
Point(centre) = {0, 0, 0};
// Points 1, 3, 5, 7 inside and 2, 4, 6, 8 outside, from the x-axis counter-clockwise.
rim[] = {};
For k In {0:3}
  For side In {0:1}
    x = R * (1 + oval) + (side - 0.5) * t; y = R * (1 - oval) + (side - 0.5) * t;
    p = newp;
    Point(p) = {x * (k == 0) - x * (k == 2), y * (k == 1) - y * (k == 3), 0};
    rim[] += p;
  EndFor
EndFor
cut[] = {}; inner[] = {}; outer[] = {};
For k In {0:3}
  next = (k + 1) % 4;
  c = newl; Line(c) = {rim[2 * k], rim[2 * k + 1]};
  cut[] += c;
  // The point on the major half-axis, x, is an end of every quarter.
  major = (k % 2 == 0) ? k : next;
  i = newl; Ellipse(i) = {rim[2 * k], centre, rim[2 * major], rim[2 * next]};
  inner[] += i;
  o = newl; Ellipse(o) = {rim[2 * k + 1], centre, rim[2 * major + 1], rim[2 * next + 1]};
  outer[] += o;
EndFor
Transfinite Curve {inner[], outer[]} = n + 1;
Transfinite Curve {cut[]} = layers + 1;
quarters[] = {};
For k In {0:3}
  next = (k + 1) % 4;
  l = newll; Curve Loop(l) = {cut[k], outer[k], -cut[next], -inner[k]};
  s = news; Plane Surface(s) = {l};
  quarters[] += s;
EndFor
Transfinite Surface {quarters[]};
Recombine Surface {quarters[]};
Physical Surface("ring") = {quarters[]};
Physical Curve("inside") = {inner[]};
Physical Curve("outside") = {outer[]};
Physical Curve("skin") = {inner[], outer[]};
Physical Curve("on_x") = {cut[0], cut[2]};
Physical Curve("on_y") = {cut[1], cut[3]};
