Point(1) = {0, 0, 0, 1}; Point(2) = {1, 0, 0, 1}; Line(1) = {1, 2};
s[] = Extrude{0, 1, 0}{ Curve{1}; };
v[] = Extrude{0, 0, 1}{ Surface{s[1]}; };
shell[] = Translate{3, 0, 0}{ Duplicata{ Surface{s[1]}; } };
Physical Volume("body") = {v[1]}; Physical Surface("bottom") = {s[1]}; Physical Surface("shell") = {shell[]};
