// Four square plates on each other, W x W and H thick: 1 and 3 in hexahedra, 2 and 4 in tetrahedra, with cells of
// different sizes.
DefineConstant[
  W = {8, Name "width"},
  H = {2, Name "thickness of a plate"},
  n = {4, Name "cells along the width of plate 1"}
];

// Cells along the width from plate 1 upwards, and whether they are hexahedra. Every plate has its own points, so its own
// nodes.
cells[] = {n, n + 2, n + 1, n + 3};
hexahedra[] = {1, 0, 1, 0};
For i In {0:3}
  // corners anticlockwise, those of the bottom first; lines: bottom, top, upright
  p[] = {};
  For corner In {0:7}
    id = newp;
    Point(id) = {(corner % 4 == 1 || corner % 4 == 2) ? W : 0, (corner % 4 > 1) ? W : 0, (i + (corner > 3 ? 1 : 0)) * H};
    p[] += id;
  EndFor
  flat[] = {}; upright[] = {};
  For k In {0:7}
    id = newl;
    Line(id) = {p[k], p[k % 4 == 3 ? k - 3 : k + 1]};
    flat[] += id;
  EndFor
  For k In {0:3}
    id = newl;
    Line(id) = {p[k], p[k + 4]};
    upright[] += id;
  EndFor
  Transfinite Curve{flat[]} = cells[i] + 1;
  Transfinite Curve{upright[]} = Ceil(cells[i] * H / W) + 1;
  face[] = {};
  For k In {0:5}
    id = newll;
    If (k == 4)
      Curve Loop(id) = {flat[{0:3}]};
    ElseIf (k == 5)
      Curve Loop(id) = {flat[{4:7}]};
    Else
      Curve Loop(id) = {flat[k], upright[(k + 1) % 4], -flat[k + 4], -upright[k]};
    EndIf
    f = news;
    Plane Surface(f) = {id};
    face[] += f;
  EndFor
  id = newsl;
  Surface Loop(id) = {face[]};
  v = newv;
  Volume(v) = {id};
  If (hexahedra[i])
    Transfinite Surface{face[]};
    Recombine Surface{face[]};
    Transfinite Volume{v};
  EndIf
  Physical Volume(Sprintf("plate_%g", i + 1)) = {v};
  Physical Surface(Sprintf("bottom_%g", i + 1)) = {face[4]};
  Physical Surface(Sprintf("top_%g", i + 1)) = {face[5]};
  Physical Surface(Sprintf("ends_%g", i + 1)) = {face[1], face[3]};
EndFor
