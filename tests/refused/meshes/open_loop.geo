h = 0.5;
Point(1) = {0, 0, 0, h}; Point(2) = {1, 1, 0, h}; Point(3) = {1, 0, 0, h};
Line(1) = {1, 2}; Line(2) = {2, 3}; Curve Loop(1) = {1, 2}; Plane Surface(1) = {1};
Physical Surface("body") = {1}; Physical Curve("bottom") = {1};
