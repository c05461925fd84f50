"""Hertz contact of a round and a flat body: pressure, width and force against the half-space solution."""
import math

import numpy as np

import common_checks
import references

RADIUS = {"hertz_2d": 50.0, "hertz_axisymmetric": 50.0, "hertz_3d": 40.0}


def materials_of(results, *bodies):
    laws = [results.deck["materials"][results.deck["bodies"][body]]["elastic"] for body in bodies]
    return [(float(law["E"]), float(law["nu"])) for law in laws]


class Hertz:
    """What a run says next to what Hertz says for the whole contact force that the run found."""

    def __init__(self, scene, results):
        self.results, self.scene = results, scene
        self.line = scene == "hertz_2d"
        self.up = 2 if scene == "hertz_3d" else 1
        self.round_body = "sphere" if scene == "hertz_3d" else "indenter"
        # the part modelled: half of the cylinder, the whole sphere, a quarter of the sphere
        self.share = {"hertz_2d": 0.5, "hertz_axisymmetric": 1.0, "hertz_3d": 0.25}[scene]
        self.force = abs(results.force_vector("interface")[self.up]) / self.share
        self.materials = materials_of(results, self.round_body, "block")
        self.contact = references.line_contact if self.line else references.sphere_contact
        self.radius = results.deck["mesh"]["parameters"].get("R", RADIUS[scene])
        self.a, self.p0 = self.contact(self.force, self.radius, references.contact_modulus(*self.materials))
        points = results.points["interface"]
        self.r = np.hypot(points["places"][:, 0], points["places"][:, 1] if self.up == 2 else 0.0)
        self.pressure, self.weight = points["pressure"], points["weight"]

    def width(self):
        """Half-width or radius of the contact from the second moment of the pressure: <x^2> = a^2 / 4 for the half-ellipse
        over a line, <r^2> = 2 a^2 / 5 over a circle. Not tied to the mesh's size as the last node in contact is."""
        share = self.pressure * self.weight
        second = np.sum(share * self.r**2) / np.sum(share)
        return math.sqrt(second / (0.25 if self.line else 0.4))

    def pressure_error(self):
        """Relative L2 error of the nodal pressure (linear between nodes, in 2D), integrated over the slave surface with
        five Gauss points a facet."""
        surface = self.results.surface["interface"]
        x, pressure = surface["places"][:, 0], surface["pressure"].ravel()
        order = np.argsort(x)
        x, pressure = x[order], pressure[order]
        place, weight = np.polynomial.legendre.leggauss(5)
        half = 0.5 * np.diff(x)[:, None]
        at = 0.5 * (x[1:] + x[:-1])[:, None] + half * place
        exact = references.hertz_pressure(at, self.a, self.p0)
        error = np.interp(at, x, pressure) - exact
        return math.sqrt(np.sum(half * weight * error**2) / np.sum(half * weight * exact**2))

    def profile_error(self):
        """Error of the block's deflection over two half-widths, mean removed, relative to its root mean square (in 2D)."""
        (_, (E, nu)), places = self.materials, self.results.places
        top = self.results.in_body("block") & (np.abs(places[:, 1]) < 1e-9) & (places[:, 0] < 2.0 * self.a)
        x, u = places[top, 0], self.results.nodal["displacement"][top, 1]
        order = np.argsort(x)
        x, u = x[order], u[order]
        exact = references.line_contact_profile(x, self.a, self.p0, E, nu)

        def without_mean(values):
            return values - np.trapz(values, x) / (x[-1] - x[0])

        error, exact = without_mean(u - exact), without_mean(exact)
        return math.sqrt(np.trapz(error**2, x) / np.trapz(exact**2, x))

    def force_from_approach(self, depth):
        """The force that Hertz needs for the approach seen between two nodes on the axis, near `depth` in each body."""
        places = self.results.places
        across = [i for i in range(3) if i != self.up]
        depths, moved = [], []
        for body, side in ((self.round_body, 1.0), ("block", -1.0)):
            on_axis = self.results.in_body(body) & np.all(np.abs(places[:, across]) < 1e-9, axis=1)
            candidates = np.flatnonzero(on_axis)
            node = candidates[np.argmin(np.abs(side * places[candidates, self.up] - depth))]
            overlap = self.results.deck["mesh"]["parameters"]["overlap"]
            depths.append(side * places[node, self.up] + (overlap if side > 0 else 0.0))
            moved.append(self.results.nodal["displacement"][node, self.up])
        approach = moved[1] - moved[0] + overlap
        return references.sphere_force_of_approach(approach, self.radius, self.materials, depths)

    def load(self):
        """The whole force that the deck asks for at the end."""
        text = next(item["resultant"] for item in self.results.deck["boundary"] if "resultant" in item)
        return -float(next(iter(text.values())).replace("*t", "")) / self.share


def check(bench, scene, changes, width, peak, force=None):
    """One run against Hertz, with the tolerances of width, peak pressure and force. In 2D the force cannot be told from an
    approach: even between near points the bodies' finite size L enters in proportion to depth / L."""
    hertz = Hertz(scene, bench.run(scene, changes))
    bench.close("contact force against the load", hertz.force, hertz.load(), 1e-6)
    history = abs(hertz.results.history[f"contact_interface_force_{'xyz'[hertz.up]}"][-1]) / hertz.share
    bench.close("contact force in history.csv", history, hertz.force, 1e-10)
    bench.close("contact half-width", hertz.width(), hertz.a, width)
    bench.close("peak pressure", hertz.results.peak_pressure("interface"), hertz.p0, peak)
    if force:
        bench.close("force by the approach", hertz.force_from_approach(5.0 * hertz.a), hertz.force, force)


def reference_2d(bench):
    check(bench, "hertz_2d", {}, 0.01, 0.01)


def check_convergence(bench, label, changes, sizes):
    """First order or better of the pressure in L2 over three meshes. Higher is not to be had with nodes that do not
    follow the edge of contact, where the pressure falls to zero like a square root."""
    errors = []
    for h in sizes:
        results = bench.run("hertz_2d", {**changes, "mesh.parameters.h": h})
        errors.append(Hertz("hertz_2d", results).pressure_error())
        print(f"     {label}cell size {h}: L2 error of the pressure {errors[-1]:.3e}")
    order = math.log2(errors[0] / errors[-1]) / 2.0
    bench.below(f"{label}1 - order of convergence in L2", 1.0 - order, 0.0)
    return errors[-1]


def convergence_2d(bench):
    finest = check_convergence(bench, "", {}, (0.1, 0.05, 0.025))
    bench.below("L2 error on the finest mesh", finest, 0.01)


def segments_2d(bench):
    """Integration on segments, with either body as slave, and with second-order cells."""
    changes = {"contact.0.integration": {"segment": {}}, "steps.0.increments": 1}
    exchanged = {**changes, "contact.0.slave": "indenter_rim", "contact.0.master": "block_top"}
    for label, all_changes in {"block as slave, ": changes, "indenter as slave, ": exchanged}.items():
        bench.below(f"{label}L2 error on the finest mesh", check_convergence(bench, label, all_changes, (0.1, 0.05, 0.025)), 0.01)
        check(bench, "hertz_2d", all_changes, 0.005, 0.002)
    check_convergence(bench, "order 2, ", {**changes, "mesh.order": 2}, (0.2, 0.1, 0.05))


def second_order_2d(bench):
    """Second-order cells, twice as large."""
    check(bench, "hertz_2d", {"mesh.order": 2, "mesh.parameters.h": 0.1}, 0.01, 0.01)


def exchanged_2d(bench):
    """The stiffer body as slave; the same contact within the discretization error."""
    changes = {"contact.0.slave": "indenter_rim", "contact.0.master": "block_top"}
    check(bench, "hertz_2d", changes, 0.01, 0.01)


def normals_2d(bench):
    """Why exchanged slave and master differ: not which body is the slave, but where the normal comes from.

    On the round body it leans by up to a/R: pressure has a part q = p x / R along the surface, and the gap takes part in the
    bodies' motion along it. Hertz has neither. By [J] 2.25 q changes the slope of a surface by
    (1 - 2 nu)(1 + nu) q / E, of a size of a/R (here 2 %) x (1 - 2 nu)/(2 - 2 nu) = 0.6 % of that by p. With R ten times as
    large, and the same half-width, the difference must be a tenth."""
    exchanged = {"contact.0.slave": "indenter_rim", "contact.0.master": "block_top"}
    along = {"contact.0.projection": {"slave_normal": {}}}
    larger = {"mesh.parameters.R": 500.0, "mesh.parameters.overlap": 1e-4, "boundary.3.resultant.y": "-45*t"}

    def width(*changes):
        every = {"mesh.parameters.h": 0.1, "contact.0.integration": {"segment": {}}, "steps.0.increments": 1}
        hertz = Hertz("hertz_2d", bench.run("hertz_2d", {key: value for part in (every, *changes) for key, value in part.items()}))
        return hertz.width() / hertz.a

    leaning, upright = width(), width(along)  # normals of the round master; of the flat slave
    bench.below("leaning normals, either slave", abs(width(exchanged, along) - leaning), 2e-4)
    bench.below("upright normals, either slave", abs(width(exchanged) - upright), 2e-4)
    print(f"     width: leaning normals make it larger by {leaning - upright:.2e}")
    bench.below("largest difference, by the estimate", abs(leaning - upright), 0.006)
    bench.close("with R ten times as large", width(larger) - width(larger, along), (leaning - upright) / 10.0, 0.2)


def profile_2d(bench):
    """The block's profile nears Hertz's when cells grow more slowly away from the contact."""
    errors = []
    for growth, limit in ((0.25, 3e-3), (0.0625, 1e-3)):
        changes = {"mesh.parameters.growth": growth, "contact.0.integration": {"segment": {}}, "steps.0.increments": 1, "contact.0.projection": {"slave_normal": {}}}
        errors.append(Hertz("hertz_2d", bench.run("hertz_2d", changes)).profile_error())
        bench.below(f"growth {growth}: profile of the block", errors[-1], limit)
    bench.below("error with a quarter of the growth / with all of it", errors[1] / errors[0], 0.5)


def reference_axisymmetric(bench):
    check(bench, "hertz_axisymmetric", {}, 0.01, 0.02, 0.01)


def segments_3d(bench):
    """Integration on segments: the reference again, and ranks on a coarser mesh."""
    segments = {"contact.0.integration": {"segment": {}}}
    check(bench, "hertz_3d", {**segments, "steps.0.increments": 1}, 0.01, 0.02, 0.01)
    common_checks.ranks_agree(bench, "hertz_3d", {**segments, "mesh.parameters.n": 4})


def reference_3d(bench):
    check(bench, "hertz_3d", {}, 0.01, 0.02, 0.01)


def second_order_3d(bench):
    """Cells of order 2, whose outer ones turn over under the sphere unless the reader mends them."""
    check(bench, "hertz_3d", {"mesh.order": 2, "mesh.parameters.n": 4, "steps.0.increments": 1}, 0.02, 0.02, 0.01)


def figures_2d(bench):
    """The estimated errors of force and peak pressure under a prescribed approach, and of the approach under a force, against the values with cells of order 2
    (whose own errors are a hundredth): with their signs, for each formulation that has them, on 1 and 2 ranks."""
    def run(order, enforce, ranks=2):
        changes = {"boundary.3": {"on": "indenter_cut", "displacement": {"x": 0, "y": "-0.02*t"}}, "steps.0.increments": 1,
                   "mesh.parameters.h": 0.1, "mesh.order": order, "contact.0.enforce": enforce}
        summary = bench.run("hertz_2d", changes, ranks).summary
        contact = summary["contact"]["interface"]
        return contact["force"][1], contact["max_pressure"], summary["errors"]["figures"]["interface"]

    force, peak, _ = run(2, {"semismooth": {}})
    for enforce in ({"semismooth": {}}, {"uzawa": {}}, {"penalty": {}}):
        name = next(iter(enforce))
        coarse_force, coarse_peak, errors = run(1, enforce)
        ratio = errors["force"]["relative"] / (force / coarse_force - 1.0)
        bench.below(f"{name}: estimated / true error of the force, inverse", 1.0 / ratio if ratio > 0.0 else math.inf, 2.0)
        bench.below(f"{name}: estimated / true error of the force", ratio, 2.0)
        # Not the very peak, but the mean of the pressure around it.
        ratio = errors["peak_pressure"]["relative"] / (peak / coarse_peak - 1.0)
        bench.below(f"{name}: estimated / true error of the peak pressure, inverse", 1.0 / ratio if ratio > 0.0 else math.inf, 2.0)
        bench.below(f"{name}: estimated / true error of the peak pressure", ratio, 2.0)
        if name == "semismooth":
            alone = run(1, enforce, 1)[2]
            for figure in ("force", "peak_pressure"):
                bench.close(f"{figure} on 1 rank", alone[figure]["relative"], errors[figure]["relative"], 1e-6)

    def approach(order):
        changes = {"steps.0.increments": 1, "mesh.parameters.h": 0.1, "mesh.order": order,
                   "figures": {"approach": {"of": "indenter_cut", "component": "y"}}}
        return bench.run("hertz_2d", changes).summary["errors"]["figures"]["mean_displacement"]["approach"]

    coarse = approach(1)
    ratio = coarse["relative"] / (approach(2)["value"] / coarse["value"] - 1.0)
    bench.close("estimated / true error of the approach", ratio, 1.0, 0.2)


CASES = {
    "hertz_2d": {
        "figures": figures_2d,
        "reference": reference_2d,
        "convergence": convergence_2d,
        "second_order": second_order_2d,
        "exchanged": exchanged_2d,
        "normals": normals_2d,
        "profile": profile_2d,
        "segments": segments_2d,
        "formulations": lambda bench: common_checks.formulations_agree(bench, "hertz_2d"),
        "ranks": lambda bench: common_checks.ranks_agree(bench, "hertz_2d"),
    },
    "hertz_axisymmetric": {
        "reference": reference_axisymmetric,
        "formulations": lambda bench: common_checks.formulations_agree(bench, "hertz_axisymmetric"),
        "ranks": lambda bench: common_checks.ranks_agree(bench, "hertz_axisymmetric"),
    },
    "hertz_3d": {
        "reference": reference_3d,
        "second_order": second_order_3d,
        "segments": segments_3d,
        "formulations": lambda bench: common_checks.formulations_agree(bench, "hertz_3d", {"steps.0.increments": 1}),
        "ranks": lambda bench: common_checks.ranks_agree(bench, "hertz_3d", {"mesh.parameters.n": 6}),
    },
}
