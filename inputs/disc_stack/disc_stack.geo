// Discs in a square packing that fills a box: `columns` x `rows` cells of side 2 R, one disc in each. With `interference`
// the discs are larger than their cells by that much all round, so that they touch from the start. Each rim has four arcs
// of +-30 degrees about its poles, where it touches a neighbour or the box; the cells are small there.
DefineConstant[
  columns = {3, Name "discs side by side"},
  rows = {4, Name "discs one above the other"},
  R = {10, Name "half of the spacing of the discs"},
  interference = {0.015, Name "radius of the discs - R"},
  h = {0.1, Name "cell size at the poles"},
  growth = {0.2, Name "growth of the cell size with the distance from the poles"}
];

radius = R + interference;
poles[] = {};
For j In {0:rows - 1}
  top~{j}[] = {}; bottom~{j}[] = {};
EndFor
For i In {0:columns - 1}
  east~{i}[] = {}; west~{i}[] = {};
EndFor
For j In {0:rows - 1}
  For i In {0:columns - 1}
    x = (2 * i + 1) * R; y = (2 * j + 1) * R;
    centre = newp;
    Point(centre) = {x, y, 0};
    // rim points: three about each pole (east, north, west, south), counter-clockwise
    rim[] = {};
    For k In {0:11}
      angle = (Floor(k / 3) * 90 + (k % 3 - 1) * 30) * Pi / 180;
      p = newp;
      Point(p) = {x + radius * Cos(angle), y + radius * Sin(angle), 0};
      rim[] += p;
      If (k % 3 == 1)
        poles[] += p;
      EndIf
    EndFor
    arc[] = {};
    For k In {0:11}
      l = newl;
      Circle(l) = {rim[k], centre, rim[(k + 1) % 12]};
      arc[] += l;
    EndFor
    loop = newll;
    Curve Loop(loop) = {arc[]};
    s = news;
    Plane Surface(s) = {loop};
    Physical Surface(Sprintf("disc_%g_%g", i + 1, j + 1)) = {s};
    east~{i}[] += {arc[0], arc[1]};
    top~{j}[] += {arc[3], arc[4]};
    west~{i}[] += {arc[6], arc[7]};
    bottom~{j}[] += {arc[9], arc[10]};
  EndFor
EndFor

For i In {0:columns - 1}
  Physical Curve(Sprintf("east_%g", i + 1)) = east~{i}[];
  Physical Curve(Sprintf("west_%g", i + 1)) = west~{i}[];
EndFor
For j In {0:rows - 1}
  Physical Curve(Sprintf("top_%g", j + 1)) = top~{j}[];
  Physical Curve(Sprintf("bottom_%g", j + 1)) = bottom~{j}[];
EndFor

Field[1] = Distance;
Field[1].PointsList = {poles[]};
Field[2] = MathEval;
Field[2].F = Sprintf("%g + %g*Max(0, F1 - %g)", h, growth, 0.06 * R);
Background Field = 2;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
Mesh.Algorithm = 6;
