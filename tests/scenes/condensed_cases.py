"""Semismooth contact with the dual basis: without friction the solution of vi to rounding, with friction closed forms."""
import numpy as np

import block_cases
import common_checks
import friction_cases

DUAL = common_checks.DUAL


def as_vi(scene, changes=None, tolerance=0.01):
    """Displacements and pressures are those of vi to rounding; peak pressure and force those of the nodal basis within the
    discretization error."""

    def check(bench):
        dual, vi, nodal = (
            bench.run(scene, {**(changes or {}), "contact.*.enforce": enforce})
            for enforce in (DUAL, {"vi": {}}, {"semismooth": {}})
        )
        bench.below("unknown multipliers", dual.summary["scene"]["unknowns"]["multipliers"], 0)
        exact = vi.nodal_sorted("displacement")
        error = np.abs(dual.nodal_sorted("displacement") - exact).max() / np.abs(exact).max()
        bench.below("displacement against vi", error, 1e-9)
        for pair in vi.surface:
            exact = vi.surface_sorted(pair, "pressure").ravel()
            error = np.nanmax(np.abs(dual.surface_sorted(pair, "pressure").ravel() - exact)) / np.nanmax(exact)
            bench.below(f"{pair}: pressure against vi", error, 1e-9)
            bench.close(f"{pair}: peak pressure", dual.peak_pressure(pair), nodal.peak_pressure(pair), tolerance)
            bench.close(f"{pair}: force", dual.force(pair), nodal.force(pair), tolerance)

    return check


def partial_slip(bench):
    """Cattaneo and Mindlin at nodes, cells of a/20 and, of order 2 on segments, of a/10."""
    variants = {
        "order 1": {},
        "order 2": {"mesh.order": 2, "mesh.parameters.h": 0.0742790, "contact.0.integration": {"segment": {"order": 4}}},
    }
    a, p0 = friction_cases.partial_slip_contact()
    mu, load = friction_cases.MU, friction_cases.LOAD
    for label, changes in variants.items():
        run = bench.run("cattaneo_mindlin_2d", {"contact.*.enforce": DUAL, **changes})
        h = run.deck["mesh"]["parameters"]["h"]
        for ratio in friction_cases.RATIOS:
            results = run.at(1.0 + ratio)
            points = results.points["interface"]
            x, weight, status, shear = points["places"][:, 0], points["weight"], points["status"], points["shear"]
            name, c = f"{label}, Q/(mu P) = {ratio}", a * np.sqrt(1.0 - ratio)
            bench.close(f"{name}: normal force", np.sum(points["pressure"] * weight), load, 1e-8)
            bench.close(f"{name}: shear force", abs(np.sum(shear[:, 0] * weight)), ratio * mu * load, 1e-8)
            sticks = x[status == 1]
            edge = max(abs(-sticks.min() - c), abs(sticks.max() - c))
            bench.below(f"{name}: edge of the stick zone, in cells", edge / h, 1.0)
            bench.below(f"{name}: L2 of the shear traction's error / L2 of mu p", friction_cases.slip_error(results, ratio)[0], 0.03)
            sliding = status == 2
            off = np.abs(np.linalg.norm(shear[sliding], axis=1) - mu * points["pressure"][sliding]).max() / (mu * p0)
            bench.below(f"{name}: distance of sliding nodes from the bound", off, 1e-12)
            moved = np.abs(points["slip"][~sliding]).max()
            bench.below(f"{name}: slip of nodes that stick", moved, 0.0)


def laws(bench):
    """Every law exactly, also at the rim, whose nodes have their motion along the normal prescribed."""
    for name, parameters in block_cases.gallery_laws().items():
        block_cases.check_law(bench, name, parameters, DUAL)


def stack(bench):
    friction_cases.slid_stack(bench, "dual basis", bench.run("stack_with_friction_3d", {"contact.*.enforce": DUAL}))


SCENES = {
    "hertz_2d": {
        "condensed": as_vi("hertz_2d"),
        "condensed_ranks": lambda bench: common_checks.ranks_agree(bench, "hertz_2d", {"contact.*.enforce": DUAL}),
    },
    "hertz_axisymmetric": {"condensed": as_vi("hertz_axisymmetric", {"steps.0.increments": 1})},
    "hertz_3d": {"condensed": as_vi("hertz_3d", {"steps.0.increments": 1, "mesh.parameters.n": 5}, 0.02)},
    "disc_stack": {"condensed": as_vi("disc_stack", {"steps.0.increments": 1})},
    "rigid_shapes": {"condensed": as_vi("rigid_shapes", {"steps.0.increments": 1}, 0.02)},
    "cattaneo_mindlin_2d": {"condensed": partial_slip},
    "friction_laws_gallery": {"condensed": laws},
    "stack_with_friction_3d": {
        "condensed": stack,
        "condensed_ranks": lambda bench: friction_cases.stack_ranks(bench, {"contact.*.enforce": DUAL}),
    },
}
