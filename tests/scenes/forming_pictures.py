#!/usr/bin/python3
"""Draws the pictures of the forming scenes and of ring_crush into inputs/: forming_pictures.py --program PATH [SCENE ...]. Runs what it draws."""
import argparse
import tempfile

import h5py
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import matplotlib.tri as tri
import numpy as np
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

import forming_cases as cases
import self_contact_cases as rings
from harness import CELL_NODES, TOP, Bench
from solid_pictures import REFERENCE, SIMULATION, draw_deformed


def upsetting(bench):
    smooth = bench.run("upsetting", {"contact": [cases.SMOOTH], "mesh.parameters": {"n": 4, "m": 6}, "steps.0.increments": 20})
    rough = bench.run("upsetting")
    figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.8), layout="constrained")
    mirrors = ((1, 1), (-1, 1), (1, -1), (-1, -1))
    draw_deformed(left, rough, rough.nodal["accumulated_plastic_strain"].ravel(), "plastic strain", mirrors)
    left.set_title("rough plates, half of the height")
    law = cases.billet_law(rough)
    reduction = np.linspace(0.02, 0.5, 60)
    force, radius, _ = cases.uniform_billet(reduction, law)
    height = 2.0 * cases.HALF_HEIGHT * (1.0 - reduction)
    right.plot(reduction, force, **REFERENCE, label="smooth: closed form")
    right.plot(reduction, force * (1.0 + 0.2 * radius / height), **REFERENCE, ls="--", label="rough: slab method")
    right.plot(reduction, force * (1.0 + 2.0 * radius / (3.0 * np.sqrt(3.0) * height)), **REFERENCE, ls=":", label="sticking: upper bound")
    right.plot(0.5 * smooth.history["time"], smooth.history["reaction_middle_y"], **{**SIMULATION, "label": "smooth"})
    rough_style = {**SIMULATION, "marker": "", "ls": "-", "label": "rough"}
    right.plot(0.5 * rough.history["time"], rough.history["reaction_middle_y"], **rough_style)
    right.set_xlabel("reduction of the height")
    right.set_ylabel("force, kN")
    right.set_ylim(0.0)
    right.legend(fontsize=8)
    return figure


def rolling_wheel(bench):
    # After 5/8 of the turn, so that the wheel is seen away from where it started.
    part = bench.run("rolling_wheel", {"steps.1.to": 1.625, "steps.1.increments": 80})
    whole = bench.run("rolling_wheel", {"steps.1.increments": 256})
    figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.6), layout="constrained")
    draw_deformed(left, part, part.nodal["von_mises"].ravel(), "von Mises stress")
    left.axhline(0.0, color="k", lw=1)
    left.set_xlim(-1.0, 5.5)
    left.set_title("after 5/8 of a turn")
    rolling = whole.history["time"] >= 1.0
    turn = whole.history["time"][rolling] - 1.0
    work, stored, dissipated = (whole.history[f"energy_{name}"][rolling] for name in ("external_work", "stored", "dissipated"))
    right.plot(turn, work - work[0] - (stored - stored[0]), **REFERENCE, label="work put in, less what is stored")
    right.plot(turn, dissipated - dissipated[0], color=SIMULATION["color"], label="work of friction")
    right.set_xlabel("turns")
    right.set_ylabel("work")
    other = right.twinx()
    other.plot(turn, (whole.history["contact_road_force_x"] / whole.history["contact_road_force_y"])[rolling], color="0.5", lw=1)
    other.set_ylabel("force along / force up (grey)", color="0.4")
    other.set_ylim(0.0, 0.3)
    right.legend(loc="upper left", fontsize=8)
    return figure


def deep_drawing(bench):
    results = bench.run("deep_drawing")
    figure, axes = plt.subplots(2, 2, figsize=(9, 6.6), layout="constrained")
    for panel, way in zip(axes[0], (15.0, 30.0)):
        state = results.at(way)
        draw_deformed(panel, state, state.nodal["accumulated_plastic_strain"].ravel(), "plastic strain", ((1, 1), (-1, 1)))
        angle = np.linspace(0.0, 0.5 * np.pi, 30)
        for mirror in (1, -1):
            die = np.concatenate([[[41, 0]], np.c_[26.4 - 5 * np.sin(angle), -5 + 5 * np.cos(angle)], [[21.4, -30]]])
            punch = np.concatenate([[[0, 1 - way]], np.c_[15 + 5 * np.sin(angle), 6 - way - 5 * np.cos(angle)], [[20, 8]]])
            for tool in (die, punch):
                panel.plot(mirror * tool[:, 0], tool[:, 1], "k", lw=0.8)
        panel.set_title(f"way of the punch {way:g} mm")
    left, right = axes[1]
    time = results.history["time"]
    left.plot(time, -results.history["contact_punch_force_y"], color=SIMULATION["color"], label="punch")
    for way in (10.0, 15.0):
        bounds = cases.drawing_bounds(results, cases.rim_radius(results.at(way)))
        left.plot([way, way], bounds, "_-", ms=12, **REFERENCE, label="bounds of slab theory" if way == 10.0 else None)
    left.set_xlabel("way of the punch, mm")
    left.set_ylabel("force, kN")
    left.set_ylim(0.0)
    left.legend(fontsize=8)
    for way, shade in zip((10.0, 20.0, 30.0), ("0.7", "0.4", SIMULATION["color"])):
        right.plot(*cases.thickness(results.at(way)), color=shade, label=f"{way:g} mm")
        rim = cases.rim_radius(results.at(way))
        right.plot(cases.BLANK, np.sqrt(cases.BLANK / rim), "s", color=REFERENCE["color"], label="rim: √(R0 / R)" if way == 10.0 else None)
    right.set_xlabel("radius on the blank, mm")
    right.set_ylabel("thickness, mm")
    right.legend(fontsize=8)
    return figure


def draw_sheet(panel, results):
    """The lower face of the quarter, by plastic strain."""
    now = results.places + results.nodal["displacement"]
    sheet = np.flatnonzero(results.in_body("sheet") & (np.abs(results.places[:, 2]) < 1e-9))
    plastic = results.nodal["accumulated_plastic_strain"].ravel()[sheet]
    x, y, z = now[sheet].T
    corners = tri.Triangulation(*results.places[sheet, :2].T).triangles  # of the flat blank
    shell = panel.plot_trisurf(x, y, z, triangles=corners, cmap="viridis", linewidth=0.1)
    shell.set_array(plastic[corners].mean(axis=1))
    panel.figure.colorbar(shell, ax=panel, shrink=0.6, label="plastic strain")
    panel.set_aspect("equal")
    panel.view_init(35, 225)
    panel.set_title(f"way of the punch {results.time:g} mm", fontsize=10)


def draw_square_cup(states):
    """The cup at the end of a run; force on the punch, thickness along the planes of symmetry and the diagonal (list of
    states)."""
    figure = plt.figure(figsize=(9, 7), layout="constrained")
    draw_sheet(figure.add_subplot(2, 2, 1, projection="3d"), states[-1])
    force, side, diagonal = (figure.add_subplot(2, 2, 2 + k) for k in range(3))
    history = states[-1].history
    force.plot(history["time"], -4.0 * history["contact_punch_force_z"], color=SIMULATION["color"])
    for state, shade in zip(states, ("0.6", "k", SIMULATION["color"])):
        for panel, slope in ((side, 0), (diagonal, 1)):
            panel.plot(*cases.thickness_along(state, slope), color=shade, label=f"{state.time:.3g} mm")
    for panel, where in ((side, "a plane of symmetry"), (diagonal, "the diagonal")):
        panel.set(xlabel=f"distance from the middle along {where}, mm", ylabel="thickness, mm")
        panel.legend(fontsize=8)
    force.set(xlabel="way of the punch, mm", ylabel="force on the whole punch, kN", xlim=(0, None), ylim=(0, None))
    return figure


def square_cup(bench):
    results = bench.run("square_cup", {"output.every": 1}, ranks=1)
    time = results.history["time"]
    return draw_square_cup([results.at(time[np.abs(time - way).argmin()]) for way in (10.0, 20.0, 40.0)])


def draw_tube(solid, section):
    """Half of the tube in 3D as it is at the end, and its force beside that of its section."""
    with h5py.File(solid.folder / "fields.h5", "r") as file:
        topology = file["run0/surfaces/folds/topology"][:].ravel()
    facets, at = [], 0
    while at < len(topology):
        facets.append(topology[at + 1 : at + 5])
        at += 1 + CELL_NODES[topology[at]]
    surface = solid.surface["folds"]
    now = surface["places"] + surface["displacement"]
    nodes = {tuple(np.round(place, 9)): i for i, place in enumerate(solid.places)}
    plastic = solid.nodal["accumulated_plastic_strain"].ravel()[[nodes[tuple(np.round(p, 9))] for p in surface["places"]]]
    figure = plt.figure(figsize=(9, 3.8), layout="constrained")
    left = figure.add_subplot(1, 2, 1, projection="3d")
    polygons = [now[facet] * mirror for mirror in ((1, 1, 1), (-1, 1, 1)) for facet in facets]
    shell = Poly3DCollection(polygons, array=2 * [plastic[facet].mean() for facet in facets], edgecolor="k", linewidth=0.2)
    left.add_collection3d(shell)
    left.set(xlim=(-32, 32), ylim=(0, 32), zlim=(0, 10), title=f"half of it, shortened by {solid.time:.3g} mm", zticks=(0, 5, 10))
    left.set_box_aspect((64, 32, 10), zoom=1.3)
    left.view_init(30, -75)
    figure.colorbar(shell, ax=left, shrink=0.6, label="plastic strain", location="bottom")
    right = figure.add_subplot(1, 2, 2)
    right.plot(section.history["time"], -1e-3 * section.history["reaction_top_y"], **REFERENCE, label="section")
    right.plot(solid.history["time"], -4e-3 * solid.history["reaction_top_z"], **SIMULATION)
    right.set(xlabel="shortening, mm", ylabel="force, kN", ylim=(0, 80))
    right.legend()
    return figure


def tube_buckling_3d(bench):
    return draw_tube(*rings.quarter_and_section_runs(bench, rings.tube_steps(12.7)))


def ring_crush(bench):
    crushed, pinched = bench.run("ring_crush"), bench.run("ring_crush", rings.pinch(16))
    figure, axes = plt.subplots(1, 3, figsize=(11, 3.6), layout="constrained", width_ratios=(1, 1, 1.3))
    for panel, results, title in zip(axes, (crushed, pinched), ("plates, approach 0.75", "discs, walls on each other")):
        draw_deformed(panel, results, results.nodal["von_mises"].ravel(), "von Mises stress")
        panel.set_title(title)
    for results, points, colour, name in (
        (crushed, rings.PLATES, SIMULATION["color"], "plates"),
        (pinched, [(force, rings.pinched_ring(force)) for force in np.linspace(0.5, 7.5, 15)], "0.4", "discs"),
    ):
        history = results.history
        axes[2].plot(history["time"], -history["contact_top_force_y"], color=colour, label=name)
        forces, approaches = zip(*points)
        axes[2].plot(approaches, forces, "s", ms=4, color=REFERENCE["color"], label="elastica" if name == "plates" else None)
    axes[2].set_xlabel("approach / R")
    axes[2].set_ylabel("force / (E I / R²)")
    axes[2].set_ylim(0.0, 25.0)
    axes[2].legend()
    return figure


SCENES = {function.__name__: function for function in (upsetting, rolling_wheel, deep_drawing, square_cup, tube_buckling_3d, ring_crush)}


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scenes", nargs="*", choices=[[], *SCENES])
    parser.add_argument("--program", required=True)
    options = parser.parse_args()
    for scene in options.scenes or SCENES:
        with tempfile.TemporaryDirectory() as folder:
            bench = Bench(options.program, ["mpirun", "--oversubscribe", "--bind-to", "none"], 1, folder)
            figure = SCENES[scene](bench)
            figure.savefig(TOP / "inputs" / scene / f"{scene}.png", dpi=100)


if __name__ == "__main__":
    main()
