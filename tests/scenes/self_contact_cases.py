"""Surfaces that meet themselves: rings against the elastica, folds of a tube, ten discs found by search."""
import numpy as np

# --- an elastic ring --------------------------------------------------------------------------------------------------

# Inextensible ring of radius 1 and bending stiffness 1 between frictionless plates: force, approach / diameter. Closed
# form (elastica) until the curvature below the plates is zero, at a force of 2.786408 and an approach of 0.282230.
PLATES = ((0.5, 0.039400), (1.0, 0.083472), (2.0, 0.186765), (2.786408, 0.282230))
# The same ring under outer pressure p, which buckles it at 3 and brings opposite points together at 5.2469 (J. E.
# Flaherty, J. B. Keller, S. I. Rubinow, SIAM J. Appl. Math. 23 (1972) 446-455): half-axes before ...
FREE = {3.8: (1.34393, 0.36253), 4.4: (1.36948, 0.17533), 5.0: (1.37162, 0.04396)}
# ... and force between the walls after that; the contact is a point up to p = 10.34.
PRESSED = {6.748: 2.339, 8.248: 4.685, 9.748: 7.031}


def ring_under_pressure(cells):
    """Changes to the deck. The pressure is that on the middle line: the outer rim is longer."""
    t = 0.02
    times = (3.0, 3.8, 4.4, 5.0, 5.2, 6.748, 8.248, 9.748)
    return {
        "mesh.parameters": {"n": cells, "t": t, "oval": 1e-3},
        "boundary.2": {"on": "outside", "pressure": f"t/{1 + 0.5 * t}"},
        "contact": [{"name": "inside", "self": "skin", "enforce": {"penalty": {}}}],
        "steps": [
            {"name": f"to_{i}", "to": time, "increments": {"auto": {"first": 0.2, "largest": 0.5}}}
            for i, time in enumerate(times)
        ],
    }


def half_axes(results):
    """Of the middle line: means of the inner and outer rim on the axes."""
    places, moved = results.places, results.nodal["displacement"]
    now = places[:, :2] + moved[:, :2]
    on_x = (np.abs(places[:, 1]) < 1e-9) & (places[:, 0] > 0)
    on_y = (np.abs(places[:, 0]) < 1e-9) & (places[:, 1] > 0)
    middle = [0.5 * (values.min() + values.max()) for values in (now[on_x, 0], now[on_y, 1])]
    return middle


def wall_force(results):
    """Each wall carries the contact with half of its area: the sum over both is the force of one contact."""
    points = results.points["inside"]
    return float(np.sum(points["pressure"] * points["weight"]))


def ring_pressure(bench):
    """A ring buckled by pressure until opposite walls meet and press on each other."""
    results = bench.run("ring_crush", ring_under_pressure(12))
    for pressure, (x_exact, y_exact) in FREE.items():
        x, y = half_axes(results.at(pressure))
        bench.close(f"p = {pressure}: longer half-axis", x, x_exact, 0.005)
        bench.below(f"p = {pressure}: error of the shorter half-axis / R", abs(y - y_exact), 0.02)
    bench.below("p = 5: force between the walls", wall_force(results.at(5.0)), 0.0)
    for pressure, exact in PRESSED.items():
        bench.close(f"p = {pressure}: force between the walls", wall_force(results.at(pressure)), exact, 0.03)


def plates_against_elastica(bench, results, tolerance):
    history = results.history
    approach, force = history["time"], -history["contact_top_force_y"]
    for exact, at in PLATES:
        bench.close(f"force at an approach of {at} diameters", np.interp(at, approach, force), exact, tolerance)


CASES = {
    "ring_crush": {"pressure": ring_pressure},
}
