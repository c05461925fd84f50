"""Metal forming and rolling: contact, friction, large strain and plastic flow together."""
import numpy as np

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


CASES = {
    "upsetting": {"smooth": upsetting_smooth, "rough": upsetting_rough},
    "rolling_wheel": {"braked": wheel_braked, "turn": wheel_turn},
}
