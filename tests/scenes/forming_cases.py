"""Metal forming and rolling: contact, friction, large strain and plastic flow together."""
import numpy as np

from harness import load_deck

# --- a billet upset between plates ------------------------------------------------------------------------------------

RADIUS, HALF_HEIGHT = 10.0, 15.0
REDUCTIONS = (0.1, 0.2, 0.3, 0.4, 0.5)
# No friction, therefore no tangential unknowns either.
SMOOTH = {
    "name": "plate",
    "slave": "skin",
    "master": {"plane": {"point": [0, 15], "normal": [0, -1], "displacement": {"y": "-7.5*t"}}},
    "enforce": {"semismooth": {}},
    "search_distance": 10,
}


def uniform_billet(reduction, law):
    """Force, radius and plastic strain of a billet between smooth plates, which stays a cylinder: uniaxial logarithmic
    strain, Kirchhoff stress tau = yield + H p (J. C. Simo, Comput. Methods Appl. Mech. Engrg. 99 (1992) 61-112)."""
    young, nu, hardening = law["E"], law["nu"], law["hardening"]["linear"]
    strain = -np.log(1.0 - reduction)
    plastic = (young * strain - hardening["yield"]) / (young + hardening["H"])
    tau = hardening["yield"] + hardening["H"] * plastic
    volume_ratio = np.exp(-(1.0 - 2.0 * nu) * tau / young)
    radius = RADIUS * np.exp(nu * tau / young + 0.5 * plastic)
    return tau / volume_ratio * np.pi * radius**2, radius, plastic


def billet_law(results):
    return results.deck["materials"]["steel"]["elastic_plastic"]


def billet_radii(results):
    """Present radius in the middle, of the rim of the first face, and of what touches the plate."""
    x = results.places
    now = (x + results.nodal["displacement"])[:, :2]
    on_face = np.abs(x[:, 1] - HALF_HEIGHT) < 1e-9
    points = results.points["plate"]
    touching = points["places"][points["pressure"] > 0]
    rim = now[on_face, 0].max()
    rolled_over = np.abs(touching[:, 1] - HALF_HEIGHT) > 1e-6  # reference places of points of the side
    return now[np.abs(x[:, 1]) < 1e-9, 0].max(), rim, np.count_nonzero(rolled_over)


def billet_force(results, reduction):
    return np.interp(2.0 * reduction, results.history["time"], results.history["reaction_middle_y"])


def upsetting_smooth(bench):
    """Between smooth plates the billet stays a cylinder: closed form."""
    for order in (1, 2):
        changes = {"mesh.parameters": {"n": 4, "m": 6}, "mesh.order": order, "contact": [SMOOTH], "steps.0.increments": 20}
        results = bench.run("upsetting", changes, ranks=1)
        law = billet_law(results)
        for reduction in REDUCTIONS:
            exact = uniform_billet(reduction, law)[0]
            bench.close(f"order {order}: force at a reduction of {reduction:.0%}", billet_force(results, reduction), exact, 1e-3)
        middle, face, _ = billet_radii(results)
        exact = uniform_billet(0.5, law)[1]
        bench.close(f"order {order}: radius in the middle", middle, exact, 1e-4)
        bench.close(f"order {order}: radius of the face", face, exact, 1e-3)


def check_billet_energy(bench, results):
    """The mean of F_zz over the billet is h / H whatever its shape, as its faces stay on the plates; plastic work is convex
    in it (w(-ln F_zz) at least), so by Jensen's inequality no way of upsetting takes less than the uniform one."""
    law = billet_law(results)
    hardening, plastic = law["hardening"]["linear"], uniform_billet(0.5, law)[2]
    least = np.pi * RADIUS**2 * HALF_HEIGHT * plastic * (hardening["yield"] + 0.5 * hardening["H"] * plastic)
    work, stored, dissipated = (results.history[f"energy_{name}"][-1] for name in ("external_work", "stored", "dissipated"))
    bench.below("plastic work of the uniform billet / dissipated", least / dissipated, 1.0)
    bench.below("dissipated / plastic work of the uniform billet", dissipated / least, 1.03)
    bench.below("work not accounted for / work", abs(work - stored - dissipated) / work, 3e-3)


def upsetting_rough(bench):
    """Between rough plates: bounds of force and work, the barrel, its side rolled over onto the plate; two ranks as one."""
    one, two = (bench.run("upsetting", ranks=ranks) for ranks in (1, 2))
    law = billet_law(one)
    for reduction in (0.1, 0.2):
        # Slab method, the pressure rising inwards by 2 mu p / h; sticking friction: Avitzur's upper bound.
        smooth = uniform_billet(reduction, law)[0]
        radius, height = RADIUS / np.sqrt(1.0 - reduction), 2.0 * HALF_HEIGHT * (1.0 - reduction)
        force = billet_force(one, reduction)
        bench.below(f"reduction {reduction:.0%}: force between smooth plates / force", smooth / force, 1.0)
        slab = smooth * (1.0 + 2.0 * 0.3 * radius / (3.0 * height))
        bench.below(f"reduction {reduction:.0%}: force / force by the slab method", force / slab, 1.0)
    smooth, radius, _ = uniform_billet(0.5, law)
    bound = smooth * (1.0 + 2.0 * radius / (3.0 * np.sqrt(3.0) * HALF_HEIGHT))
    bench.below("reduction 50%: force / upper bound for sticking plates", billet_force(one, 0.5) / bound, 1.0)
    middle, rim, rolled_over = billet_radii(one)
    bench.below("uniform radius / radius of the barrel", radius / middle, 0.96)
    bench.below("radius of the face's first rim / uniform radius", rim / radius, 0.75)
    bench.below("points of the side that lie on the plate, at least 6: 6 / points", 6 / rolled_over, 1.0)
    check_billet_energy(bench, one)
    error = np.abs(one.history["reaction_middle_y"] - two.history["reaction_middle_y"]).max() / billet_force(one, 0.5)
    bench.below("2 ranks: force in the whole history", error, 1e-7)


# --- a rubber wheel ---------------------------------------------------------------------------------------------------


def wheel(results):
    """History columns: force of the road along and up, and what has been put in, stored, dissipated while rolling."""
    history = results.history
    rolling = history["time"] >= 1.0 - 1e-9
    energies = [history[f"energy_{name}"][rolling] for name in ("external_work", "stored", "dissipated")]
    work, stored, dissipated = (energy - energy[0] for energy in energies)
    return history["contact_road_force_x"][rolling], history["contact_road_force_y"][rolling], work - stored, dissipated


def wheel_braked(bench):
    """Hub driven a tenth too far: everything slips. The shear is friction's, and it takes all the work, but for the path's
    error, which falls with the increments and is extrapolated away."""
    runs = {}
    for count in (64, 128):
        along, up, spent, dissipated = wheel(
            bench.run("rolling_wheel", {"constants.travel": "2.2*pi", "steps.1.increments": count}, ranks=1)
        )
        half = len(along) // 2
        bench.below(f"{count} increments: shear / pressure, off 0.3", np.abs(along[half:] / up[half:] + 0.3).max(), 5e-4)
        runs[count] = spent[-1], dissipated[-1]
    defects = [(spent - dissipated) / spent for spent, dissipated in runs.values()]
    bench.below("work not accounted for, 128 increments over 64", defects[1] / defects[0], 0.65)
    spent, dissipated = (2.0 * fine - coarse for coarse, fine in zip(runs[64], runs[128]))
    bench.close("friction's work, extrapolated, against work less stored energy", dissipated, spent, 0.04)


def wheel_turn(bench):
    """A full turn: steady in the end, the same on two ranks; friction below its limit."""
    one, two = (bench.run("rolling_wheel", {"steps.1.increments": 64}, ranks=ranks) for ranks in (1, 2))
    along, up, _, dissipated = wheel(one)
    quarter = len(along) // 4
    bench.below("change of the shear in the last eighth of the turn / shear", abs(along[-1] / along[-1 - quarter // 2] - 1.0), 0.01)
    bench.below("ripple of the pressure in the last quarter", np.ptp(up[-quarter:]) / up[-1], 0.02)
    bench.below("shear / pressure / mu", np.abs(along / up).max() / 0.3, 1.0)
    bench.below("dissipation falls by / dissipated", max(0.0, -np.diff(dissipated).min()) / dissipated[-1], 1e-12)
    other = wheel(two)
    bench.below("2 ranks: shear in the whole history", np.abs(along - other[0]).max() / np.abs(along).max(), 1e-8)


# --- a cup drawn from a round sheet -----------------------------------------------------------------------------------

BLANK, WALL, DIE_OPENING = 36.0, 20.7, 21.4  # radii: of the blank, of the middle of the cup's wall, of the die's opening


def sheet(results):
    """Reference radius, present lower and upper places of the nodes across the sheet, from the axis outwards."""
    x = results.places
    now = (x + results.nodal["displacement"])[:, :2]
    faces = []
    for height in (0.0, 1.0):
        face = np.flatnonzero(results.in_body("sheet") & (np.abs(x[:, 1] - height) < 1e-9))
        faces.append(face[np.argsort(x[face, 0])])
    return x[faces[0], 0], now[faces[0]], now[faces[1]]


def thickness(results):
    """Reference radii, and thickness there; the first one was 1."""
    radius, lower, upper = sheet(results)
    return radius, np.linalg.norm(upper - lower, axis=1)


def rim_radius(results):
    _, lower, upper = sheet(results)
    return 0.5 * (lower[-1, 0] + upper[-1, 0])


def punch_force(results, way):
    return -np.interp(way, results.history["time"], results.history["contact_punch_force_y"])


def drawing_bounds(results, rim):
    """Force on the punch once the wall is upright and the rim at `rim`: below and above (R. Hill, The Mathematical Theory
    of Plasticity (1950), XI.3; E. Siebel, Stahl und Eisen 74 (1954) 155-158). In the flange d(sigma_r)/dr = -c Y / r with
    c = 1 (uniaxial) to 2 / sqrt(3) (plane strain); what is at r was at sqrt(r^2 + R0^2 - R^2). Above there are the
    holder's friction, the rope's factor exp(mu pi / 2) of the die's edge, and bending there and back."""
    law = results.deck["materials"]["sheet_steel"]["elastic_plastic"]["hardening"]["swift"]
    flow = lambda p: law["K"] * (law["eps_0"] + p) ** law["n"]
    mu, hold, die_radius = 0.1, 10.0, 5.0
    r = np.linspace(WALL, rim, 400)
    rise = flow(np.log(np.sqrt(r**2 + BLANK**2 - rim**2) / r)) / r
    stress = np.sum(0.5 * (rise[1:] + rise[:-1]) * np.diff(r))
    bending = flow(np.log(BLANK / WALL)) / (2.0 * die_radius + 1.0)
    above = (2.0 / np.sqrt(3.0) * stress + mu * hold / (np.pi * rim)) * np.exp(0.5 * np.pi * mu) + bending
    return 2.0 * np.pi * WALL * stress, 2.0 * np.pi * WALL * above


def check_drawing(bench, results, way):
    """Force and rim while the flange is being drawn in."""
    state = results.at(way)
    rim = rim_radius(state)
    below, above = drawing_bounds(results, rim)
    force = punch_force(results, way)
    bench.below(f"{way:g} mm: least force / force on the punch", below / force, 1.0)
    bench.below(f"{way:g} mm: force on the punch / bound above", force / above, 1.0)
    # Hoop compression alone at the rim: the other two strains are half of it.
    bench.close(f"{way:g} mm: thickness of the rim", thickness(state)[1][-1], np.sqrt(BLANK / rim), 0.01)


def check_cup(bench, results):
    for way in (10.0, 15.0):
        check_drawing(bench, results, way)
    radius, thick = thickness(results)
    bench.below("rim / radius of the die's opening (all of it is drawn through)", rim_radius(results) / DIE_OPENING, 1.0)
    bench.close("thickness of the rim in the end", thick[-1], np.sqrt(BLANK / rim_radius(results)), 0.02)
    bench.below("place of the thinnest sheet: its first radius / that of the punch", radius[thick.argmin()] / 20.0, 1.05)
    bench.below("the same from below: 15 / first radius", 15.0 / radius[thick.argmin()], 1.05)
    bench.below("thinnest", thick.min(), 0.97)
    bench.below("0.85 / thinnest", 0.85 / thick.min(), 1.0)
    work, stored, dissipated = (results.history[f"energy_{name}"][-1] for name in ("external_work", "stored", "dissipated"))
    bench.below("work not accounted for / work", abs(work - stored - dissipated) / work, 0.003)


def deep_drawing_start(bench):
    """The first third of the way."""
    automatic = {"first": 0.01, "largest": 0.06, "target_iterations": 20}
    steps = [{"name": "bend", "to": 5, "increments": {"auto": automatic}}]
    steps.append({"name": "draw", "to": 10, "increments": {"auto": {**automatic, "first": 0.06}}})
    check_drawing(bench, bench.run("deep_drawing", {"steps": steps}, ranks=1), 10.0)


def deep_drawing_cup(bench):
    """Drawn to the end: force and thickness."""
    check_cup(bench, bench.run("deep_drawing", ranks=1))


def deep_drawing_ranks(bench):
    """The same cup on one rank and on two."""
    one, two = (bench.run("deep_drawing", ranks=ranks) for ranks in (1, 2))
    for way in (5.0, 10.0, 15.0, 20.0):
        bench.close(f"{way:g} mm: force on the punch", punch_force(two, way), punch_force(one, way), 1e-4)


# --- a cup drawn from a square sheet ----------------------------------------------------------------------------------


def round_cup(deck, cup, parameters):
    """Changes of the square cup's deck that make the round `cup` of it, the deck of the axisymmetric scene: a box whose
    corners are as wide as itself is round. A quarter of the holder's force."""
    changes = {"mesh.parameters": {"round": 1, "blank": 36, "t": 1, "flat": 12, "inside": 22, "outside": 40, "thick": 6, **parameters}}
    changes["materials.aluminium"] = cup["materials"]["sheet_steel"]
    changes["boundary.2.resultant.z"] = 0.25 * cup["boundary"][1]["resultant"]["y"]
    changes["contact"], changes["certificate"] = deck["contact"], cup["certificate"]
    for pair, corner in zip(changes["contact"], cup["contact"]):
        pair["friction"], pair["enforce"] = corner["friction"], corner["enforce"]
        if "rounded_box" in pair["master"]:
            shape, box = corner["master"]["corner"], pair["master"]["rounded_box"]
            radius, height = shape["point"]
            box.update(point=[0, 0, height], half_widths=[radius, radius], corner_radius=radius, edge_radius=shape["radius"])
    return changes


def check_round(bench, parameters, cells, ways, tolerance):
    """A quarter of a round cup between rounded boxes against the axisymmetric cup between corners, `cells` along the radius."""
    automatic = {"first": 0.1, "largest": 0.5, "target_iterations": 20}
    steps = {"steps": [{"name": f"to_{way}", "to": way, "increments": {"auto": automatic}} for way in ways]}
    cup = load_deck("deep_drawing")
    changes = round_cup(load_deck("square_cup"), cup, parameters)
    solid = bench.run("square_cup", {**changes, **steps}, ranks=1)
    # Without stops: there is nothing in the solid model that shares the holder's force.
    flat = {"contact": cup["contact"][:3], "mesh.parameters": {"n": cells, "layers": 1}}
    turned = bench.run("deep_drawing", {**flat, **steps}, ranks=1)
    for way in ways:
        for pair, limit in (("punch", tolerance), ("die", 0.01), ("holder", 1e-6)):
            along, up = solid.history[f"contact_{pair}_force_z"], turned.history[f"contact_{pair}_force_y"]
            force, reference = np.interp(way, solid.history["time"], along), np.interp(way, turned.history["time"], up)
            bench.close(f"{way} mm: force of the {pair}, four quarters", 4.0 * force, reference, limit)


def square_cup_round(bench):
    """The first 2 mm of a round cup, cells of 3 mm in both models."""
    check_round(bench, {"n": 8, "m": 2}, 12, (1, 2), 0.04)


def square_cup_fine(bench):
    """The first 4 mm of a round cup, cells of 1.5 mm in both models."""
    check_round(bench, {"n": 16, "m": 4}, 24, (2, 4), 0.02)


def node_of(results, x, y, z):
    """The sheet's node that was at a place."""
    near = np.linalg.norm(results.places - (x, y, z), axis=1) < 1e-6
    (node,) = np.flatnonzero(near & results.in_body("sheet"))
    return node


def thickness_along(results, slope):
    """Of the square sheet along y = slope x, 0 (plane of symmetry) or 1 (diagonal): reference distances from the middle,
    and thickness there."""
    x, thick = results.places, 0.81
    on_line = results.in_body("sheet") & (np.abs(x[:, 1] - slope * x[:, 0]) < 1e-6)
    now, faces = x + results.nodal["displacement"], []
    for height in (0.0, thick):
        face = np.flatnonzero(on_line & (np.abs(x[:, 2] - height) < 1e-9))
        faces.append(face[np.argsort(x[face, 0])])
    return np.hypot(x[faces[0], 0], x[faces[0], 1]), np.linalg.norm(now[faces[1]] - now[faces[0]], axis=1)


def draw_in(results):
    """Of the lower face's rim in the middle of a side, and at the corner along the diagonal."""
    moved, half = results.nodal["displacement"], 75.0
    return -moved[node_of(results, half, 0, 0)][0], np.hypot(*moved[node_of(results, half, half, 0)][:2])


def check_halves(bench, results):
    """Nothing in the deck imposes symmetry about the diagonal."""
    places, moved = results.places, results.nodal["displacement"]
    order = np.lexsort(np.round(places.T, 6))
    mirrored = np.lexsort(np.round(places[:, [1, 0, 2]].T, 6))
    difference = np.abs(moved[order] - moved[mirrored][:, [1, 0, 2]]).max()
    bench.below(f"{results.time:g} mm: difference of the two halves / way of the punch", difference / results.time, 1e-8)


def check_rim(bench, results):
    """The rim's middle is under hoop compression alone."""
    moved, half, thick = results.nodal["displacement"], 75.0, 0.81
    # Stretch along the rim at its middle: y = Y (stretch + c Y^2) by symmetry, from the nodes of its first cell.
    stretch = []
    for z in (0.0, thick):
        one, two = (1.0 + moved[node_of(results, half, y, z)][1] / y for y in (half / 8.0, half / 4.0))
        stretch.append((4.0 * one - two) / 3.0)
    rim = thickness_along(results, 0)[1][-1]
    bench.close("thickness in the middle of the rim", rim, thick / np.sqrt(np.mean(stretch)), 0.02)


# Draw-in measured in the middle of a side and along the diagonal at 15 and 40 mm (example of the DEFORM-3D manual: README.md).
MEASURED = {15.0: (5.3, 3.3), 40.0: (28.5, 15.0)}


def square_cup_drawn(bench):
    """The square cup to its full depth: both halves alike, the rim's middle under hoop compression alone, drawn in as measured."""
    results = bench.run("square_cup", {"output.every": 1}, ranks=1)
    check_halves(bench, results)
    time = results.history["time"]
    check_rim(bench, results.at(time[time <= 15.0].max()))
    for way, tolerance in ((15.0, 0.15), (40.0, 0.05)):
        near = [results.at(time[time <= way].max()), results.at(time[time >= way].min())]
        both = zip(*(draw_in(state) for state in near))
        for place, drawn, measured in zip(("in the middle of a side", "along the diagonal"), both, MEASURED[way]):
            value = np.interp(way, [state.time for state in near], drawn)
            bench.close(f"{way:g} mm: draw-in {place}, against measured", value, measured, tolerance)
    work, stored, dissipated = (results.history[f"energy_{name}"] for name in ("external_work", "stored", "dissipated"))
    bench.below("work not accounted for / work, from 5 mm on", np.abs((work - stored - dissipated) / work)[time >= 5.0].max(), 0.006)


CASES = {
    "upsetting": {"smooth": upsetting_smooth, "rough": upsetting_rough},
    "rolling_wheel": {"braked": wheel_braked, "turn": wheel_turn},
    "deep_drawing": {"start": deep_drawing_start, "cup": deep_drawing_cup, "ranks": deep_drawing_ranks},
    "square_cup": {"round": square_cup_round, "fine": square_cup_fine, "drawn": square_cup_drawn},
}
