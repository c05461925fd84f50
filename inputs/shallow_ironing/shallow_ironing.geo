// A slab 12 x 4 and above it an indenter 1.2 wide and 1.2 high whose lower face is an arc of radius 0.75, 0.2 above the
// slab. All cells are quadrilaterals, or hexahedra in `layers` layers over half the thickness of a slice that is 1 thick,
// from its middle plane on; h is their size at the faces that touch.
DefineConstant[ h = {0.2, Name "h"}, layers = {1, Name "layers"} ];   // layers = 0: plane
slab_rows = Ceil(2.5/h);     // thinner towards the face
arc_cells = 2*Ceil(0.75/h);
side_rows = Ceil(1.0/h);

Point(1) = {0, 0, 0};
Point(2) = {12, 0, 0};
Point(3) = {12, 4, 0};
Point(4) = {0, 4, 0};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Transfinite Curve {1, 3} = Ceil(12/h) + 1;
Transfinite Curve {2} = slab_rows + 1 Using Progression 0.9^(1.3*h/0.2);
Transfinite Curve {4} = slab_rows + 1 Using Progression 1/0.9^(1.3*h/0.2);
Transfinite Surface {1};
Recombine Surface {1};

Point(11) = {0.2, 4.5, 0};
Point(12) = {0.8, 4.2, 0};
Point(13) = {1.4, 4.5, 0};
Point(14) = {1.4, 5.4, 0};
Point(15) = {0.2, 5.4, 0};
Point(20) = {0.8, 4.95, 0};
Circle(11) = {11, 20, 12};
Circle(12) = {12, 20, 13};
Line(13) = {13, 14};
Line(14) = {14, 15};
Line(15) = {15, 11};
Curve Loop(2) = {11, 12, 13, 14, 15};
Plane Surface(2) = {2};
Transfinite Curve {11, 12} = arc_cells/2 + 1;
Transfinite Curve {14} = arc_cells + 1;
Transfinite Curve {13, 15} = side_rows + 1;
Transfinite Surface {2} = {11, 13, 14, 15};
Recombine Surface {2};

If (layers == 0)
  Physical Surface("slab") = {1};
  Physical Surface("indenter") = {2};
  Physical Curve("base") = {1};
  Physical Curve("slab_face") = {3};
  Physical Curve("indenter_face") = {11, 12, 13, 15};
  Physical Curve("top") = {14};
Else
  s[] = Extrude {0, 0, 0.5} { Surface{1}; Layers{layers}; Recombine; };   // opposite face, volume, sides in order
  i[] = Extrude {0, 0, 0.5} { Surface{2}; Layers{layers}; Recombine; };
  Physical Volume("slab") = {s[1]};
  Physical Volume("indenter") = {i[1]};
  Physical Surface("base") = {s[2]};
  Physical Surface("slab_face") = {s[4]};
  Physical Surface("indenter_face") = {i[2], i[3], i[4], i[6]};
  Physical Surface("top") = {i[5]};
  Physical Surface("middle") = {1, 2};
EndIf
