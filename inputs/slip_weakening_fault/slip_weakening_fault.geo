// Two blocks of width B and height H, one on the other along the fault y = 0, of square cells. Own points, so own nodes.
DefineConstant[
  B = {100, Name "width"},
  H = {50, Name "height of each block"},
  h = {12.5, Name "cell size of the upper block; the lower one's is twice that"}
];

Macro OneBlock
  p = newp;
  Point(p) = {0, y, 0};
  Point(p + 1) = {B, y, 0};
  Point(p + 2) = {B, y + H, 0};
  Point(p + 3) = {0, y + H, 0};
  l = newl;
  Line(l) = {p, p + 1};
  Line(l + 1) = {p + 1, p + 2};
  Line(l + 2) = {p + 2, p + 3};
  Line(l + 3) = {p + 3, p};
  ll = newll;
  Curve Loop(ll) = {l, l + 1, l + 2, l + 3};
  s = news;
  Plane Surface(s) = {ll};
  Transfinite Curve{l, l + 2} = Ceil(B / size) + 1;
  Transfinite Curve{l + 1, l + 3} = Ceil(H / size) + 1;
  Transfinite Surface{s};
  Recombine Surface{s};
Return

y = -H; size = 2 * h;
Call OneBlock;
Physical Surface("footwall") = {s};
Physical Curve("base") = {l};
Physical Curve("footwall_top") = {l + 2};
Physical Curve("footwall_sides") = {l + 1, l + 3};

y = 0; size = h;
Call OneBlock;
Physical Surface("hanging_wall") = {s};
Physical Curve("hanging_wall_bottom") = {l};
Physical Curve("roof") = {l + 2};
Physical Curve("hanging_wall_sides") = {l + 1, l + 3};
