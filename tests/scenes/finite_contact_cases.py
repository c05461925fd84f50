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
    """Time, force of the indenter's grip down and along."""
    return results.history["time"], -results.history["reaction_top_y"], results.history["reaction_top_x"]


def ironing_press(bench, results, tolerance):
    time, down, _ = ironing_forces(results)
    for at in (0.5, 0.8, 0.95):
        bench.close(f"force down at t = {at}", np.interp(at, time, down), np.interp(at, *published("Fy")), tolerance)


def ironing_coarse(bench):
    """Cells of 0.3, the first tenth of the way."""
    drag = {"name": "drag", "to": 1.1, "increments": {"auto": {"first": 0.05, "largest": 0.05}}}
    results = bench.run("shallow_ironing", {"mesh.parameters.h": 0.3, "steps.1": drag})
    ironing_press(bench, results, 0.06)
    time, down, along = ironing_forces(results)
    late = time > 1.05
    bench.below("global over local coefficient of friction, 0.3, is above 1", 0.3 / np.min(along[late] / down[late]), 1.0)


def ironing_reference(bench):
    """The plateau of the whole way, against both published codes; oscillation from facet to facet."""
    results = bench.run("shallow_ironing")
    ironing_press(bench, results, 0.05)
    time, down, along = ironing_forces(results)
    plateau = (time >= 1.3) & (time <= 1.7)
    for name, component, force, tolerance in (("down", "Fy", down, 0.03), ("along", "Fx", along, 0.05)):
        times, forces = published(component)
        exact = np.mean(forces[(times >= 1.3) & (times <= 1.7)])
        bench.close(f"force {name} on the plateau", np.mean(force[plateau]), exact, tolerance)
        bench.below(f"oscillation of the force {name} / force", np.ptp(force[plateau]) / np.mean(force[plateau]), 0.06)
    bench.close("global coefficient of friction", np.mean(along[plateau] / down[plateau]), 0.304, 0.03)


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
    bench.below("work not accounted for / dissipated, 40 increments a way", errors[1], 0.02)
    bench.below("this error with twice the increments", errors[1] / errors[0], 0.7)


CASES = {
    "shallow_ironing": {"coarse": ironing_coarse, "reference": ironing_reference},
    "cantilever_contact": {"energy": cantilever},
}
