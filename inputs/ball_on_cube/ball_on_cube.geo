// Unit cube in n x n x n equal hexahedra, the top at z = 0.
DefineConstant[ n = {16, Name "cells along a side"} ];

Point(1) = {0, 0, -1};
l[] = Extrude{1, 0, 0}{ Point{1}; Layers{n}; };
f[] = Extrude{0, 1, 0}{ Curve{l[1]}; Layers{n}; Recombine; };
v[] = Extrude{0, 0, 1}{ Surface{f[1]}; Layers{n}; Recombine; };

Physical Volume("cube") = {v[1]};
Physical Surface("base") = {f[1]};
Physical Surface("top") = {v[0]};
