"""Contact as a variational inequality: a free boundary that is known, and the scenes of the other formulations."""
import math

import numpy as np

import common_checks
import references


class Wave:
    """A run of wavy_block next to Westergaard's solution for the mean pressure that the run found."""

    def __init__(self, results):
        parameters = {"length": 2.0, "amplitude": 0.001, **results.deck["mesh"]["parameters"]}
        law = results.deck["materials"]["rubber"]["elastic"]
        self.results = results
        self.length, self.h = parameters["length"], parameters["length"] / 2.0 / parameters["n"]
        self.full = references.wave_closing_pressure(parameters["length"], parameters["amplitude"], law["E"], law["nu"])

    def half_width(self, mean):
        return references.wave_half_width(mean, self.full, self.length)

    def pressure_error(self):
        """Relative L2 error of the nodal pressure, linear between the nodes."""
        surface = self.results.surface["crest"]
        order = np.argsort(surface["places"][:, 0])
        x, pressure = surface["places"][order, 0], surface["pressure"].ravel()[order]
        place, weight = np.polynomial.legendre.leggauss(5)
        half = 0.5 * np.diff(x)[:, None]
        at = 0.5 * (x[1:] + x[:-1])[:, None] + half * place
        mean = self.results.force("crest") / (self.length / 2.0)
        exact = references.wave_pressure(at, mean, self.full, self.length)
        error = np.interp(at, x, pressure) - exact
        return math.sqrt(np.sum(half * weight * error**2) / np.sum(half * weight * exact**2))


PRESSED = {"steps": [{"name": "load", "to": 0.7, "increments": 1}]}


def free_boundary(bench):
    """The edge of contact within a cell through loading and unloading, which go the same way."""
    wave = Wave(bench.run("wavy_block"))
    history = wave.results.history
    area, force = history["contact_crest_area"], np.abs(history["contact_crest_force_y"])
    mean = force / (wave.length / 2.0)
    exact = np.array([wave.half_width(value) for value in mean[:-1]])
    bench.below("edge of contact, distance from the free boundary in cells", np.abs(area[:-1] - exact).max() / wave.h, 1.0)
    bench.below("mean pressure that closes the wave / largest", mean.max() / wave.full, 0.9)
    bench.below("largest shrinking while loading", -np.diff(area[:4]).min(), 0.0)
    bench.below("largest growing while unloading", np.diff(area[3:]).max(), 0.0)
    bench.below("force on the way back", np.abs(force[4:7] - force[2::-1]).max() / force.max(), 1e-9)
    bench.below("force at the end / largest", force[-1] / force.max(), 1e-9)


def convergence(bench):
    """First order of the pressure in L2, elements of order 1 and 2; iterations of the active set from scratch.

    The pressure falls to zero like a root, so no element does better; where in a cell it does so makes the error jump from
    mesh to mesh, so the bound is on error times number of cells.
    """
    for label, order, cells in (("quadrilaterals, order 1", 1, (16, 32, 64)), ("quadrilaterals, order 2", 2, (8, 16, 32))):
        for n in cells:
            results = bench.run("wavy_block", {**PRESSED, "mesh.parameters.n": n, "mesh.order": order})
            error = Wave(results).pressure_error()
            print(f"     {label}, n = {n}: L2 error of the pressure {error:.3e}")
            bench.below(f"{label}, n = {n}: error x cells", error * n, 1.3)
            bench.below(f"{label}, n = {n}: iterations", results.summary["newton_iterations"], 10)


def triangles(bench):
    for order in (1, 2):
        results = bench.run("wavy_block", {**PRESSED, "mesh.parameters.quads": 0, "mesh.order": order})
        bench.below(f"triangles, order {order}: L2 error of the pressure", Wave(results).pressure_error(), 0.04)


def against_semismooth(scene, changes=None, tolerance=0.01):
    """Peak pressure and force of each pair are those of semismooth within the discretization error."""

    def check(bench):
        reference = bench.run(scene, {**(changes or {}), "contact.*.enforce": {"semismooth": {}}})
        results = bench.run(scene, {**(changes or {}), "contact.*.enforce": {"vi": {}}})
        for pair in reference.surface:
            bench.close(f"{pair}: peak pressure", results.peak_pressure(pair), reference.peak_pressure(pair), tolerance)
            bench.close(f"{pair}: force", results.force(pair), reference.force(pair), tolerance)

    return check


def load_unload(scene, changes, pairs):
    """Areas and forces grow and shrink through loading and unloading, and in every increment the force is that of
    semismooth to 0.5 %, the peak pressure to 3 % on these coarse meshes."""
    changes = {**changes, "steps": [{"name": "load", "to": 1.0, "increments": 3}, {"name": "unload", "to": 5.0 / 3.0, "increments": 2}]}

    def check(bench):
        found, other = (bench.run(scene, {**changes, "contact.*.enforce": {name: {}}}).history for name in ("vi", "semismooth"))
        for pair in pairs:
            force, expected = (np.hypot.reduce([history[f"contact_{pair}_force_{c}"] for c in "xyz" if f"contact_{pair}_force_{c}" in history])
                               for history in (found, other))
            common_checks.there_and_back(bench, pair, found[f"contact_{pair}_area"], force)
            bench.below(f"{pair}: force against semismooth", np.abs(force / expected - 1.0).max(), 0.005)
            peaks = found[f"contact_{pair}_max_pressure"] / other[f"contact_{pair}_max_pressure"]
            bench.below(f"{pair}: peak pressure against semismooth", np.abs(peaks - 1.0).max(), 0.03)

    return check


CG = {"ksp_type": "cg", "ksp_rtol": 1e-8}
DIRECT, MULTIGRID, HYPRE = ({"petsc": petsc} for petsc in ({}, {**CG, "pc_type": "gamg"}, {**CG, "pc_type": "hypre"}))


def solves_alike(bench, scene, changes, most, multigrid=MULTIGRID):
    """Conjugate gradients with multigrid against a factorization; `most`: iterations of a linear solve."""
    direct, results = (bench.run(scene, {**changes, **solver}) for solver in (DIRECT, multigrid))
    name = f"{scene}, {results.summary['scene']['unknowns']['displacement']} unknowns"
    per_solve = results.summary["linear_iterations"] / results.summary["newton_iterations"]
    bench.below(f"{name}: iterations of a linear solve", per_solve, most)
    exact = direct.nodal_sorted("displacement")
    error = np.abs(results.nodal_sorted("displacement") - exact).max() / np.abs(exact).max()
    bench.below(f"{name}: displacement against a factorization", error, 1e-6)
    return results.summary["newton_iterations"]


def multigrid(bench):
    """Iterations of the active set and of conjugate gradients that hardly grow with the mesh."""
    active_set = [solves_alike(bench, "ball_on_cube", {"mesh.parameters.n": n}, 16) for n in (10, 16)]
    bench.below("iterations of the active set, largest", max(active_set), 6)


def hypre(bench):
    """The same with hypre's BoomerAMG as it comes."""
    solves_alike(bench, "ball_on_cube", {"mesh.parameters.n": 10}, 30, HYPRE)


def multigrid_on_graded_cells(bench):
    """Cells forty times as long as high and a body that contact alone holds: multigrid must not need many times more. 30 to
    43 iterations were found, for incomplete factors depend on the order of the unknowns; Jacobi needs 172."""
    for enforce in ({"vi": {}}, {"penalty": {}}):
        solves_alike(bench, "hertz_3d", {"steps.0.increments": 1, "mesh.parameters.n": 6, "contact.0.enforce": enforce}, 60)


def estimates_by_multigrid(bench):
    """Errors of figures by the influence that a Krylov method finds, against that of a factorization. Newton's method asks
    its linear solves for two digits, with which these errors are 5 % off here and by more than half on finer meshes."""
    changes = {"steps.0.increments": 1, "mesh.parameters.n": 4, "contact.0.enforce": {"uzawa": {}},
               "boundary.5": {"on": "sphere_top", "displacement": {"z": "-0.023*t"}}}
    inexact = {"petsc": {**MULTIGRID["petsc"], "snes_ksp_ew": True, "snes_ksp_ew_rtol0": 1e-2, "snes_ksp_ew_rtolmax": 1e-2}}
    direct, krylov = (bench.run("hertz_3d", {**changes, **solver}).summary["errors"]["figures"]["interface"]
                      for solver in (DIRECT, inexact))
    for figure in ("force", "peak_pressure"):
        for kind in ("relative", "without_cancelling"):
            bench.below(f"{figure}, {kind}: multigrid against a factorization",
                        abs(krylov[figure][kind] / direct[figure][kind] - 1.0), 0.01)


def ranks(bench):
    common_checks.ranks_agree(bench, "wavy_block", PRESSED)


CASES = {
    "wavy_block": {"free_boundary": free_boundary, "convergence": convergence, "triangles": triangles, "ranks": ranks},
    "ball_on_cube": {"multigrid": multigrid, "hypre": hypre},
}
UNLOAD = {
    "hertz_2d": load_unload("hertz_2d", {"boundary.3.resultant.y": "-450*min(t,2-t)", "mesh.parameters.h": 0.1}, ["interface"]),
    "hertz_3d": load_unload("hertz_3d", {"boundary.5.resultant.z": "-480*min(t,2-t)", "mesh.parameters.n": 4}, ["interface"]),
    "disc_stack": load_unload("disc_stack", {"contact.4.master.plane.displacement.y": "-0.8*min(t,2-t)"}, ["lid", "rows_2_3", "columns_1_2"]),
}
VI = {
    "hertz_2d": against_semismooth("hertz_2d"),
    "hertz_axisymmetric": against_semismooth("hertz_axisymmetric"),
    "hertz_3d": against_semismooth("hertz_3d", {"steps.0.increments": 1, "mesh.parameters.n": 6}, 0.02),
    "disc_stack": against_semismooth("disc_stack", {"steps.0.increments": 1}),
    "rigid_shapes": against_semismooth("rigid_shapes", {"steps.0.increments": 1}, 0.02),
}
