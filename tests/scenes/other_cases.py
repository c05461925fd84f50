"""Flat punch, stack of discs, rigid shapes."""
import numpy as np

import common_checks
import references


def check_flat_punch(bench, label, results):
    """Pressure within 3 % away from the edge, rising towards the edge without oscillation."""
    surface = results.surface["interface"]
    order = np.argsort(surface["places"][:, 0])
    x, pressure = surface["places"][order, 0], surface["pressure"].ravel()[order]
    a = results.deck["mesh"]["parameters"]["a"]
    exact = references.flat_punch_pressure(x[x < 0.8 * a], 2.0 * results.force("interface"), a)
    bench.below(f"{label}: largest error for x < 0.8 a", np.abs(pressure[x < 0.8 * a] / exact - 1.0).max(), 0.03)
    # The exact pressure rises everywhere: any fall between neighbouring nodes would be an oscillation. The mean over a cell
    # next to the edge is finite, so the last node's value must be of its size: integral of p over (a - h, a) / h.
    bench.below(f"{label}: largest fall between neighbours / mean pressure", -np.diff(pressure).min() / pressure.mean(), 0.0)
    h = x[-1] - x[-2]
    mean = 2.0 * results.force("interface") / np.pi * (np.pi / 2.0 - np.arcsin(1.0 - h / a)) / h
    bench.below(f"{label}: pressure at the edge / mean pressure of the last cell", pressure[-1] / mean, 2.0)


def check_edge_cells(bench, label, results):
    """Mean pressures of the four cells at the edge within 5 % of the exact ones, which are finite."""
    points = results.points["interface"]
    a = results.deck["mesh"]["parameters"]["a"]
    h = a / results.deck["mesh"]["parameters"]["n_punch"]
    x, force = points["places"][:, 0], points["pressure"] * points["weight"]
    for k in range(4):
        low, high = a - (k + 1) * h, a - k * h
        exact = 2.0 * results.force("interface") / np.pi * (np.arcsin(high / a) - np.arcsin(low / a))
        bench.close(f"{label}: force of cell {k + 1} from the edge", force[(x > low) & (x < high)].sum(), exact, 0.05)


def flat_punch(bench):
    """Every formulation by itself, then against each other. Uzawa has the pressures of semismooth at every node. Penalty
    has them but in the cell at the edge: there the singular pressure is constrained at every point instead of at two
    nodes, which shifts pressure from one node of the cell to the other at whatever alpha. So the cell's force is
    compared with the exact one, and the nodes before it with semismooth."""
    reference = bench.run("flat_punch")
    check_flat_punch(bench, "semismooth", reference)
    check_edge_cells(bench, "semismooth", reference)
    exact = reference.surface_sorted("interface", "pressure").ravel()
    for name, enforce in common_checks.OTHERS.items():
        results = bench.run("flat_punch", {"contact.0.enforce": enforce})
        check_flat_punch(bench, name, results)
        check_edge_cells(bench, name, results)
        error = np.abs(results.surface_sorted("interface", "pressure").ravel() / exact - 1.0)
        nodes = slice(None, -2) if name == "penalty" else slice(None)  # sorted by x
        bench.below(f"{name} against semismooth: largest difference at nodes", error[nodes].max(), 0.01)


def overhanging_slave(bench):
    """The half-plane as slave, which sticks out of the punch: its nodes beyond the edge carry nothing, and the one at the
    edge, of whose support half is covered, has its share of the singular pressure."""
    changes = {"contact.0.slave": "half_plane_top", "contact.0.master": "punch_face", "contact.0.integration": {"segment": {}}}
    for name in ("semismooth", "vi"):
        results = bench.run("flat_punch", {**changes, "contact.0.enforce": {name: {}}})
        a, h = results.deck["mesh"]["parameters"]["a"], 1.0 / results.deck["mesh"]["parameters"]["n"]
        x, pressure = results.surface["interface"]["places"][:, 0], results.surface["interface"]["pressure"].ravel()
        force = results.force("interface")
        bench.close(f"{name}: force", force, 10.0, 1e-6)
        inside = x < 0.8 * a
        exact = references.flat_punch_pressure(x[inside], 2.0 * force, a)
        bench.below(f"{name}: largest error for x < 0.8 a", np.abs(pressure[inside] / exact - 1.0).max(), 0.03)
        bench.below(f"{name}: pressure beyond the edge", np.abs(pressure[x > a + 0.5 * h]).max(), 0.0)
        # from the middle between two nodes on, so that it is clear which of them counts
        begin = (np.floor(0.9 * a / h) + 0.5) * h
        points = results.points["interface"]
        share = (points["pressure"] * points["weight"])[points["places"][:, 0] > begin].sum()
        bench.close(f"{name}: force between 0.917 a and the edge", share, force * (1.0 - 2.0 / np.pi * np.arcsin(begin / a)), 0.05)


def disc_stack(bench):
    """Forces between discs, walls, floor and lid against a closed form; balance of the free bodies."""
    results = bench.run("disc_stack")
    parameters = results.deck["mesh"]["parameters"]
    columns, rows = parameters["columns"], parameters["rows"]
    law = results.deck["materials"]["polymer"]["elastic"]
    lid = 0.4  # how far the deck moves it
    across = 2.0 * parameters["interference"]
    down = across + lid / rows
    Q, P = references.boxed_disc_forces(across, down, parameters["R"], law["E"], law["nu"])
    for pair in results.points:
        is_level = pair in ("floor", "lid") or pair.startswith("rows")
        exact = columns * P if is_level else rows * Q
        bench.close(f"force of {pair}", results.force(pair), exact, 0.02)
    for first, second in (("floor", "lid"), ("left_wall", "right_wall")):
        difference = abs(results.force(first) - results.force(second)) / results.force(first)
        bench.below(f"{first} against {second}", difference, 1e-6)
    _, p0 = references.line_contact(P, parameters["R"] / 2.0, law["E"] / (2.0 * (1.0 - law["nu"] ** 2)))
    bench.close("peak pressure at the floor", results.peak_pressure("floor"), p0, 0.03)


def rigid_shapes(bench):
    """Sphere and cylinder against Hertz at the force found, plane against uniform compression."""
    results = bench.run("rigid_shapes")
    law = results.deck["materials"]["aluminium"]["elastic"]
    E, nu = float(law["E"]), law["nu"]
    modulus = references.contact_modulus((E, nu))

    def second_moment(pair, middle, axes):
        points = results.points[pair]
        share = points["pressure"] * points["weight"]
        offset = points["places"][:, axes] - middle
        return np.sum(share * np.sum(offset**2, axis=1)) / np.sum(share)

    a, p0 = references.sphere_contact(4.0 * results.force("sphere"), 40.0, modulus)
    bench.close("sphere: contact radius", np.sqrt(second_moment("sphere", [0.0, 0.0], [0, 1]) / 0.4), a, 0.02)
    bench.close("sphere: peak pressure", results.peak_pressure("sphere"), p0, 0.03)
    # the slice is 1 thick and half of the scene
    a, p0 = references.line_contact(2.0 * results.force("cylinder"), 40.0, modulus)
    bench.close("cylinder: half-width", np.sqrt(second_moment("cylinder", [30.0], [0]) / 0.25), a, 0.02)
    bench.close("cylinder: peak pressure", results.peak_pressure("cylinder"), p0, 0.03)
    # free to widen: stress E delta / H
    exact = E * 0.02 / 8.0
    bench.below("plane: pressure", np.abs(results.surface["plane"]["pressure"] / exact - 1.0).max(), 1e-8)
    bench.close("plane: force", results.force("plane"), exact * 8.0 * 8.0, 1e-8)


def formulations(scene):
    return lambda bench: common_checks.formulations_agree(bench, scene)


def ranks(scene):
    return lambda bench: common_checks.ranks_agree(bench, scene)


CASES = {
    "flat_punch": {"reference": flat_punch, "overhang": overhanging_slave, "ranks": ranks("flat_punch")},
    "disc_stack": {"reference": disc_stack, "formulations": formulations("disc_stack"), "ranks": ranks("disc_stack")},
    "rigid_shapes": {
        "reference": rigid_shapes,
        "formulations": formulations("rigid_shapes"),
        "ranks": ranks("rigid_shapes"),
    },
}
