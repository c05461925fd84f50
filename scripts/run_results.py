"""What a run leaves behind, read for pictures: the last step of fields.h5, the columns of history.csv."""

import csv
import json
import os

import h5py
import numpy as np

# By the element's code in a Mixed topology: number of nodes, then what pictures need of it: triangles that tile a plane
# element, its edges as chains of nodes, the corners of a solid element's faces.
QUAD9_TILES = [(0, 4, 8), (0, 8, 7), (4, 1, 5), (4, 5, 8), (8, 5, 2), (8, 2, 6), (7, 8, 6), (7, 6, 3)]
TRI6_TILES = [(0, 3, 5), (3, 1, 4), (5, 4, 2), (3, 4, 5)]
PLANE = {
    4: (3, [(0, 1, 2)], [(0, 1), (1, 2), (2, 0)]),
    5: (4, [(0, 1, 2), (0, 2, 3)], [(0, 1), (1, 2), (2, 3), (3, 0)]),
    36: (6, TRI6_TILES, [(0, 3, 1), (1, 4, 2), (2, 5, 0)]),
    35: (9, QUAD9_TILES, [(0, 4, 1), (1, 5, 2), (2, 6, 3), (3, 7, 0)]),
}
TET_FACES = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)]
HEX_FACES = [(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]
SOLID = {6: (4, TET_FACES), 38: (10, TET_FACES), 9: (8, HEX_FACES), 48: (20, HEX_FACES)}
LINE = {2: (2, (0, 1)), 34: (3, (0, 2, 1))}  # nodes in the order along the line


def element_size(code):
    for table in (PLANE, SOLID, LINE):
        if code in table:
            return table[code][0]
    raise ValueError(f"unknown element code {code}")


def split_topology(mixed):
    """Node numbers of a Mixed topology as {code: array of elements x nodes}."""
    mixed = np.asarray(mixed).ravel()
    found, at = {}, 0
    while at < len(mixed):
        code = int(mixed[at])
        at += 2 if code == 2 else 1  # a polyline says how long it is
        size = element_size(code)
        found.setdefault(code, []).append(mixed[at:at + size])
        at += size
    return {code: np.array(elements) for code, elements in found.items()}


def array(group, name):
    return np.asarray(group[name]) if group is not None and name in group else None


class Fields:
    """The last step of fields.h5."""

    def __init__(self, path):
        self.file = h5py.File(path, "r")
        runs = sorted((name for name in self.file if name.startswith("run")), key=lambda name: int(name[3:]))
        steps = [(run, step) for run in runs for step in sorted(self.file[run]) if step.startswith("step_")]
        if not steps:
            raise ValueError("it holds no step")
        run, step = steps[-1]
        self.run, self.step = self.file[run], self.file[run][step]
        self.dim = int(self.run.attrs["dim"])
        self.time = float(self.step.attrs["time"])
        self.places = np.asarray(self.run["mesh/coordinates"])
        self.cells = split_topology(self.run["mesh/topology"])
        self.displacement = array(self.step, "displacement")
        self.mises = array(self.step, "von_mises")
        self.pairs = sorted(set(self.step.get("surfaces", ())) | set(self.step.get("points", ())))

    def moved(self, scale):
        return self.places if self.displacement is None else self.places + scale * self.displacement

    def surface(self, pair):
        """Places, displacement, elements by code and nodal pressure of a pair's slave surface; None where missing."""
        path = f"surfaces/{pair}"
        if path not in self.run or path not in self.step:
            return None
        fixed, now = self.run[path], self.step[path]
        places = np.asarray(fixed["coordinates"])
        return places, array(now, "displacement"), split_topology(fixed["topology"]), array(now, "pressure")

    def points(self, pair):
        """Places, pressure, status, gap and normal at the quadrature points of a pair."""
        path = f"points/{pair}"
        if path not in self.step:
            return None
        group = self.step[path]
        return np.asarray(group["places"]), *(array(group, name) for name in ("pressure", "status", "gap", "normal"))

    def friction(self, pair):
        """Places, weight, pressure, status, shear traction and its limit at the points of a pair; None without friction."""
        group = self.step.get(f"points/{pair}")
        if group is None or "shear" not in group:
            return None
        names = ("places", "weight", "pressure", "status", "shear", "tau_c")
        return {name: np.squeeze(np.asarray(group[name])) for name in names}


def read_history(path):
    with open(path, newline="", encoding="utf-8") as file:
        rows = list(csv.reader(file))
    if len(rows) < 2:
        raise ValueError("it holds no row")
    width = len(rows[0])
    values = np.array([[float(cell) for cell in row] for row in rows[1:] if len(row) == width])
    return {name: values[:, i] for i, name in enumerate(rows[0])}


def read_label(results):
    """A run's directory and its number of increments, to tell it from others of the same scene."""
    with open(os.path.join(results, "summary.json"), encoding="utf-8") as file:
        increments = json.load(file)["increments"]
    return f"{os.path.basename(os.path.abspath(results))}, {increments} increments"
