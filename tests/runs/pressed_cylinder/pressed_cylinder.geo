// An elastic block, 2 L wide and L deep, with a patch of square cells in the middle of its top.
DefineConstant[
  L = {50, Name "half-width and depth"},
  patch = {1.5, Name "half-width and depth of the refined patch; larger than the contact half-width"},
  h = {0.05, Name "cell size in the patch"}
];

n = Ceil(patch / h); // cells across the patch's depth and half its width
// progression q from h to the outer border in m cells, by bisection
m = Ceil(0.7 * n);
low = 1; high = 5;
For step In {1:60}
  q = (low + high) / 2;
  If (h * q * (q^m - 1) / (q - 1) > L - patch)
    high = q;
  Else
    low = q;
  EndIf
EndFor

x[] = {-L, -patch, patch, L};
y[] = {0, -patch, -L};
For j In {0:2}
  For i In {0:3}
    p[4 * j + i] = newp;
    Point(p[4 * j + i]) = {x[i], y[j], 0};
  EndFor
EndFor
For j In {0:2}
  For i In {0:2}
    a[3 * j + i] = newl;
    Line(a[3 * j + i]) = {p[4 * j + i], p[4 * j + i + 1]};
  EndFor
  Transfinite Curve {-a[3 * j]} = m + 1 Using Progression q;
  Transfinite Curve {a[3 * j + 1]} = 2 * n + 1;
  Transfinite Curve {a[3 * j + 2]} = m + 1 Using Progression q;
EndFor
For i In {0:3}
  For j In {0:1}
    d[2 * i + j] = newl;
    Line(d[2 * i + j]) = {p[4 * j + i], p[4 * (j + 1) + i]};
  EndFor
  Transfinite Curve {d[2 * i]} = n + 1;
  Transfinite Curve {d[2 * i + 1]} = m + 1 Using Progression q;
EndFor
s[] = {};
For j In {0:1}
  For i In {0:2}
    loop = newll;
    Curve Loop(loop) = {d[2 * i + j], a[3 * (j + 1) + i], -d[2 * (i + 1) + j], -a[3 * j + i]};
    t = news;
    Plane Surface(t) = {loop};
    Transfinite Surface {t};
    Recombine Surface {t};
    s[] += {t};
  EndFor
EndFor
Physical Surface("block") = s[];
Physical Curve("top") = {a[1]};
Physical Curve("base") = {a[6], a[7], a[8]};
