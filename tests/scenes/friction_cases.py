"""Friction against closed forms."""
import numpy as np

import references

MU, RADIUS = 0.3, 50.0
YOUNG, POISSON = 70e3, 0.4999


def shear_error(bench, label, h, push):
    """Presses, shears; compares with Cattaneo and Mindlin for the measured forces. Returns the L2 error of the shear."""
    results = bench.run(
        "cattaneo_mindlin_2d",
        {
            "mesh.parameters.h": h,
            "contact.0.master.cylinder.displacement.x": f"{push}*max(t-1,0)",
        },
    )
    points = results.points["interface"]
    x, weight = points["places"][:, 0], points["weight"].ravel()
    pressure, shear, status = points["pressure"].ravel(), points["shear"][:, 0], points["status"].ravel()
    normal_force, shear_force = np.sum(pressure * weight), np.sum(shear * weight)
    a, p0 = references.line_contact(normal_force, RADIUS, YOUNG / (1.0 - POISSON**2))
    ratio = abs(shear_force) / (MU * normal_force)
    c, exact = references.cattaneo_mindlin(x, a, MU * p0, ratio)
    for side, edge in (("left", -x[status == 1].min()), ("right", x[status == 1].max())):
        bench.below(f"{label}, Q/(mu P) = {ratio:.3f}: stick edge on the {side}, in cells", abs(edge - c) / h, 1.0)
    error = np.sqrt(np.sum(weight * (np.abs(shear) - exact) ** 2) / np.sum(weight * exact**2))
    bench.below(f"{label}, Q/(mu P) = {ratio:.3f}: L2 of the shear traction", error, 0.05)
    # On sliding points the traction is on the Coulomb bound by the law itself.
    slipping = status == 2
    bound = np.abs(np.linalg.norm(points["shear"][slipping], axis=1) - MU * pressure[slipping]).max() / (MU * p0)
    bench.below(f"{label}: distance of sliding points from the bound", bound, 1e-10)
    return error


def cattaneo_mindlin(bench):
    coarse = shear_error(bench, "a/20", 0.05, 0.0085)
    fine = shear_error(bench, "a/40", 0.025, 0.0085)
    bench.below("error at a/40 over error at a/20", fine / coarse, 0.65)
    shear_error(bench, "a/20", 0.05, 0.016)


CASES = {"cattaneo_mindlin_2d": {"reference": cattaneo_mindlin}}
