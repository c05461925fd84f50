// A quarter (x, y >= 0) of a square or round blank, its lower face at z = 0, one cell thick, and above its outer part the
// same quarter of the blank holder, a flat frame or ring. Both are cut along the diagonal; in the middle of the blank
// there is a square block, which stays flat under the punch. mm.
DefineConstant[
  round = {0, Name "1: round blank and holder, 0: square ones"},
  blank = {75, Name "half width (radius) of the blank"},
  t = {0.81, Name "thickness of the blank"},
  flat = {24, Name "half width of the block in the middle"},
  inside = {39, Name "half width (radius) of the holder's opening"},
  outside = {80, Name "half width (radius) of the holder"},
  thick = {15, Name "thickness of the holder"},
  n = {8, Name "cells from the middle block to the rim"},
  m = {4, Name "cells from a plane of symmetry to the diagonal"},
  grow = {1, Name "ratio of the sizes of two cells, outwards from the middle block"},
  towards = {1, Name "ratio of the sizes of two cells of the sheet, towards the diagonal"}
];
Macro Outline // points p0..p2 from the x axis over the diagonal to the y axis at `width`; curves c0, c1 between them
  d = bent ? width / Sqrt(2) : width;
  p0 = newp; Point(p0) = {width, 0, z};
  p1 = newp; Point(p1) = {d, d, z};
  p2 = newp; Point(p2) = {0, width, z};
  c0 = newl;
  If (bent)
    Circle(c0) = {p0, middle, p1};
  Else
    Line(c0) = {p0, p1};
  EndIf
  c1 = newl;
  If (bent)
    Circle(c1) = {p1, middle, p2};
  Else
    Line(c1) = {p1, p2};
  EndIf
  Transfinite Curve {c0} = cells + 1 Using Progression ratio;
  Transfinite Curve {c1} = cells + 1 Using Progression 1 / ratio;
Return
Macro Between // faces between the last outline and a new one at `width`: s0 at the x axis, s1 at the y axis
  a0 = p0; a1 = p1; a2 = p2; b0 = c0; b1 = c1;
  Call Outline;
  r0 = newl; Line(r0) = {a0, p0};
  r1 = newl; Line(r1) = {a1, p1};
  r2 = newl; Line(r2) = {a2, p2};
  Transfinite Curve {r0, r1, r2} = along + 1 Using Progression outwards;
  l0 = newll; Curve Loop(l0) = {r0, c0, -r1, -b0};
  s0 = news; Plane Surface(s0) = {l0};
  l1 = newll; Curve Loop(l1) = {r1, c1, -r2, -b1};
  s1 = news; Plane Surface(s1) = {l1};
  Transfinite Surface {s0, s1};
  Recombine Surface {s0, s1};
Return

z = 0; middle = newp; Point(middle) = {0, 0, z};
cells = m; ratio = towards; outwards = grow;
bent = 0; width = flat;
Call Outline;
q0 = newl; Line(q0) = {middle, p0};
q1 = newl; Line(q1) = {p2, middle};
Transfinite Curve {q0} = m + 1 Using Progression ratio;
Transfinite Curve {q1} = m + 1 Using Progression 1 / ratio;
l = newll; Curve Loop(l) = {q0, c0, c1, q1};
s = news; Plane Surface(s) = {l};
Transfinite Surface {s} = {middle, p0, p1, p2};
Recombine Surface {s};
bent = round; width = blank; along = n;
Call Between;
made[] = Extrude {0, 0, t} { Surface{s, s0, s1}; Layers{1}; Recombine; }; // each: top, volume, faces over its four lines
Physical Volume("sheet") = {made[1], made[7], made[13]};
Physical Surface("lower") = {s, s0, s1};
Physical Surface("upper") = {made[0], made[6], made[12]};
Physical Surface("on_x") = {made[5], made[16]}; // in the plane x = 0
Physical Surface("on_y") = {made[2], made[8]};  // in the plane y = 0

z = t; middle = newp; Point(middle) = {0, 0, z};
cells = 3; ratio = 1; outwards = 1; width = inside;
Call Outline;
width = outside; along = 2;
Call Between;
made[] = Extrude {0, 0, thick} { Surface{s0, s1}; Layers{1}; Recombine; };
Physical Volume("ring") = {made[1], made[7]};
Physical Surface("ring_face") = {s0, s1};
Physical Surface("ring_top") = {made[0], made[6]};
