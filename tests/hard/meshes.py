"""Tiny meshes of blocks, made and changed in place: perturbed, bent, moved, scaled, numbered anew; written as MSH 2.2."""
import itertools

import numpy as np

# MSH element types. Boxes have one kind of cells and one of facets; the order of nodes is that of gmsh.
LINE, TRIANGLE, QUAD, HEX = 1, 2, 3, 5
DIMENSION = {LINE: 1, TRIANGLE: 2, QUAD: 2, HEX: 3}
SIDES = [("left", "right"), ("bottom", "top"), ("front", "back")]  # along x, y, z
JITTER = 0.2  # of a cell: how far a seed moves nodes


class Mesh:
    """Nodes (n x 3), elements (type, nodes, group) and the groups' (dimension, name), numbered from 1."""

    def __init__(self, seed=0):
        self.nodes, self.elements, self.groups = np.zeros((0, 3)), [], []
        self.random = np.random.default_rng(seed) if seed else None

    def group(self, dimension, name):
        if (dimension, name) not in self.groups:
            self.groups.append((dimension, name))
        return self.groups.index((dimension, name)) + 1

    def box(self, body, low, high, counts, bend=None, triangles=False):
        """A block as the group `body` with the groups body_left, body_right, body_bottom ... for its sides. `bend` maps
        a place to another. With a seed, nodes move, those of a side within it: before bending, the block is the same."""
        dim, first = len(counts), len(self.nodes)
        for index in itertools.product(*[range(n + 1) for n in counts]):
            place = np.zeros(3)
            for c, (i, n) in enumerate(zip(index, counts)):
                shift = self.random.uniform(-JITTER, JITTER) if self.random is not None and 0 < i < n else 0.0
                place[c] = low[c] + (high[c] - low[c]) * (i + shift) / n
            self.nodes = np.vstack([self.nodes, place if bend is None else bend(place)])

        def corners(index, axes):
            """Nodes of the cell or facet at `index` that spans `axes`, counter-clockwise about the third axis."""
            steps = {1: [(0,), (1,)], 2: [(0, 0), (1, 0), (1, 1), (0, 1)]}
            steps[3] = [(*step, k) for k in (0, 1) for step in steps[2]]
            at = []
            for step in steps[len(axes)]:
                place = list(index)
                for axis, more in zip(axes, step):
                    place[axis] += more
                at.append(first + int(np.ravel_multi_index(place, [n + 1 for n in counts])))
            return at

        tag = self.group(dim, body)
        for index in itertools.product(*[range(n) for n in counts]):
            cell = corners(index, range(dim))
            if triangles:
                self.elements += [(TRIANGLE, [cell[0], cell[1], cell[2]], tag), (TRIANGLE, [cell[0], cell[2], cell[3]], tag)]
            else:
                self.elements.append(({2: QUAD, 3: HEX}[dim], cell, tag))
        for axis, side in itertools.product(range(dim), (0, 1)):
            tag = self.group(dim - 1, f"{body}_{SIDES[axis][side]}")
            others = [other for other in range(dim) if other != axis]
            for index in itertools.product(*[range(1) if a == axis else range(n) for a, n in enumerate(counts)]):
                place = [counts[axis] * side if a == axis else i for a, i in enumerate(index)]
                self.elements.append(({2: LINE, 3: QUAD}[dim], corners(place, others), tag))

    def rotate(self, degrees):
        """About the z axis."""
        c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
        self.nodes = self.nodes @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]).T

    def move(self, shift):
        self.nodes = self.nodes + np.asarray(shift)

    def scale(self, factor):
        self.nodes = self.nodes * factor

    def renumber(self, seed):
        """Nodes and elements in another order."""
        random = np.random.default_rng(seed)
        place = random.permutation(len(self.nodes))  # of a node among the new ones
        nodes = np.empty_like(self.nodes)
        nodes[place] = self.nodes
        self.nodes = nodes
        self.elements = [(kind, [int(place[n]) for n in element], tag) for kind, element, tag in self.elements]
        self.elements = [self.elements[i] for i in random.permutation(len(self.elements))]

    def write(self, path):
        lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", str(len(self.groups))]
        lines += [f'{dim} {i + 1} "{name}"' for i, (dim, name) in enumerate(self.groups)]
        lines += ["$EndPhysicalNames", "$Nodes", str(len(self.nodes))]
        lines += [f"{i + 1} {x:.17g} {y:.17g} {z:.17g}" for i, (x, y, z) in enumerate(self.nodes)]
        lines += ["$EndNodes", "$Elements", str(len(self.elements))]
        for i, (kind, element, tag) in enumerate(self.elements):
            lines.append(f"{i + 1} {kind} 2 {tag} {tag} " + " ".join(str(n + 1) for n in element))
        path.write_text("\n".join([*lines, "$EndElements", ""]), encoding="utf-8")


def read_mesh(path):
    """A mesh of MSH 2.2 as gmsh writes it, with elements of any kind."""
    words = iter(path.read_text(encoding="utf-8").split("\n"))
    mesh, tags, numbers = Mesh(), {}, {}
    for line in words:
        if line == "$PhysicalNames":
            for _ in range(int(next(words))):
                dim, tag, name = next(words).split(maxsplit=2)
                tags[int(dim), int(tag)] = mesh.group(int(dim), name.strip('"'))
        elif line == "$Nodes":
            rows = [next(words).split() for _ in range(int(next(words)))]
            numbers = {row[0]: i for i, row in enumerate(rows)}
            mesh.nodes = np.array([[float(x) for x in row[1:]] for row in rows])
        elif line == "$Elements":
            for _ in range(int(next(words))):
                row = next(words).split()
                kind, dim = int(row[1]), {15: 0, **DIMENSION, 4: 3}.get(int(row[1]))
                if (dim, int(row[3])) in tags:
                    nodes = [numbers[n] for n in row[3 + int(row[2]) :]]
                    mesh.elements.append((kind, nodes, tags[dim, int(row[3])]))
    return mesh
