// A small block on a larger one, both boxes of hexahedra, meshes that do not match. Boxes stay what they are under
// `refine`, so large models come from a small mesh. The blocks have their own points, so their own nodes.
DefineConstant[
  n = {9, Name "cells along the width of the base"},
  W = {12, Name "width of the base"},
  H = {4, Name "height of the base"},
  w = {8, Name "width of the slider"},
  h = {4, Name "height of the slider"},
  ratio = {1.15, Name "cell size in the base / that in the slider; not 1: the meshes do not match"}
];

// Makes one box of `side` x `side` x `height` above z = `foot`, centred in x and y, with cells of about `size`.
Macro Brick
  p = newp;
  Point(p) = {-side / 2, -side / 2, foot};
  l = newl;
  Extrude {side, 0, 0} { Point{p}; Layers{Round(side / size)}; }
  base[] = Extrude {0, side, 0} { Line{l}; Layers{Round(side / size)}; Recombine; };
  body[] = Extrude {0, 0, height} { Surface{base[1]}; Layers{Round(height / size)}; Recombine; };
Return

side = W; height = H; foot = -H; size = W / n;
Call Brick;
Physical Volume("base") = {body[1]};
Physical Surface("base_bottom") = {base[1]};
Physical Surface("base_top") = {body[0]};

side = w; height = h; foot = 0; size = W / (n * ratio);
Call Brick;
Physical Volume("slider") = {body[1]};
Physical Surface("slider_bottom") = {base[1]};
Physical Surface("slider_top") = {body[0]};
