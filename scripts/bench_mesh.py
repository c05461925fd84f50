"""The mesh of a deck for other programs: made by gmsh from the deck's .geo, read from its .msh format 2.2."""

import subprocess
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from deck_edit import StudyError

# gmsh's element code -> nodes, dimension.
ELEMENTS = {1: (2, 1), 2: (3, 2), 3: (4, 2), 4: (4, 3), 5: (8, 3)}
# Corners of the faces of a cell by its dimension and nodes, in the order and orientation in which CalculiX numbers them.
FACES = {(3, 8): [(0, 1, 2, 3), (4, 7, 6, 5), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 4, 0)],
         (3, 4): [(0, 1, 2), (0, 3, 1), (1, 3, 2), (2, 3, 0)],
         (2, 4): [(0, 1), (1, 2), (2, 3), (3, 0)],
         (2, 3): [(0, 1), (1, 2), (2, 0)]}
DIMENSION = {"solid": 3, "plane_strain": 2}  # of the spaces that other programs are given


@dataclass
class BenchMesh:
    """Nodes (n x 3, flat meshes in z = 0), blocks of cells and facets of every surface as arrays of node numbers from 0. A block
    is a body's name and those of its cells that have the same number of nodes."""
    dimension: int
    nodes: np.ndarray
    blocks: list = field(default_factory=list)
    surfaces: dict = field(default_factory=dict)

    def faces_of(self, name):
        """(number of the cell in all blocks, number of its face), both from 0, of every facet of a surface."""
        wanted = {tuple(sorted(facet)) for facet in self.surfaces[name].tolist()}
        found, first = [], 0
        for _, cells in self.blocks:
            for face, corners in enumerate(FACES[self.dimension, cells.shape[1]]):
                keys = np.sort(cells[:, corners], axis=1)
                found += [(first + cell, face) for cell, key in enumerate(map(tuple, keys.tolist())) if key in wanted]
            first += len(cells)
        if len(found) != len(wanted):
            raise StudyError(f"the surface '{name}' is not the border of cells")
        return found

    def facet_size(self, name):
        """Side of the smallest facet of a surface."""
        corners = self.nodes[self.surfaces[name]]
        sides = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)
        return float(sides.mean(axis=1).min())


def make_mesh(deck, place):
    """Runs gmsh on the deck's .geo with its parameters; the mesh is left in place/mesh.msh. Errors: StudyError."""
    path = place / "mesh.msh"
    dimension = DIMENSION[deck["space"]]
    command = ["gmsh", f"-{dimension}", "-format", "msh2", "-v", "1", "-order", "1"]
    for name, value in (deck["mesh"].get("parameters") or {}).items():
        command += ["-setnumber", name, str(value)]
    try:
        done = subprocess.run([*command, "-o", str(path), deck["mesh"]["file"]], capture_output=True, text=True,
                              check=False)
    except OSError as error:
        raise StudyError(f"gmsh cannot be run ({error}); apt-get install gmsh") from error
    if done.returncode or not path.exists():
        raise StudyError(f"gmsh made no mesh: {done.stdout[-300:]} {done.stderr[-300:]}")
    return read_mesh(path, dimension)


def blocks(path):
    """Sections of a .msh file as lists of lines."""
    found, name = {}, None
    for line in Path(path).read_text(encoding="utf-8").splitlines():
        if line.startswith("$"):
            name = None if line.startswith("$End") else line[1:]
            continue
        if name:
            found.setdefault(name, []).append(line)
    return found


def read_mesh(path, dimension):
    """Bodies and surfaces of a .msh file, with the nodes that cells use."""
    sections = blocks(path)
    names = {}
    for line in sections["PhysicalNames"][1:]:
        size, number, name = line.split(maxsplit=2)
        names[int(size), int(number)] = name.strip('"')
    table = np.array([line.split() for line in sections["Nodes"][1:]], dtype=float)
    position = {int(number): i for i, number in enumerate(table[:, 0])}
    groups = {}
    for line in sections["Elements"][1:]:
        numbers = [int(word) for word in line.split()]
        count, size = ELEMENTS.get(numbers[1], (0, 0))
        if (size, numbers[3]) in names:
            nodes = [position[node] for node in numbers[-count:]]
            groups.setdefault((size, names[size, numbers[3]], count), []).append(nodes)
    cells = {key: np.array(elements) for key, elements in groups.items() if key[0] == dimension}
    used = np.unique(np.concatenate([block.ravel() for block in cells.values()]))
    renumbered = np.full(len(table), -1)
    renumbered[used] = np.arange(len(used))
    mesh = BenchMesh(dimension, table[used, 1:])
    mesh.blocks = [(name, upright(mesh.nodes, renumbered[block], dimension)) for (_, name, _), block in cells.items()]
    for (size, name, _), facets in groups.items():
        if size == dimension - 1:
            if name in mesh.surfaces:
                raise StudyError(f"the surface '{name}' has triangles and quadrilaterals: peers are given one kind")
            mesh.surfaces[name] = renumbered[np.array(facets)]
    return mesh


def upright(nodes, cells, dimension):
    """Cells whose first edges make a left-handed system are turned over."""
    corners, count = nodes[cells], cells.shape[1]
    if dimension == 2:
        along, across = corners[:, 1] - corners[:, 0], corners[:, -1] - corners[:, 0]
        wrong = along[:, 0] * across[:, 1] - along[:, 1] * across[:, 0] < 0.0
        return np.where(wrong[:, None], cells[:, ::-1], cells)
    side, last = (3, 4) if count == 8 else (2, 3)
    edges = [corners[:, i] - corners[:, 0] for i in (1, side, last)]
    wrong = np.einsum("ij,ij->i", np.cross(edges[0], edges[1]), edges[2]) < 0.0
    order = [4, 5, 6, 7, 0, 1, 2, 3] if count == 8 else [0, 2, 1, 3]
    return np.where(wrong[:, None], cells[:, order], cells)
