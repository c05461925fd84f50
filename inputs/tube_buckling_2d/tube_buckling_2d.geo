// Half section of a round tube, x the radius: middle radius R, wall t, length L. `bulge`: how far the middle line
// bulges out in a half wave of length `wave` at the lower end, so that folds begin there.
DefineConstant[
  R = {25, Name "middle radius"},
  t = {1.5, Name "wall"},
  L = {60, Name "length"},
  wave = {8.2, Name "length of the bulge"},
  bulge = {0.02, Name "height of the bulge"},
  n = {40, Name "cells along the tube"}
];
m = Round(n * wave / L); // cells in the bulge
For side In {0:1}
  x = R + (side - 0.5) * t;
  foot[side] = newp; Point(foot[side]) = {x, 0, 0};
  neck[side] = newp; Point(neck[side]) = {x, wave, 0};
  head[side] = newp; Point(head[side]) = {x, L, 0};
  crest[] = {};
  For k In {1:5}
    p = newp; Point(p) = {x + bulge * Sin(k * Pi / 6)^2, wave * k / 6, 0};
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
Physical Surface("tube") = {lower, upper};
Physical Curve("bottom") = {bottom};
Physical Curve("top") = {top};
Physical Curve("skin") = {low[0], low[1], high[0], high[1]};
