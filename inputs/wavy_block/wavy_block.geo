// Half a wavelength of a block with a wavy top, y = -amplitude (1 - cos(2 pi x / length)), depth below it: x from a
// crest to a trough. Equal cells.
DefineConstant[
  length = {2, Name "wavelength"},
  amplitude = {0.001, Name "of the wave: half of the height from trough to crest"},
  depth = {2, Name "of the block"},
  n = {32, Name "cells along half a wavelength"},
  quads = {1, Name "quadrilaterals (1) or triangles (0)"}
];

half = length / 2;
fine = 64; // points that the curve of the wave goes through
For i In {0:fine}
  x = half * i / fine;
  Point(1 + i) = {x, -amplitude * (1 - Cos(2 * Pi * x / length)), 0};
EndFor
Point(101) = {0, -depth, 0};
Point(102) = {half, -depth, 0};
Spline(1) = {1:fine + 1};
Line(2) = {1, 101};
Line(3) = {101, 102};
Line(4) = {102, fine + 1};
Curve Loop(1) = {-1, 2, 3, 4};
Plane Surface(1) = {1};
Transfinite Curve{1, 3} = n + 1;
Transfinite Curve{2, 4} = Round(n * depth / half) + 1;
Transfinite Surface{1} = {1, 101, 102, fine + 1};
If (quads)
  Recombine Surface{1};
EndIf

Physical Surface("block") = {1};
Physical Curve("wave") = {1};
Physical Curve("sides") = {2, 4};
Physical Curve("base") = {3};
