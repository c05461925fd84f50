"""Surfaces that meet themselves: rings against the elastica, folds of a tube, ten discs found by search."""
import numpy as np

from harness import load_deck

# --- an elastic ring --------------------------------------------------------------------------------------------------

# Inextensible ring of radius 1 and bending stiffness 1 between frictionless plates: force, approach / diameter. Closed
# form (elastica) until the curvature below the plates is zero, at a force of 2.786408 and an approach of 0.282230.
PLATES = ((0.5, 0.039400), (1.0, 0.083472), (2.0, 0.186765), (2.786408, 0.282230))
# The same ring under outer pressure p, which buckles it at 3 and brings opposite points together at 5.2469 (J. E.
# Flaherty, J. B. Keller, S. I. Rubinow, SIAM J. Appl. Math. 23 (1972) 446-455): half-axes before ...
FREE = {3.8: (1.34393, 0.36253), 4.4: (1.36948, 0.17533), 5.0: (1.37162, 0.04396)}
# ... and force between the walls after that, one point up to p = 10.34: the elastica again, stopped by the other wall at half
# the thickness before the middle lines meet (p = 5.1883; it gives 5.24689 and 2.339, 4.685, 7.032 for no thickness).
PRESSED = {6.748: 2.432, 8.248: 4.780, 9.748: 7.129}


def ring_under_pressure(cells):
    """Changes to the deck. The pressure is that on the middle line: the outer rim is longer."""
    t = 0.02
    times = (3.0, 3.8, 4.4, 5.0, 5.2, 6.748, 8.248, 9.748)
    return {
        "mesh.parameters": {"n": cells, "t": t, "oval": 1e-3},
        "boundary": [
            {"on": "on_x", "displacement": {"y": 0}},
            {"on": "on_y", "displacement": {"x": 0}},
            {"on": "outside", "pressure": f"t/{1 + 0.5 * t}"},
        ],
        "contact": [{"name": "inside", "self": "skin", "enforce": {"penalty": {}}}],
        "petsc": {},  # the default line search; with that of the deck increments are tiny where it buckles
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
    results = bench.run("ring_crush", ring_under_pressure(24))
    for pressure, (x_exact, y_exact) in FREE.items():
        x, y = half_axes(results.at(pressure))
        bench.close(f"p = {pressure}: longer half-axis", x, x_exact, 0.005)
        bench.below(f"p = {pressure}: error of the shorter half-axis / R", abs(y - y_exact), 0.02)
    bench.below("p = 5: force between the walls", wall_force(results.at(5.0)), 0.0)
    # The pressure acts on the outer rim, which bends with the middle line: relative errors of the pressure are of the
    # order of t / R. So pressures at the same force are compared.
    for pressure in PRESSED:
        force = wall_force(results.at(pressure))
        exact = np.interp(force, [0.0, *PRESSED.values()], [5.1883, *PRESSED])
        bench.close(f"pressure at a force of {force:.3f} between the walls", pressure, exact, 0.015)


def ring_plates(bench):
    """Between two plates, up to where the ring lifts off in the middle."""
    deck_steps = [{"name": "squeeze", "to": 0.2825, "increments": {"auto": {"first": 0.05, "largest": 0.1}}}]
    history = bench.run("ring_crush", {"mesh.parameters.n": 16, "steps": deck_steps}).history
    for exact, approach in PLATES:
        force = np.interp(approach, history["time"], -history["contact_top_force_y"])
        bench.close(f"force at an approach of {approach} diameters", force, exact, 0.01)
    bench.below("contact of the ring with itself", history["contact_inside_area"].max(), 0.0)


def pinched_ring(force):
    """Approach of each of two opposite point loads on the inextensible ring of radius 1 and bending stiffness 1. From the
    load to the side, tangent angle a: a'' = -force / 2 cos a, a = 0 and -pi / 2 at the ends, natural curvature -1."""
    count = 100
    step = 0.5 * np.pi / count

    def slope(state):
        angle, bend = state[:2]
        return np.array([bend - 1.0, -0.5 * force * np.cos(angle), -np.sin(angle)])

    def end(first_bend):
        state = np.array([0.0, first_bend, 0.0])  # angle, change of curvature, height of the load above the side
        for _ in range(count):
            one = slope(state)
            two = slope(state + 0.5 * step * one)
            three = slope(state + 0.5 * step * two)
            state = state + step / 6.0 * (one + 2.0 * two + 2.0 * three + slope(state + step * three))
        return state

    low, high = 0.2 * force, 0.5 * force
    for _ in range(40):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if end(middle)[0] < -0.5 * np.pi else (low, middle)
    return 1.0 - end(0.5 * (low + high))[2]


def pinch(cells, friction=None):
    """Changes to the deck: discs instead of the plates, until the walls between them are pressed on each other."""
    discs = [{"sphere": {"centre": [0, sign * 1.31], "radius": 0.3, "displacement": {"y": f"{-sign}*t"}}} for sign in (1, -1)]
    pairs = [{"name": "inside", "self": "skin", "enforce": {"penalty": {}}}]
    for name, disc in zip(("top", "bottom"), discs):
        pairs.append({"name": name, "slave": "outside", "master": disc, "enforce": {"penalty": {"alpha": 0.05}}, "search_distance": 3})
    for pair in pairs if friction else []:
        pair["friction"] = {"coulomb": {"mu": friction}}
    automatic = {"first": 0.02, "largest": 0.04, "target_iterations": 12}
    return {
        "mesh.parameters.n": cells,
        "contact": pairs,
        "steps": [
            {"name": "pinch", "to": 0.98, "increments": {"auto": automatic}},
            {"name": "press", "to": 0.991, "increments": {"auto": {**automatic, "first": 0.1, "largest": 0.1}}},
        ],
    }


def check_pinched(bench, results):
    time, force = results.history["time"], -results.history["contact_top_force_y"]
    touching = results.history["contact_inside_area"] > 0
    free = ~touching & (time > 0.3)
    error = max(abs(pinched_ring(f) - t) for t, f in list(zip(time[free], force[free]))[::12])
    bench.below("approach at the same force against the elastica / radius", error, 0.02)
    bench.close("approach at which the walls meet: radius less half of the thickness", time[touching].min(), 0.99, 0.002)
    # What the discs press with beyond what bends the ring goes from wall to wall.
    bench.close("force between the walls", wall_force(results), force[-1] - force[~touching][-1], 0.03)


def ring_pinched(bench):
    check_pinched(bench, bench.run("ring_crush", pinch(16), ranks=1))


def ring_pinched_friction(bench):
    """By symmetry nothing slides where the walls meet, and next to nothing under the discs."""
    check_pinched(bench, bench.run("ring_crush", pinch(16, friction=0.3)))


OVAL = 0.25  # half-axes of the middle line 1.25 and 0.75, the plates along the longer one


def oval_between_plates(approach=None, mu=0.0, touching=False):
    """The inextensible oval, free of stress, between plates that have come this near, each: its approach, force, height of the wall's
    inner side above the middle, and the force that the walls press on each other with where they are `touching`. Without an approach:
    where they begin to.

    A quarter, from the middle of the wall to the side, by the angle phi of the ellipse. With v = ds / dphi, tangent angle a, natural
    curvature k_0 and moment m = change of curvature: a' = v m - k_0 v, m' = v (V cos a + H sin a) with the forces across the section
    and along the plates: V half of the walls' up to where the plate lies on (phi_c, where a = 0) and less by half of the plate's from
    there on; H what friction pulls the wall taut with, mu times half of the plate's force up to there and nothing beyond. Without
    friction the wall between its two lines of contact takes on the mean curvature, 0, and sags where its own was least, in the middle."""
    long, short, half = 1 + OVAL, 1 - OVAL, 0.01

    def shoot(unknowns):
        """Angle at the plate's line of contact, at the side less -pi / 2, heights of wall and plate above the side."""
        moment, contact, plate, wall = unknowns
        state, found = np.array([0.0, moment, 0.0]), []
        parts = ((0.0, contact, 0.5 * wall, 0.5 * mu * plate), (contact, 0.5 * np.pi, 0.5 * (wall - plate), 0.0))
        for first, last, across, along in parts:
            step = (last - first) / 60

            def slope(phi, y):
                v = np.hypot(long * np.cos(phi), short * np.sin(phi))
                bend = v * (across * np.cos(y[0]) + along * np.sin(y[0]))
                return np.array([v * y[1] - long * short / v**2, bend, v * np.sin(y[0])])

            for phi in first + step * np.arange(60):
                one = slope(phi, state)
                two = slope(phi + 0.5 * step, state + 0.5 * step * one)
                three = slope(phi + 0.5 * step, state + 0.5 * step * two)
                state = state + step / 6 * (one + 2 * two + 2 * three + slope(phi + step, state + step * three))
            found.append(state)
        at_plate, side = found
        return at_plate[0], side[0] + 0.5 * np.pi, -side[2] - half, at_plate[2] - side[2]

    def conditions(unknowns):
        at_plate, side, wall_height, plate_height = shoot(unknowns)
        third = wall_height if touching or approach is None else unknowns[3]
        return np.array([at_plate, side, third, unknowns[3] if approach is None else short - plate_height - approach])

    unknowns = np.array([0.5, 1.0, 60.0, 0.0])
    for _ in range(20):
        values = conditions(unknowns)
        steps = 1e-6 * np.maximum(1.0, np.abs(unknowns))
        slopes = np.array([(conditions(unknowns + row) - values) / row.sum() for row in np.diag(steps)]).T
        change = np.linalg.solve(slopes, values)
        unknowns = unknowns - change * min(1.0, 0.1 / abs(change[1]), 30.0 / abs(change[2]))
    assert np.abs(conditions(unknowns)).max() < 1e-8, "the elastica has not been found"
    _, _, wall_height, plate_height = shoot(unknowns)
    return short - plate_height, unknowns[2], wall_height, unknowns[3]


def oval_ring(cells, friction=None):
    """Changes to the deck: a ring that is an oval at rest, between the plates until its walls are pressed on each other."""
    thickness = 0.02
    pairs = [{"name": "inside", "self": "skin", "enforce": {"penalty": {"alpha": 0.1}}}]
    for name, sign in (("top", 1), ("bottom", -1)):
        plane = {"point": [0, sign * (1 - OVAL + 0.5 * thickness)], "normal": [0, -sign], "displacement": {"y": f"{-sign}*t"}}
        pairs.append({"name": name, "slave": "outside", "master": {"plane": plane}, "search_distance": 3,
                      "enforce": {"penalty": {"alpha": 0.07}}})
    for pair in pairs if friction else []:
        pair["friction"] = {"coulomb": {"mu": friction}}
    automatic = {"first": 0.03, "largest": 0.06, "target_iterations": 12}
    return {
        "mesh.parameters": {"n": cells, "t": thickness, "oval": OVAL},
        "contact": pairs,
        "steps": [{"name": "crush", "to": 0.62, "increments": {"auto": automatic}}],
    }


def ring_oval(bench):
    """Walls that meet between the plates' lines of contact and press on each other."""
    results = bench.run("ring_crush", oval_ring(24), ranks=1)
    time, force = results.history["time"], -results.history["contact_top_force_y"]
    touching = results.history["contact_inside_area"] > 0
    meeting, force_then, _, _ = oval_between_plates()
    # Somewhere between the last increment without contact and the first with it.
    outside = max(0.0, time[~touching].max() - meeting, meeting - time[touching].min())
    bench.below("approach at which the walls meet, off that of the elastica / that", outside / meeting, 0.01)
    bench.close("approach at the force of the elastica then", np.interp(force_then, force, time), meeting, 0.01)
    _, force_end, _, walls = oval_between_plates(time[-1], touching=True)
    bench.close("force of the plates at the end", force[-1], force_end, 0.08)
    # It grows from nothing to 0.32 within 0.015 of the way: ways at the same force are compared.
    way = meeting + (time[-1] - meeting) * wall_force(results) / walls
    bench.close("approach at the force between the walls at the end", time[-1], way, 0.01)


def ring_oval_friction(bench):
    """Friction pulls the wall between the plates' lines of contact taut: it sags less than half as much and does not touch."""
    results = bench.run("ring_crush", oval_ring(24, 0.3), ranks=1)
    time, force = results.history["time"], -results.history["contact_top_force_y"]
    _, force_end, height, _ = oval_between_plates(time[-1], 0.3)
    bench.close("force of the plates at the end, against the elastica", force[-1], force_end, 0.08)
    middle = (np.abs(results.places[:, 0]) < 1e-9) & (results.places[:, 1] > 0)
    wall = (results.places[middle, 1] + results.nodal["displacement"][middle, 1]).min()
    bench.below("height of the wall's inner side, off by / radius", abs(wall - height), 0.005)
    bench.below("contact of the walls", results.history["contact_inside_area"].max(), 0.0)


# --- a tube crushed along its axis ------------------------------------------------------------------------------------


def tube_first_fold(bench):
    """The first peak against the load at which all of the wall yields, then a fold that closes on itself."""
    results = bench.run("tube_buckling_2d", {"steps.0.to": 16})
    parameters = results.deck["mesh"]["parameters"]
    steel = results.deck["materials"]["steel"]["elastic_plastic"]
    yield_load = 2.0 * np.pi * parameters["R"] * parameters["t"] * steel["hardening"]["linear"]["yield"]
    time, force = results.history["time"], -results.history["reaction_top_y"]
    bench.close("first peak against the load of yielding", force[time < 5].max(), yield_load, 0.03)
    touching = results.history["contact_folds_area"] > 0
    before = force[~touching]
    bench.below("first contact of the fold with itself", time[touching].min(), 15.5)
    bench.below("lowest force before that / peak", before.min() / force[time < 5].max(), 0.4)
    bench.below("lowest force / force at the end, once the fold is closed", before.min() / force[-1], 0.5)


def tube_ranks(bench):
    """Both folds, on one rank and on two: with equal increments every state is the same. (Automatic ones follow the count of
    iterations, which rounding decides where a fold snaps: README.md.)"""
    one, two = (bench.run("tube_buckling_2d", {"steps.0.increments": 600}, ranks=ranks).history for ranks in (1, 2))
    largest = np.abs(one["reaction_top_y"]).max()
    for name, scale in (("reaction_top_y", largest), ("contact_folds_force_y", largest), ("energy_dissipated", one["energy_dissipated"][-1])):
        bench.below(f"2 ranks: {name} in the whole history", np.abs(one[name] - two[name]).max() / scale, 1e-8)


# --- ten discs --------------------------------------------------------------------------------------------------------


def touching_places(radius):
    """Where discs of neighbouring rows touch, and all places where two discs touch."""
    centres = [
        np.array([(2 * i + 1 + row % 2) * radius, (1 + row * np.sqrt(3.0)) * radius])
        for row in range(4)
        for i in range(3 - row % 2)
    ]
    pairs = [(a, b) for k, a in enumerate(centres) for b in centres[k + 1 :] if np.linalg.norm(a - b) < 2.01 * radius]
    return [0.5 * (a + b) for a, b in pairs if abs(a[1] - b[1]) > 0.1 * radius], [0.5 * (a + b) for a, b in pairs]


def check_neighbours(bench, results):
    """Loads are where discs touch and nowhere else, and between rows wherever they touch, found from both sides."""
    between_rows, everywhere = touching_places(results.deck["mesh"]["parameters"]["R"])
    points = results.points["discs"]
    loaded = points["places"][points["pressure"] > 0][:, :2]
    normals = points["normal"][points["pressure"] > 0]
    away = np.min([np.linalg.norm(loaded - place, axis=1) for place in everywhere], axis=0)
    bench.below("largest distance of a loaded point from where discs touch / R", away.max() / 10.0, 0.4)
    missing = 0
    for place in between_rows:
        here = np.linalg.norm(loaded - place, axis=1) < 4.0
        missing += not (np.any(normals[here, 1] > 0) and np.any(normals[here, 1] < 0))
    bench.below(f"contacts between rows that were not found, of {len(between_rows)}", missing, 0)


def ten_discs(bench):
    """Forces of floor and lid, and of the walls, balance; every neighbour is found, on any number of ranks."""
    runs = {ranks: bench.run("ten_discs", ranks=ranks) for ranks in (1, 2, 3)}
    results = runs[2]
    floor, lid = results.force("floor"), results.force("lid")
    bench.below("floor against lid", abs(floor - lid) / floor, 1e-6)
    left, right = results.force("left"), results.force("right")
    bench.below("left against right", abs(left - right) / left, 1e-6)
    check_neighbours(bench, results)
    exact = runs[1].nodal_sorted("displacement")
    for ranks in (2, 3):
        error = np.abs(runs[ranks].nodal_sorted("displacement") - exact).max() / np.abs(exact).max()
        bench.below(f"{ranks} ranks: displacement", error, 1e-6)


def tube_steps(end):
    """Those of tube_buckling_3d, crushed to `end`."""
    steps = load_deck("tube_buckling_3d")["steps"]
    steps[-1]["to"] = end
    return steps


def quarter_and_section_runs(bench, steps, around=5):
    """The tube in 3D, a quarter with this many cells around, and its section, both with these steps."""
    solid = bench.run("tube_buckling_3d", {"steps": steps, "mesh.parameters.around": around}, ranks=1)
    parameters = {key: value for key, value in solid.deck["mesh"]["parameters"].items() if key != "around"}
    changes = {"mesh.parameters": parameters, "contact.2.master.plane.point": [0, parameters["L"]], "steps": steps}
    return solid, bench.run("tube_buckling_2d", changes, ranks=1)


def quarter_and_section(bench, steps, around=5):
    """Their forces, of the full turn."""
    solid, section = quarter_and_section_runs(bench, steps, around)
    return -4.0 * solid.history["reaction_top_z"], -section.history["reaction_top_y"]


def tube_quarter_peak(bench):
    """The quarter in 3D against its section: elastic, where it converges with the cells around, and past the first peak."""
    errors = {}
    for around in (3, 5):
        elastic = [{"name": "elastic", "to": 0.02, "increments": 1}]
        force, exact = quarter_and_section(bench, elastic, around)
        errors[around] = abs(force[-1] / exact[-1] - 1.0)
    bench.below("elastic force, off that of the section, 5 cells around", errors[5], 2e-3)
    # Parts of a parabola for parts of a circle: third order at least.
    bench.below("the same over that with 3 cells around", errors[5] / errors[3], (3 / 5) ** 3)
    force, exact = quarter_and_section(bench, load_deck("tube_buckling_3d")["steps"][:1])
    bench.close("first peak of the force", force.max(), exact.max(), 0.01)
    bench.close("force at 0.2 mm, past it", force[-1], exact[-1], 0.01)


CASES = {
    "ring_crush": {
        "plates": ring_plates,
        "pressure": ring_pressure,
        "pinch": ring_pinched,
        "pinch_friction": ring_pinched_friction,
        "oval": ring_oval,
        "oval_friction": ring_oval_friction,
    },
    "tube_buckling_2d": {"first_fold": tube_first_fold, "ranks": tube_ranks},
    "tube_buckling_3d": {"peak": tube_quarter_peak},
    "ten_discs": {"balance": ten_discs},
}
