#!/usr/bin/python3
"""Draws the pictures of the block scenes into inputs/: block_pictures.py --program PATH [SCENE ...]. Runs what it draws."""
import argparse
import tempfile

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

import block_cases
import friction_laws
import references
from harness import TOP, Bench

SIMULATION = {"marker": "o", "ms": 3, "ls": "", "color": "#d1603d", "label": "Amontons"}
REFERENCE = {"color": "#2f6690", "lw": 1.3}


def block_on_incline(bench):
    history = bench.run("block_on_incline").history
    tilted = history["time"] > 1.0
    angle = 40.0 * (history["time"][tilted] - 1.0)
    weight, tether = 392.4, 2e4
    theta = np.radians(np.linspace(0.0, 40.0, 200))
    figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.4), layout="constrained")
    left.plot(np.degrees(theta), np.sin(theta), **REFERENCE, label="W sin: all of the weight")
    left.plot(np.degrees(theta), 0.5 * np.cos(theta), **REFERENCE, ls="--", label="mu W cos: limit")
    left.plot(angle, -history["contact_incline_force_x"][tilted] / weight, **SIMULATION)
    left.set_ylabel("friction / weight")
    way = np.maximum(0.0, np.sin(theta) - 0.5 * np.cos(theta)) * weight / tether
    right.plot(np.degrees(theta), 1e3 * way, **REFERENCE, label="rigid block on the tether")
    right.plot(angle, 1e3 * history["reaction_tether_end_x"][tilted] / -tether, **SIMULATION)
    right.set_ylabel("way down, mm")
    for axes in (left, right):
        axes.axvline(np.degrees(np.arctan(0.5)), color="grey", lw=0.7)
        axes.set_xlabel("angle, degrees (line: atan mu)")
        axes.legend(fontsize=8)
    return figure


def capstan(bench):
    results = bench.run("capstan")
    points, history = results.points["drum"], results.history
    angle = np.degrees(np.arctan2(points["places"][:, 1], points["places"][:, 0]))
    order = np.argsort(angle)
    theta = np.linspace(0.0, 90.0, 100)
    pressure = block_cases.belt_tension(results.deck, np.radians(theta), 1) / results.deck["mesh"]["parameters"]["R"]
    figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.4), layout="constrained")
    left.plot(angle[order], points["pressure"][order], **SIMULATION)
    left.plot(theta, pressure, **REFERENCE, label="tension / R")
    left.set_xlabel("angle from the loaded end, degrees")
    left.set_ylabel("pressure on the drum, MPa")
    left.set_ylim(0.0, 0.3)
    right.plot(history["time"], -history["reaction_held_x"], **SIMULATION)
    for sense, label in ((-1, "exp(-mu θ)"), (1, "exp(mu θ)")):
        tension = block_cases.belt_tension(results.deck, np.pi / 2, sense)
        right.axhline(tension, **REFERENCE, ls="--" if sense < 0 else "-", label=f"load x {label}")
    right.set_xlabel("time: load until 1, then pull")
    right.set_ylabel("tension at the held end, N")
    for axes in (left, right):
        axes.legend(fontsize=8)
    return figure


def slip_weakening_fault(bench):
    figure, axes = plt.subplots(figsize=(6, 3.6), layout="constrained")
    runs = (
        (0.02, block_cases.weakening_run(bench, 0.02, {"semismooth": {}}, 50), "D_c = 0.02 mm: k = 1.5 W"),
        (0.01, block_cases.weakening_run(bench, 0.01, {"semismooth": {"alpha": 5.0 / 48.0}}, 5), "D_c = 0.01 mm: k = 0.75 W"),
    )
    for (length, (_, shear, slip, _), label), colour in zip(runs, ("#d1603d", "#3a8f6b")):
        law = np.array([0.0, length, 0.045])
        axes.plot(law, 10.0 * np.array([0.7, 0.5, 0.5]), color=colour, lw=1.0, alpha=0.6)
        axes.plot(slip[1:], shear[1:], "o", ms=3, color=colour, label=label)
    axes.set_xlabel("slip, mm (lines: the law)")
    axes.set_ylabel("shear traction, MPa")
    axes.legend(fontsize=8)
    return figure


def rate_and_state_slider(bench):
    figure, (left, right) = plt.subplots(1, 2, figsize=(10, 3.6), layout="constrained")
    parameters = {"mu": 0.6, "a": 0.016, "b": 0.012, "L": 2e-3, "v0": 1e-3}
    for evolution, colour in (("ageing", "#d1603d"), ("slip", "#3a8f6b")):
        history = bench.run(
            "rate_and_state_slider", {"contact.0.friction.rate_and_state.evolution": evolution}
        ).history
        time = np.linspace(1e-4, 2.0, 1500)
        exact = references.slider_after_step(time, 1e-3, 1e-2, parameters, 350.0, evolution)
        left.plot(10.0 * time / 2.0, exact, color=colour, lw=0.9)
        found = block_cases.friction_coefficient(history, "surface")
        left.plot(10.0 * (history["time"] - 21.0) / 2.0, found, "o", ms=2.5, color=colour, label=f"{evolution} law")
    left.set_xlim(-1.0, 8.0)
    left.set_ylim(0.59, 0.645)
    left.set_xlabel("time after a tenfold rate, in L/V2 (lines: ODE)")
    left.set_ylabel("friction coefficient")
    left.legend(fontsize=8)
    for ratio, colour in ((0.5, "#d1603d"), (2.0, "#3a8f6b")):
        history = block_cases.soft_slider(bench, ratio, block_cases.SLIDE, 1.5e-3)
        found = block_cases.friction_coefficient(history, "surface")
        right.plot(history["time"], found, ".-", ms=2.5, lw=0.7, color=colour, label=f"k = {ratio:g} k_c")
    right.set_xlabel("time, s")
    right.legend(fontsize=8)
    return figure


def prakash_clifton_step(bench):
    history = bench.run("prakash_clifton_step").history
    shear = np.abs(history["contact_surface_force_x"]) / 20.0
    after = history["time"] > 3.0
    before = np.flatnonzero(~after)[-1]
    slip = history["time"][after] - 3.0 - (shear[after] - shear[before]) / 3500.0
    figure, axes = plt.subplots(figsize=(6, 3.4), layout="constrained")
    line = np.linspace(0.0, 0.8, 300)
    axes.plot(line, 7.2 - 1.2 * np.exp(-line / 0.1), **REFERENCE, label="mu p2 - mu (p2 - p1) exp(-s/L)")
    axes.plot([-0.1, 0.0, 0.0, 0.8], [6.0, 6.0, 7.2, 7.2], color="grey", lw=0.8, ls="--", label="Coulomb")
    axes.plot(slip[::2], shear[after][::2], **SIMULATION)
    axes.set_xlabel("slip after the step of the pressure, mm")
    axes.set_ylabel("shear traction, MPa")
    axes.legend(fontsize=8)
    return figure


def friction_laws_gallery(bench):
    figure, grid = plt.subplots(4, 5, figsize=(13, 9.5), layout="constrained")
    for i, (name, parameters) in enumerate(block_cases.gallery_laws().items()):
        history = bench.run("friction_laws_gallery", {"contact.0.friction": {name: parameters}}).history
        duration, pressure, shear, slip, slides = block_cases.trace_law(history, 10.0 / 105e3)
        state, limit = None, np.full(len(shear), np.nan)
        for k in range(1, len(shear)):
            if slides[k]:
                limit[k], state = friction_laws.LAWS[name](parameters, pressure[k], slip[k], duration[k], state)
        row, column = 2 * (i // 5), i % 5
        time = history["time"]
        ramp, sweep = slides & (time <= 1.0), slides & (time > 1.0)
        above, below = grid[row, column], grid[row + 1, column]
        above.plot(pressure[ramp], limit[ramp], **REFERENCE)
        above.plot(pressure[ramp], shear[ramp], **SIMULATION)
        above.set_title(name, fontsize=10)
        above.set_xlabel("pressure, MPa")
        above.set_xlim(0.0, 410.0)
        rate = slip / duration
        below.semilogx(rate[sweep], limit[sweep], **REFERENCE)
        below.semilogx(rate[sweep], shear[sweep], **SIMULATION)
        below.set_xlabel("slip rate at 400 MPa, mm/s")
        for axes in (above, below):
            axes.set_ylim(0.0, 1.15 * np.nanmax(shear[slides]))
            axes.tick_params(labelsize=8)
    for row in range(4):
        grid[row, 0].set_ylabel("shear, MPa")
    return figure


PICTURES = {
    picture.__name__: picture
    for picture in (
        block_on_incline, capstan, slip_weakening_fault, rate_and_state_slider, prakash_clifton_step, friction_laws_gallery
    )
}


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scenes", nargs="*", help=f"of {', '.join(PICTURES)}; default: all")
    parser.add_argument("--program", required=True)
    parser.add_argument("--mpirun", default="mpirun --oversubscribe --bind-to none")
    options = parser.parse_args()
    unknown = set(options.scenes) - set(PICTURES)
    if unknown:
        parser.error(f"no picture of {', '.join(sorted(unknown))}")
    for scene in options.scenes or PICTURES:
        with tempfile.TemporaryDirectory() as folder:
            figure = PICTURES[scene](Bench(options.program, options.mpirun.split(), 1, folder))
        path = TOP / "inputs" / scene / f"{scene}.png"
        figure.savefig(path, dpi=90)
        plt.close(figure)
        print(path)


if __name__ == "__main__":
    main()
