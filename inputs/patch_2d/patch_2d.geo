// Two blocks of width 1 and height 0.5, one on the other; their meshes do not match. Own points, so own nodes.
DefineConstant[
  n_lower = {3, Name "cells along the lower block"},
  n_upper = {7, Name "cells along the upper block"},
  quads = {1, Name "1: quadrilaterals, 0: triangles"},
  structured = {1, Name "1: regular mesh, 0: unstructured"},
  serendipity = {0, Name "1: of order 2 cells without a node in the middle (8 nodes), 0: with (9)"}
];
Mesh.SecondOrderIncomplete = serendipity;

Macro OneBlock
  p = newp;
  Point(p) = {0, y, 0, 1 / n};
  Point(p + 1) = {1, y, 0, 1 / n};
  Point(p + 2) = {1, y + 0.5, 0, 1 / n};
  Point(p + 3) = {0, y + 0.5, 0, 1 / n};
  l = newl;
  Line(l) = {p, p + 1};
  Line(l + 1) = {p + 1, p + 2};
  Line(l + 2) = {p + 2, p + 3};
  Line(l + 3) = {p + 3, p};
  ll = newll;
  Curve Loop(ll) = {l, l + 1, l + 2, l + 3};
  s = news;
  Plane Surface(s) = {ll};
  If (structured)
    Transfinite Curve{l, l + 2} = n + 1;
    Transfinite Curve{l + 1, l + 3} = Ceil(n / 2) + 1;
    Transfinite Surface{s};
  EndIf
  If (quads)
    Recombine Surface{s};
  EndIf
Return

n = n_lower; y = 0;
Call OneBlock;
Physical Surface("lower") = {s};
Physical Curve("lower_bottom") = {l};
Physical Curve("lower_top") = {l + 2};
Physical Curve("lower_left") = {l + 3};

n = n_upper; y = 0.5;
Call OneBlock;
Physical Surface("upper") = {s};
Physical Curve("upper_bottom") = {l};
Physical Curve("upper_top") = {l + 2};
Physical Curve("upper_left") = {l + 3};
