// Two blocks of 1 x 1 x 0.5, one on the other; their meshes do not match. Own points, so own nodes.
DefineConstant[
  n_lower = {3, Name "cells along an edge of the lower block"},
  n_upper = {7, Name "cells along an edge of the upper block"},
  hexes = {1, Name "1: hexahedra, 0: tetrahedra"},
  structured = {1, Name "1: regular mesh of the interface, 0: unstructured"},
  serendipity = {0, Name "1: of order 2 cells without nodes on the middles of faces and cells (20 nodes), 0: with (27)"}
];
Mesh.SecondOrderIncomplete = serendipity;

// Hexahedra are extruded from the base, so that an unstructured base of quadrilaterals serves as well. Of tetrahedra only
// the faces below and above can be regular.
Macro OneBlock
  p = newp;
  Point(p) = {0, 0, z, 1 / n};
  Point(p + 1) = {1, 0, z, 1 / n};
  Point(p + 2) = {1, 1, z, 1 / n};
  Point(p + 3) = {0, 1, z, 1 / n};
  l = newl;
  Line(l) = {p, p + 1};
  Line(l + 1) = {p + 1, p + 2};
  Line(l + 2) = {p + 2, p + 3};
  Line(l + 3) = {p + 3, p};
  ll = newll;
  Curve Loop(ll) = {l, l + 1, l + 2, l + 3};
  base = news;
  Plane Surface(base) = {ll};
  If (structured)
    Transfinite Curve{l:l + 3} = n + 1;
    Transfinite Surface{base};
  EndIf
  If (hexes)
    Recombine Surface{base};
    out[] = Extrude{0, 0, 0.5}{ Surface{base}; Layers{Ceil(n / 2)}; Recombine; };
  Else
    out[] = Extrude{0, 0, 0.5}{ Surface{base}; };
    If (structured)
      far[] = Abs(Boundary{ Surface{out[0]}; });
      Transfinite Curve{far[]} = n + 1;
      Transfinite Surface{out[0]};
    EndIf
  EndIf
Return

// Extrude gives: out[0] the far face, out[1] the volume, out[2..5] the faces over the four lines.
n = n_lower; z = 0;
Call OneBlock;
Physical Volume("lower") = {out[1]};
Physical Surface("lower_bottom") = {base};
Physical Surface("lower_top") = {out[0]};
Physical Surface("lower_front") = {out[2]};
Physical Surface("lower_left") = {out[5]};

// Extrude unites points at the same place, also those of the two bodies: so the upper block is made apart and moved.
n = n_upper; z = 1;
Call OneBlock;
Geometry.AutoCoherence = 0;
Translate{0, 0, -0.5}{ Volume{out[1]}; }
Physical Volume("upper") = {out[1]};
Physical Surface("upper_bottom") = {base};
Physical Surface("upper_top") = {out[0]};
Physical Surface("upper_front") = {out[2]};
Physical Surface("upper_left") = {out[5]};
