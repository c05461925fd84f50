"""Obstacle problems whose free boundary is known: signorini_block and obstacle_ball."""
import math

import numpy as np

import common_checks
import references

ONCE = {"steps": [{"name": "load", "to": 1.0, "increments": 1}]}
SEMISMOOTH = {"contact.0.enforce": {"semismooth": {}}}


def order(errors, finer=2.0):
    """Order of convergence between the first and the last of meshes that are each `finer` times as fine."""
    return math.log(errors[0] / errors[-1], finer) / (len(errors) - 1)


def edge_of(time, largest):
    return largest * np.minimum(time, 2.0 - time)


class Block:
    """A run of signorini_block next to the closed form."""

    pair, largest = "foot", 0.7

    def __init__(self, results):
        self.results, self.K = results, results.deck["constants"]["K"]
        self.E, self.nu = results.deck["constants"]["E"], results.deck["constants"]["nu"]
        self.h = 1.0 / results.deck["mesh"]["parameters"]["n"]
        self.a = edge_of(results.time, self.largest)

    def pressure_error(self):
        """Relative L2 error of the nodal pressure, linear between the nodes; the integration is fine enough for the root."""
        surface = self.results.surface[self.pair]
        order = np.argsort(surface["places"][:, 0])
        x, pressure = surface["places"][order, 0], surface["pressure"].ravel()[order]
        at = np.linspace(0.0, 1.0, 20001)
        exact = self.K * np.sqrt(np.maximum(0.0, self.a - at))
        return math.sqrt(np.sum((np.interp(at, x, pressure) - exact) ** 2) / np.sum(exact**2))

    def displacement_error(self):
        """Relative root mean square of the error at the nodes."""
        x, y, _ = self.results.places.T
        exact = np.array(references.signorini_block(x, y, self.a, self.K, self.E, self.nu)).T
        error = self.results.nodal["displacement"][:, :2] - exact
        return math.sqrt(np.sum(error**2) / np.sum(exact**2))


def block_edge(bench):
    """The edge of contact and the force at every increment, there and back."""
    block = Block(bench.run("signorini_block"))
    history = block.results.history
    a = edge_of(history["time"], block.largest)
    area, force = history["contact_foot_area"], history["contact_foot_force_y"]
    bench.below("edge of contact, distance from the closed form in cells", np.abs(area - a).max() / block.h, 1.0)
    exact = 2.0 / 3.0 * block.K * a**1.5
    bench.below("force, largest error / largest force", np.abs(force - exact).max() / exact.max(), 0.001)
    common_checks.there_and_back(bench, "foot", area, force)


def block_convergence(bench):
    """Orders in L2 of displacement and pressure, and of the difference between vi and semismooth.

    The displacement is in H^(5/2): order 2 for cells of order 1, up to 5/2 for cells of order 2. The pressure ends like a
    root, whose distance from functions that are linear on cells that do not end at the edge is of order 1. Meshes with
    5, 15 and 45 cells have the edge (0.7) in the middle of a cell, so that its place in the cell does not blur the order."""
    cells = (5, 15, 45)
    for degree in (1, 2):
        errors, differences = {"vi": [], "semismooth": []}, []
        for n in cells:
            changes = {**ONCE, "mesh.parameters.n": n, "mesh.order": degree}
            runs = [bench.run("signorini_block", {**changes, **enforce}) for enforce in ({}, SEMISMOOTH)]
            for name, results in zip(errors, runs):
                errors[name].append((Block(results).displacement_error(), Block(results).pressure_error()))
            vi, other = (results.nodal_sorted("displacement") for results in runs)
            differences.append(np.linalg.norm(vi - other) / np.linalg.norm(other))
            print(f"     order {degree}, n = {n}: displacement, pressure of vi {errors['vi'][-1]}, of semismooth "
                  f"{errors['semismooth'][-1]}; difference in the displacement {differences[-1]:.2e}")
        for name, pairs in errors.items():
            displacement, pressure = np.array(pairs).T
            bench.below(f"order {degree}, {name}: 2 - order of the displacement", 2.0 - order(displacement, 3.0), 0.1)
            bench.below(f"order {degree}, {name}: 1 - order of the pressure", 1.0 - order(pressure, 3.0), 0.1)
        bench.below(f"order {degree}: 2 - order of the difference of vi and semismooth", 2.0 - order(differences, 3.0), 0.1)
        bench.below(f"order {degree}: difference of vi and semismooth on the finest mesh", differences[-1], 1e-4)


def block_triangles(bench):
    for degree in (1, 2):
        block = Block(bench.run("signorini_block", {**ONCE, "mesh.parameters.quads": 0, "mesh.order": degree}))
        bench.below(f"triangles, order {degree}: error of the displacement", block.displacement_error(), 1e-3)
        bench.below(f"triangles, order {degree}: error of the pressure", block.pressure_error(), 0.02)


class Ball:
    """A run of obstacle_ball next to the closed form: a quarter, heights scaled down by `height`, tension 1."""

    def __init__(self, results):
        self.results = results
        self.scale = results.deck["constants"]["height"]
        self.h = 2.0 / results.deck["mesh"]["parameters"]["n"]
        self.a = edge_of(results.time, references.BALL_RADIUS)

    def displacement_error(self):
        """Root mean square of the error at the nodes of the membrane / the ball's height."""
        membrane = self.results.in_body("membrane")
        r = np.hypot(*self.results.places[membrane, :2].T)
        error = self.results.nodal["displacement"][membrane, 2] / self.scale + 1.0 - references.membrane_over_ball(r, self.a)
        return math.sqrt(np.mean(error**2))

    def radius_by_force(self):
        """The contact radius at which the closed form has the run's force."""
        force = 4.0 * self.results.force("obstacle") / self.scale
        low, high = 0.0, 1.0 - 1e-9
        for _ in range(80):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if references.membrane_force(middle) < force else (low, middle)
        return high

    def status_errors(self):
        """How far the farthest node in contact lies outside the free boundary, and the nearest open one inside it, in cells."""
        surface = self.results.surface["obstacle"]
        r = np.hypot(surface["places"][:, 0], surface["places"][:, 1])
        touches = surface["pressure"].ravel() > 0.0
        return (r[touches].max() - self.a) / self.h, (self.a - r[~touches].min()) / self.h


def ball_edge(bench):
    """Contact radius of PETSc's ex9, and of every increment before and after."""
    results = bench.run("obstacle_ball")
    history = results.history
    a = edge_of(history["time"], references.BALL_RADIUS)
    area, force = history["contact_obstacle_area"], history["contact_obstacle_force_z"]
    radius = np.sqrt(4.0 * area / np.pi)
    bench.below("contact radius, distance from the closed form in cells", np.abs(radius - a).max() / Ball(results).h, 1.0)
    exact = references.membrane_force(a) / 4.0 * Ball(results).scale
    bench.below("force, largest error / largest force", np.abs(force - exact).max() / exact.max(), 0.005)
    common_checks.there_and_back(bench, "obstacle", area, force)


def ball_convergence(bench):
    """At the load of ex9: the contact radius within a cell, by the force to second order, the displacement likewise."""
    errors = []
    for n in (8, 16, 32):
        ball = Ball(bench.run("obstacle_ball", {**ONCE, "mesh.parameters.n": n}))
        outside, inside = ball.status_errors()
        bench.below(f"n = {n}: farthest node in contact beyond the free boundary, in cells", outside, 1.0)
        bench.below(f"n = {n}: nearest open node inside the free boundary, in cells", inside, 1.0)
        errors.append(ball.displacement_error())
        radius = ball.radius_by_force()
        print(f"     n = {n}: error of the displacement {errors[-1]:.3e}; radius by the force {radius:.6f} ({radius / ball.a - 1.0:+.1e})")
        bench.close(f"n = {n}: contact radius by the force", radius, ball.a, 0.1 / n)
    bench.below("2 - order of the displacement", 2.0 - order(errors), 0.3)


def ball_semismooth(bench):
    """The displacements of semismooth within the discretization error."""
    vi, other = (Ball(bench.run("obstacle_ball", {**ONCE, **changes})) for changes in ({}, SEMISMOOTH))
    difference = np.abs(vi.results.nodal_sorted("displacement") - other.results.nodal_sorted("displacement")).max() / vi.scale
    print(f"     errors {vi.displacement_error():.3e} (vi), {other.displacement_error():.3e} (semismooth)")
    bench.below("largest difference of vi and semismooth / height", difference, 0.005)
    bench.close("contact radius by the force, semismooth", other.radius_by_force(), vi.a, 0.005)


CASES = {
    "signorini_block": {
        "edge": block_edge,
        "convergence": block_convergence,
        "triangles": block_triangles,
        "ranks": lambda bench: common_checks.ranks_agree(bench, "signorini_block", ONCE),
    },
    "obstacle_ball": {
        "edge": ball_edge,
        "convergence": ball_convergence,
        "semismooth": ball_semismooth,
        "ranks": lambda bench: common_checks.ranks_agree(bench, "obstacle_ball", {**ONCE, "mesh.parameters.n": 8}),
    },
}
