"""Contact in finite deformation and large sliding: published figures and energy."""
import csv
from pathlib import Path

import numpy as np

PUBLISHED = Path(__file__).resolve().parents[2] / "inputs" / "shallow_ironing" / "published.csv"


# --- an indenter dragged along a slab ---------------------------------------------------------------------------------


def published(component, case="frictional"):
    """Times and forces per thickness, digitised to +-0.015e8."""
    with open(PUBLISHED, encoding="utf-8", newline="") as file:
        rows = list(csv.reader(line for line in file if not line.startswith("#")))
    found = sorted((float(row[2]), 1e8 * float(row[3])) for row in rows if (row[0], row[1]) == (case, component))
    return np.array(found).T


def ironing_forces(results):
    """Time, force of the indenter's grip down and along; of the whole slice, half of which is modelled."""
    whole = 2.0 if results.deck["space"] == "solid" else 1.0
    return results.history["time"], -whole * results.history["reaction_top_y"], whole * results.history["reaction_top_x"]


PLANE = {
    "space": "plane_strain",
    "mesh.parameters.layers": 0,
    "boundary": [
        {"on": "base", "displacement": {"x": 0, "y": 0}},
        {"on": "top", "displacement": {"x": "10*max(t-1,0)", "y": "-min(t,1)"}},
    ],
}
PRESS = {"name": "press", "to": 1, "increments": {"auto": {"first": 0.1, "largest": 0.1}}}


def ironing_press(bench):
    """The slice is pressed in as published; the plane body, which cannot bulge, is stiffer, on any mesh."""
    results = bench.run("shallow_ironing", {"mesh.parameters.h": 0.3, "steps": [PRESS]})
    time, down, _ = ironing_forces(results)
    for at in (0.5, 0.7, 0.9):
        bench.close(f"force down at t = {at}", np.interp(at, time, down), np.interp(at, *published("Fy")), 0.05)
    coarse, fine = (
        np.interp(0.9, *ironing_forces(bench.run("shallow_ironing", {**PLANE, **changes, "steps": [PRESS]}))[:2])
        for changes in ({"mesh.parameters.h": 0.4}, {"mesh.parameters.h": 0.4, "mesh.order": 2})
    )
    bench.close("plane: force down with cells of order 1, against order 2", coarse, fine, 0.02)


def ironing_drag(bench):
    """Dragged over the whole length, against the published plateau; and the lecture's remark that the global coefficient
    of friction is more than the local one, 0.3."""
    time, down, along = ironing_forces(bench.run("shallow_ironing"))
    plateau = (time >= 1.3) & (time <= 1.7)
    for name, component, force, tolerance, wave in (("down", "Fy", down, 0.06, 0.01), ("along", "Fx", along, 0.11, 0.03)):
        times, forces = published(component)
        exact = np.mean(forces[(times >= 1.3) & (times <= 1.7)])
        bench.close(f"force {name} on the plateau", np.mean(force[plateau]), exact, tolerance)
        bench.below(f"oscillation of the force {name} / force", np.ptp(force[plateau]) / np.mean(force[plateau]), wave)
    bench.below("local over global coefficient of friction", 0.3 / np.mean(along[plateau] / down[plateau]), 1.0)


# --- a cantilever bent and let go by a disc ---------------------------------------------------------------------------


def cantilever(bench):
    """At the end nothing is stored: the work done is friction's, but for the path's error, which falls with increments."""
    errors = []
    for increments in (20, 40):
        results = bench.run("cantilever_contact", {"steps.*.increments": increments})
        history = results.history
        work, dissipated, stored = (history[f"energy_{name}"] for name in ("external_work", "dissipated", "stored"))
        bench.below("stored at the end / stored when bent", stored[-1] / stored.max(), 1e-8)
        bench.below("dissipation falls by / dissipated", max(0.0, -np.diff(dissipated).min()) / dissipated[-1], 1e-12)
        errors.append(abs(work[-1] - dissipated[-1]) / dissipated[-1])
    bench.below("work not accounted for / dissipated, 40 increments a way", errors[1], 0.05)
    bench.below("this error with twice the increments", errors[1] / errors[0], 0.7)


# --- a block slides around a faceted cylinder ---------------------------------------------------------------------------


def forces_around(results):
    """Force of the grip towards the axis and along the cylinder's face, from where it begins to slide on."""
    time = results.history["time"]
    sliding = time >= 1
    turned = np.pi / 10 * (time[sliding] - 1)
    x, y = (results.history[f"reaction_grip_{c}"][sliding] for c in "xy")
    return -(x * np.sin(turned) + y * np.cos(turned)), x * np.cos(turned) - y * np.sin(turned)


def faceted_cylinder(bench):
    """Around a round cylinder the force stays the same and none is along the face, without friction; so it is on 10 facets that are
    smoothed, and on 20 without smoothing less so."""
    waves, means = {}, {}
    for name, changes in (("smoothed", {}), ("facets", {"mesh.parameters.n": 20, "contact.0.smoothing": {"facets": {}}})):
        results = bench.run("faceted_cylinder", changes)
        down, along = forces_around(results)
        waves[name], means[name] = np.ptp(down) / np.mean(down), np.mean(down)
        stored = results.history["energy_stored"][results.history["time"] >= 1]
        if name == "smoothed":
            bench.below("smoothed: force along the face / force down", np.abs(along).max() / means[name], 1e-3)
            bench.below("smoothed: change of the stored energy / energy", np.ptp(stored) / np.mean(stored), 0.01)
    bench.below("smoothed: force down, highest less lowest / mean", waves["smoothed"], 0.005)
    bench.below("the same over that on facets, which are half as long", waves["smoothed"] / waves["facets"], 0.5)
    bench.below("facets lie inside the cylinder: their mean force over the smoothed", means["facets"] / means["smoothed"], 0.99)


CASES = {
    "faceted_cylinder": {"slide": faceted_cylinder},
    "shallow_ironing": {"press": ironing_press, "drag": ironing_drag},
    "cantilever_contact": {"energy": cantilever},
}
