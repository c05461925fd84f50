// Ten discs of radius R in a box that is six radii wide: rows of three and two in turn, each disc in the valley between
// those below it. `interference`: radius of the discs - R, so that all of them touch from the start.
DefineConstant[
  R = {10, Name "half of the spacing of the discs"},
  interference = {0.02, Name "radius of the discs - R"},
  n = {40, Name "facets around a disc"}
];

radius = R + interference;
all[] = {}; discs = 0;
For row In {0:3}
  count = (row % 2 == 0) ? 3 : 2;
  For i In {0:count - 1}
    discs = discs + 1;
    x = (2 * i + ((row % 2 == 0) ? 1 : 2)) * R;
    y = R + row * Sqrt(3) * R;
    centre = newp; Point(centre) = {x, y, 0};
    rim[] = {}; arcs[] = {};
    For k In {0:3}
      p = newp; Point(p) = {x + radius * Cos(k * Pi / 2), y + radius * Sin(k * Pi / 2), 0};
      rim[] += p;
    EndFor
    For k In {0:3}
      a = newl; Circle(a) = {rim[k], centre, rim[(k + 1) % 4]};
      arcs[] += a;
    EndFor
    Transfinite Curve {arcs[]} = n / 4 + 1;
    l = newll; Curve Loop(l) = {arcs[]};
    s = news; Plane Surface(s) = {l};
    Physical Surface(Sprintf("disc_%g", discs)) = {s};
    all[] += {arcs[]};
  EndFor
EndFor
Physical Curve("rims") = {all[]};
Mesh.Algorithm = 6;
