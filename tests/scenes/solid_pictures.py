#!/usr/bin/python3
"""Draws the pictures of the scenes without contact into inputs/: solid_pictures.py --program PATH [SCENE ...]. Runs what it
draws."""
import argparse
import tempfile

import h5py
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import PolyCollection

import references
import solid_cases
from harness import CELL_NODES, TOP, Bench

SIMULATION = {"marker": "o", "ms": 4, "ls": "", "color": "#d1603d", "label": "Amontons"}
REFERENCE = {"color": "#2f6690", "lw": 1.3}
CORNERS = {4: 3, 5: 4, 36: 3, 35: 4}


def cells_of(results):
    """Corner nodes of the plane cells."""
    with h5py.File(results.folder / "fields.h5", "r") as file:
        topology = file["run0/mesh/topology"][:].ravel()
    cells, at = [], 0
    while at < len(topology):
        code = topology[at]
        cells.append(topology[at + 1 : at + 1 + CORNERS[code]])
        at += 1 + CELL_NODES[code]
    return cells


def draw_deformed(axes, results, values, label, mirrors=((1, 1),)):
    """The deformed cells coloured by the mean of a nodal field, with mirror images."""
    places = (results.places + results.nodal["displacement"])[:, :2]
    cells = cells_of(results)
    colours = [values[cell].mean() for cell in cells]
    for mirror in mirrors:
        patches = PolyCollection([places[cell] * mirror for cell in cells], array=colours, edgecolor="k", linewidth=0.2)
        axes.add_collection(patches)
    plt.colorbar(patches, ax=axes, label=label, shrink=0.7)
    axes.set_aspect("equal")
    axes.autoscale_view()


def cook_membrane(bench):
    figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.8), layout="constrained")
    counts = (4, 10, 15, 20)
    runs = [bench.run("cook_membrane", {"mesh.parameters.n": n}) for n in counts]
    draw_deformed(left, runs[-1], runs[-1].nodal["von_mises"].ravel(), "von Mises stress, MPa")
    right.plot(list(solid_cases.COOK_FBAR), list(solid_cases.COOK_FBAR.values()), "s-", **REFERENCE, label="OpenGeoSys, F-bar")
    right.plot(counts, [solid_cases.corner(run) for run in runs], **SIMULATION)
    right.set_xlabel("cells a side")
    right.set_ylabel("vertical displacement of the corner, mm")
    right.legend()
    return figure


def inflated_cylinder(bench):
    results = bench.run("inflated_cylinder", {"steps.0.increments": 10, "boundary.2.pressure": "0.6*t"})
    grown = [solid_cases.displacement_at(results.at(t), (1.0, 0.0))[0] for t in results.history["time"]]
    figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.6), layout="constrained")
    draw_deformed(left, results, results.stress("yy"), "stress yy / G")
    pressures = np.linspace(0.0, 0.6, 100)
    right.plot([references.inflated_cylinder_growth(p, 1.0, 1.0, 2.0) for p in pressures], pressures, **REFERENCE, label="closed form")
    right.plot(grown, 0.6 * results.history["time"], **SIMULATION)
    right.set_xlabel("displacement of the bore / its radius")
    right.set_ylabel("pressure / G")
    right.legend()
    return figure


def necking_bar(bench):
    results = bench.run("necking_bar")
    law = results.deck["materials"]["steel"]["elastic_plastic"]
    figure, (left, right) = plt.subplots(1, 2, figsize=(9, 4.2), layout="constrained", width_ratios=(1, 1.6))
    draw_deformed(left, results, results.nodal["accumulated_plastic_strain"].ravel(), "plastic strain", ((1, 1), (-1, 1)))
    elongation = np.linspace(0.3, 14.0, 200)
    for share, name in ((1.0, "full section"), (0.982**2, "thinnest section")):
        force = [share * references.round_bar_force(np.log1p(e / 53.334), law, 6.413) for e in elongation]
        right.plot(elongation, force, **REFERENCE, ls="-" if share == 1.0 else "--", label=f"uniform bar of the {name}")
    right.plot(14.0 * results.history["time"], results.history["reaction_end_y"], **SIMULATION)
    right.set_xlabel("elongation, mm")
    right.set_ylabel("force, kN")
    right.set_ylim(0.0)
    right.legend()
    return figure


def pressed_rubber_block(bench):
    results = bench.run("pressed_rubber_block")
    figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.6), layout="constrained")
    draw_deformed(left, results, results.stress("yy"), "axial stress, MPa", ((1, 1), (1, -1)))
    shapes = np.linspace(0.4, 2.2, 50)
    right.plot(shapes, 1.0 + 2.0 * shapes**2, **REFERENCE, label="Gent and Lindley: 1 + 2 S²")
    shapes, moduli = zip(*(solid_cases.apparent_modulus(bench, height) for height in solid_cases.HALF_HEIGHTS))
    right.plot(shapes, moduli, **SIMULATION)
    right.set_xlabel("shape factor S = radius / (2 height)")
    right.set_ylabel("apparent modulus / E")
    right.legend()
    return figure


SCENES = {function.__name__: function for function in (cook_membrane, inflated_cylinder, necking_bar, pressed_rubber_block)}


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scenes", nargs="*", choices=[[], *SCENES])
    parser.add_argument("--program", required=True)
    parser.add_argument("--ranks", type=int, default=1)
    options = parser.parse_args()
    for scene in options.scenes or SCENES:
        with tempfile.TemporaryDirectory() as folder:
            bench = Bench(options.program, ["mpirun", "--oversubscribe", "--bind-to", "none"], options.ranks, folder)
            figure = SCENES[scene](bench)
            figure.savefig(TOP / "inputs" / scene / f"{scene}.png", dpi=110)


if __name__ == "__main__":
    main()
