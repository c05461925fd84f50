#!/usr/bin/python3
"""Draws the pictures of the forming scenes into inputs/: forming_pictures.py --program PATH [SCENE ...]. Runs what it draws."""
import argparse
import tempfile

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

import forming_cases as cases
from harness import TOP, Bench
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


SCENES = {function.__name__: function for function in (upsetting, rolling_wheel)}


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
