// A block with a round face (radius R) on one with a flat face: each 2 L wide and L high, with a patch of nearly square
// cells where they touch, at (0, 0). The theory knows a cylinder only by the curvature of its face.
DefineConstant[
  R = {500, Name "radius of the round face"},
  L = {40, Name "half-width and height of each block"},
  patch = {1.0, Name "half-width and depth of the refined patch; larger than the contact half-width"},
  h = {0.0371395, Name "cell size in the patch of the lower block"},
  ratio = {1, Name "cell size in the patch of the upper block / h; not 1: the meshes do not match"}
];

// Makes one block on the side s of y = 0 (+1 above, -1 below) with n cells across the patch's depth and half its width;
// its face is a circle when `round` is set. Leaves surfaces[], face[], far[].
Macro Body
  // progression q from the patch's cell size to the outer border in m cells, by bisection
  m = Ceil(0.7 * n);
  low = 1; high = 5;
  For step In {1:60}
    q = (low + high) / 2;
    If (patch / n * q * (q^m - 1) / (q - 1) > L - patch)
      high = q;
    Else
      low = q;
    EndIf
  EndFor
  centre = newp;
  Point(centre) = {0, s * R, 0};
  x[] = {-L, -patch, patch, L};
  p[] = {};
  For i In {0:3}
    rise = round ? R - Sqrt(R * R - x[i] * x[i]) : 0;
    id = newp;
    Point(id) = {x[i], s * rise, 0};
    Point(id + 1) = {x[i], s * (patch + rise * (1 - patch / L)), 0};
    Point(id + 2) = {x[i], s * L, 0};
    p[] += {id, id + 1, id + 2};
  EndFor
  // a[3 j + i]: piece i along layer j; d[2 i + j]: piece j along column i
  a[] = {};
  For j In {0:2}
    For i In {0:2}
      id = newl;
      If (round && j == 0)
        Circle(id) = {p[3 * i], centre, p[3 * (i + 1)]};
      Else
        Line(id) = {p[3 * i + j], p[3 * (i + 1) + j]};
      EndIf
      a[] += {id};
    EndFor
    Transfinite Curve {-a[3 * j]} = m + 1 Using Progression q;
    Transfinite Curve {a[3 * j + 1]} = 2 * n + 1;
    Transfinite Curve {a[3 * j + 2]} = m + 1 Using Progression q;
  EndFor
  d[] = {};
  For i In {0:3}
    For j In {0:1}
      id = newl;
      Line(id) = {p[3 * i + j], p[3 * i + j + 1]};
      d[] += {id};
    EndFor
    Transfinite Curve {d[2 * i]} = n + 1;
    Transfinite Curve {d[2 * i + 1]} = m + 1 Using Progression q;
  EndFor
  surfaces[] = {};
  For j In {0:1}
    For i In {0:2}
      id = newll;
      If (s < 0)
        Curve Loop(id) = {d[2 * i + j], a[3 * (j + 1) + i], -d[2 * (i + 1) + j], -a[3 * j + i]};
      Else
        Curve Loop(id) = {a[3 * j + i], d[2 * (i + 1) + j], -a[3 * (j + 1) + i], -d[2 * i + j]};
      EndIf
      t = news;
      Plane Surface(t) = {id};
      Transfinite Surface {t};
      Recombine Surface {t};
      surfaces[] += {t};
    EndFor
  EndFor
  face[] = a[{0:2}];
  far[] = a[{6:8}];
Return

s = -1; round = 0; n = Ceil(patch / h);
Call Body;
Physical Surface("lower") = surfaces[];
Physical Curve("lower_face") = face[];
Physical Curve("base") = far[];

s = 1; round = 1; n = Ceil(patch / (ratio * h));
Call Body;
Physical Surface("upper") = surfaces[];
Physical Curve("upper_face") = face[];
Physical Curve("top") = far[];
