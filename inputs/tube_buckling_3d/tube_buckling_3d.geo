// A quarter of a round tube around the z axis, turned from the section of tube_buckling_2d.geo: middle radius R, wall t,
// length L. `bulge`: how far the middle line bulges out in a half wave of length `wave` at the lower end.
DefineConstant[
  R = {25, Name "middle radius"},
  t = {1.5, Name "wall"},
  L = {20, Name "length"},
  wave = {8.2, Name "length of the bulge"},
  bulge = {0.2, Name "height of the bulge"},
  n = {10, Name "cells along the tube"},
  around = {5, Name "cells around the quarter"}
];
m = Round(n * wave / L); // cells in the bulge
For side In {0:1}
  x = R + (side - 0.5) * t;
  foot[side] = newp; Point(foot[side]) = {x, 0, 0};
  neck[side] = newp; Point(neck[side]) = {x, 0, wave};
  head[side] = newp; Point(head[side]) = {x, 0, L};
  crest[] = {};
  For k In {1:5}
    p = newp; Point(p) = {x + bulge * Sin(k * Pi / 6)^2, 0, wave * k / 6};
    crest[] += p;
  EndFor
  low[side] = newl; Spline(low[side]) = {foot[side], crest[], neck[side]};
  high[side] = newl; Line(high[side]) = {neck[side], head[side]};
EndFor
bottom = newl; Line(bottom) = {foot[0], foot[1]};
middle = newl; Line(middle) = {neck[0], neck[1]};
top = newl; Line(top) = {head[0], head[1]};
Transfinite Curve {low[0], low[1]} = m + 1;
Transfinite Curve {high[0], high[1]} = n - m + 1;
Transfinite Curve {bottom, middle, top} = 2;
l = newll; Curve Loop(l) = {bottom, low[1], -middle, -low[0]};
lower = news; Plane Surface(lower) = {l};
l = newll; Curve Loop(l) = {middle, high[1], -top, -high[0]};
upper = news; Plane Surface(upper) = {l};
Transfinite Surface {lower, upper};
Recombine Surface {lower, upper};
// The faces turned from bottom/middle, outside, middle/top, inside follow the volume in this order.
below[] = Extrude {{0, 0, 1}, {0, 0, 0}, Pi / 2} { Surface{lower}; Layers{around}; Recombine; };
above[] = Extrude {{0, 0, 1}, {0, 0, 0}, Pi / 2} { Surface{upper}; Layers{around}; Recombine; };
Physical Volume("tube") = {below[1], above[1]};
Physical Surface("bottom") = {below[2]};
Physical Surface("top") = {above[4]};
Physical Surface("skin") = {below[3], below[5], above[3], above[5]};
Physical Surface("on_y") = {lower, upper};
Physical Surface("on_x") = {below[0], above[0]};
