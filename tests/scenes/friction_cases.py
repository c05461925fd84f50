"""Friction against closed forms."""
import numpy as np

import common_checks
import references

# --- partial slip of cylinders ----------------------------------------------------------------------------------------

MU, RADIUS, YOUNG, POISSON, LOAD = 0.3, 500.0, 210e3, 0.3, 100.0
RATIOS = (0.25, 0.5, 0.75)  # Q / (mu P) at t = 1 + ratio


def slip_error(results, ratio):
    """L2 of the shear traction's error, relative to the L2 norm of the bound mu p; and the same relative to the error of
    the best function that is linear between nodes. The exact traction has vertical tangents at a and c."""
    points, a, p0 = results.points["interface"], *partial_slip_contact()

    def exact(x):
        return references.cattaneo_mindlin(x, a, MU * p0, ratio)[1]

    error = np.abs(points["shear"][:, 0]) - exact(points["places"][:, 0])
    size = np.sqrt(np.sum(points["weight"] * error**2))
    _, least = references.best_linear(np.sort(results.surface["interface"]["places"][:, 0]), exact)
    return size / (MU * p0 * np.sqrt(4.0 * a / 3.0)), size / least


def partial_slip_contact():
    return references.line_contact(LOAD, RADIUS, references.contact_modulus((YOUNG, POISSON), (YOUNG, POISSON)))


def partial_slip(bench, results, ratio):
    """One state against Cattaneo and Mindlin."""
    label, h = f"Q/(mu P) = {ratio}", results.deck["mesh"]["parameters"]["h"]
    results = results.at(1.0 + ratio)
    points, a, p0 = results.points["interface"], *partial_slip_contact()
    x, weight, status, shear = points["places"][:, 0], points["weight"], points["status"], points["shear"]
    bench.close(f"{label}: normal force", np.sum(points["pressure"] * weight), LOAD, 1e-6)
    bench.close(f"{label}: shear force", abs(np.sum(shear[:, 0] * weight)), ratio * MU * LOAD, 1e-6)
    c = a * np.sqrt(1.0 - ratio)
    for side, edge in (("left", -x[status == 1].min()), ("right", x[status == 1].max())):
        bench.below(f"{label}: stick edge on the {side}, in cells", abs(edge - c) / h, 1.0)
        bench.close(f"{label}: stick half-width on the {side}", edge, c, 0.02)
    error, over_least = slip_error(results, ratio)
    bench.below(f"{label}: L2 of the shear traction's error / L2 of mu p", error, 0.02)
    bench.below(f"{label}: this error / that of the best piecewise linear function", over_least, 1.0)
    slipping = status == 2
    off = np.abs(np.linalg.norm(shear[slipping], axis=1) - MU * points["pressure"][slipping]).max() / (MU * p0)
    bench.below(f"{label}: distance of sliding points from the bound", off, 1e-10)


def cattaneo_mindlin(bench):
    """Cells of a/20."""
    results = bench.run("cattaneo_mindlin_2d")
    for ratio in RATIOS:
        partial_slip(bench, results, ratio)


def cattaneo_mindlin_convergence(bench):
    """The error falls with the cells' size; the increments of a force that only grows do not matter (here one for each
    ratio). Where a and c lie in their cells changes single errors, so that those of the three ratios are taken
    together."""
    errors = []
    once = {f"steps.{i}.increments": 1 for i in (1, 2, 3)}
    for cells in (10, 20, 40):
        h = 0.742790 / cells
        results = bench.run("cattaneo_mindlin_2d", {**once, "mesh.parameters.h": h})
        errors.append(np.linalg.norm([slip_error(results.at(1.0 + ratio), ratio)[0] for ratio in RATIOS]))
        print(f"     a/{cells}: error of the shear traction {errors[-1]:.3e}")
    bench.below("error at a/40 over error at a/10", errors[-1] / errors[0], 0.5)


def cattaneo_mindlin_held(bench):
    """Under constant forces nothing moves, however many increments are taken, with any formulation."""
    changes = {
        "mesh.parameters.h": 0.742790 / 10,
        "boundary.1.resultant.x": "0.5*mu*P*min(max(t-1,0),1)",
        "steps": [
            {"name": "press", "to": 1, "increments": 4},
            {"name": "shear", "to": 2, "increments": 4},
            {"name": "hold", "to": 3, "increments": 20},
        ],
    }
    for name, enforce in {"semismooth": {"semismooth": {}}, **common_checks.OTHERS}.items():
        results = bench.run("cattaneo_mindlin_2d", {**changes, "contact.*.enforce": enforce}, ranks=1)
        moved, held = results.history["displacement_top_x"], results.history["time"] >= 2.0 - 1e-9
        bench.below(f"{name}: motion while held / motion before", np.ptp(moved[held]) / np.abs(moved).max(), 1e-8)
        change = np.abs(results.points["interface"]["shear"] - results.at(2.0).points["interface"]["shear"]).max()
        largest = np.abs(results.points["interface"]["shear"]).max()
        bench.below(f"{name}: change of the shear traction / largest", change / largest, 1e-8)


CASES = {
    "cattaneo_mindlin_2d": {"reference": cattaneo_mindlin, "convergence": cattaneo_mindlin_convergence, "held": cattaneo_mindlin_held},
}
