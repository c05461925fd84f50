"""Blocks in simple shear on frictional surfaces against closed forms and ordinary differential equations.

A block of height H whose sides carry the complementary shear is a spring of stiffness k = G / H per area, exactly, with any mesh.
"""
import numpy as np
import yaml

import common_checks
import friction_laws
import harness
import references


def friction_coefficient(history, pair):
    """|shear force| / normal force, by increment; 2D, contact from below."""
    return np.abs(history[f"contact_{pair}_force_x"]) / history[f"contact_{pair}_force_y"]


# --- block_on_incline -------------------------------------------------------------------------------------------------


def check_incline(bench, name, results, weight, tether, first=0):
    """Balance and friction at every angle; `tether`: its stiffness. Forces are on the block, x downhill, y out of the
    incline. Friction is judged from sliding increment number `first` on."""
    mu, history = 0.5, results.history
    tilted = history["time"] > 1.0
    angle = np.radians(40.0 * (history["time"][tilted] - 1.0))
    normal, friction = history["contact_incline_force_y"][tilted], history["contact_incline_force_x"][tilted]
    pull = history["reaction_tether_end_x"][tilted]
    stick = history["contact_incline_stick_area"][tilted]
    total = history["contact_incline_area"][tilted]
    bench.below(f"{name}: normal force - W cos, / W", np.abs(normal - weight * np.cos(angle)).max() / weight, 1e-6)
    bench.below(
        f"{name}: balance along the incline / W", np.abs(friction + pull + weight * np.sin(angle)).max() / weight, 1e-6
    )
    steep = np.tan(angle) > mu
    bench.below(
        f"{name}: friction / W cos - mu above atan mu",
        np.abs(-friction / (weight * np.cos(angle)) - mu)[steep][first:].max(), 1e-6,
    )
    bench.below(f"{name}: sticking part of the contact above atan mu", (stick / total)[steep].max(), 0.0)
    bench.below(f"{name}: sticking part below it (negative)", -(stick / total)[~steep].min(), -0.05)
    # At rest friction carries the weight, but for what the elastic give of the block puts on the tether.
    bench.below(
        f"{name}: |friction + W sin| / W at rest",
        np.abs(friction + weight * np.sin(angle))[~steep].max() / weight, 2e-3,
    )
    slid = -pull / tether
    exact = np.maximum(0.0, weight * (np.sin(angle) - mu * np.cos(angle))) / tether
    bench.below(
        f"{name}: way down / way at 40 degrees, from the rigid block's",
        np.abs(np.abs(slid) - exact).max() / exact.max(), 0.02,
    )


def incline(bench):
    weight, tether = 2000.0 * 9.81 * 0.2 * 0.1, 0.2e6 * 0.1 / 1.0
    for name, enforce in (("semismooth", {}), ("uzawa", {"tolerance": 1e-8}), ("penalty", {"alpha": 100})):
        results = bench.run("block_on_incline", {"contact.0.enforce": {name: enforce}})
        check_incline(bench, name, results, weight, tether)


def incline_solid(bench):
    """In 3D, on a deformable ground whose mesh does not match."""
    depth = 0.1
    results = bench.run(
        "block_on_incline",
        {
            "space": "solid",
            "mesh.parameters": {"depth": depth, "n": 2},
            "bodies.ground": "rubber",
            "boundary": [
                {"on": "tether_end", "displacement": {"x": "0", "z": "0"}},
                {"on": "ground_base", "displacement": {"x": "0", "y": "0", "z": "0"}},
            ],
            "contact.0.master": "ground_top",
            "steps.1.increments": 16,
        },
    )
    # At rest the block has spread across the incline, too, and that shear turns downhill in the first sliding increment:
    # there the resultant is 3e-6 short of mu N, while at every point |shear| = mu p.
    check_incline(bench, "3D", results, 2000.0 * 9.81 * 0.2 * 0.1 * depth, 0.2e6 * 0.1 * depth, first=1)
    points = results.points["incline"]
    shear = np.linalg.norm(points["shear"], axis=1)
    bench.below(
        "3D: |shear| - mu p at the points / largest mu p",
        np.abs(shear - 0.5 * points["pressure"]).max() / (0.5 * points["pressure"].max()), 1e-6,
    )


# --- rate_and_state_slider --------------------------------------------------------------------------------------------

MU, L, V0, PRESSURE, HEIGHT = 0.6, 2e-3, 1e-3, 10.0, 10.0
V1, V2 = 1e-3, 1e-2


def law(a, b, evolution):
    return {"mu": MU, "a": a, "b": b, "L": L, "v0": V0, "evolution": evolution}


def velocity_step(bench):
    """Friction against the slider's ODE; a and b as a laboratory reads them off, against those of the law."""
    a, b, young = 0.016, 0.012, 70e3
    stiffness = young / 2.0 / HEIGHT
    for evolution in ("ageing", "slip"):
        history = bench.run(
            "rate_and_state_slider", {"contact.0.friction.rate_and_state": law(a, b, evolution)}
        ).history
        after = history["time"] > 21.0
        time, found = history["time"][after], friction_coefficient(history, "surface")[after]
        before = friction_coefficient(history, "surface")[~after][-1]
        bench.close(f"{evolution}: steady friction at V1", before, MU + (a - b) * np.log(V1 / V0), 1e-4)
        exact = references.slider_after_step(
            time - 21.0, V1, V2, {"mu": MU, "a": a, "b": b, "L": L, "v0": V0}, stiffness / PRESSURE, evolution
        )
        jump = a * np.log(V2 / V1)
        bench.below(
            f"{evolution}: largest difference from the ODE / direct jump", np.abs(found - exact).max() / jump, 0.02
        )
        direct, evolved = found.max() - before, found.max() - found[-1]
        bench.close(f"{evolution}: direct effect, peak / ln(V2/V1)", direct, exact.max() - before, 0.02)
        bench.close(
            f"{evolution}: evolution effect, fall from the peak / ln(V2/V1)", evolved, exact.max() - exact[-1], 0.02
        )
        bench.close(f"{evolution}: a - b", (found[-1] - before) / np.log(V2 / V1), a - b, 0.01)


def soft_slider(bench, ratio, steps, v2):
    """A run with stiffness `ratio` times the critical one, the steady traction in place from the start (F0 = mu p / k)."""
    a, b = 0.008, 0.012
    stiffness = ratio * (b - a) * PRESSURE / L
    young = 2.0 * HEIGHT * stiffness
    return bench.run(
        "rate_and_state_slider",
        {
            "constants": {"E": young, "p": PRESSURE, "V1": V1, "V2": v2, "F0": MU * PRESSURE / stiffness},
            "materials.rock.elastic.E": young,
            "contact.0.friction.rate_and_state": law(a, b, "slip"),
            "steps": steps,
        },
    ).history


def growth_of_oscillation(values):
    """ln |lambda| per increment of x[n+1] = trace x[n] - det x[n-1] with |lambda|^2 = det, by least squares."""
    matrix = np.stack([values[1:-1], -values[:-2]], axis=1)
    (_, det), *_ = np.linalg.lstsq(matrix, values[2:], rcond=None)
    return 0.5 * np.log(det)


def critical_stiffness(bench):
    """A rate step of 0.1 % decays above k_c = (b - a) p / L and grows below.

    The slip rate is constant in an increment and the state its exact solution, so with x = ln(v/V), h = V dt / L, kappa = k L / p
    and E = e^-h the linearized increments are
        (a - b (1 - E) + kappa h) x' = a x + b (1 - E) theta,   theta' = E theta - (1 - E) x'
    with determinant a E / (a - b (1 - E) + kappa h) = |lambda|^2: the border is kappa = (b - a)(1 - E) / h, which becomes k_c
    as h does 0. (A. Ruina 1983 for the continuous slider.)
    """
    a, b, dt = 0.008, 0.012, 0.1
    v2 = 1.001 * V1
    h = v2 * dt / L
    left = np.exp(-h)
    steps = [
        {"name": "press", "to": 1},
        {"name": "steady", "to": 21, "increments": 2},
        {"name": "perturbed", "to": 46, "increments": 250},
    ]
    growth = {}
    for ratio in (0.9, 1.1):
        history = soft_slider(bench, ratio, steps, v2)
        found = friction_coefficient(history, "surface")[3:] - (MU + (a - b) * np.log(v2 / V0))
        growth[ratio] = growth_of_oscillation(found)
        exact = 0.5 * np.log(a * left / (a - b * (1.0 - left) + ratio * (b - a) * h))
        bench.close(f"k/k_c = {ratio}: growth per increment", growth[ratio], exact, 0.02)
    bench.below("growth above the border", growth[1.1], 0.0)
    bench.below("decay below it", -growth[0.9], 0.0)
    border = 0.9 + 0.2 * growth[0.9] / (growth[0.9] - growth[1.1])
    bench.close("border found / k_c, against that of increments of this length", border, (1.0 - left) / h, 0.005)
    bench.close("border found / k_c", border, 1.0, 0.03)


SLIDE = [
    {"name": "press", "to": 1},
    {"name": "steady", "to": 21, "increments": 2},
    {"name": "slide", "to": 141, "increments": 240},
]


def stick_slip(bench):
    """Half the critical stiffness: stick-slip; twice: steady sliding after a rate step of 50 %."""
    a, b, dt = 0.008, 0.012, 0.5
    v2 = 1.5 * V1
    history = soft_slider(bench, 2.0, SLIDE, v2)
    found = friction_coefficient(history, "surface")
    steady = MU + (a - b) * np.log(v2 / V0)
    bench.below("k = 2 k_c: distance from steady sliding at the end", abs(found[-1] - steady), 1e-6)

    history = soft_slider(bench, 0.5, SLIDE, v2)
    found, time = friction_coefficient(history, "surface")[3:], history["time"][3:]
    stiffness = 0.5 * (b - a) / L  # over the pressure
    slip = v2 * dt - np.diff(found) / stiffness  # what the spring gives up and is fed
    events = np.flatnonzero(slip > 5.0 * L)
    bench.below("k = k_c/2: five slip events or more; their number", -len(events), -5)
    # An event fills one increment and ends on the steady line of the law at the rate slip / dt.
    lands = MU + (a - b) * np.log(slip[events] / dt / V0)
    bench.below("events end on the steady line", np.abs(found[events + 1] - lands).max(), 1e-4)
    bench.below(
        "smallest slip rate between events / rate of pulling", slip[events[1] : events[2]].min() / (v2 * dt), 0.2
    )
    periods = np.diff(time[events])[1:]
    bench.below("spread of the periods in increments", np.ptp(periods) / dt, 1.0)


# --- prakash_clifton_step ---------------------------------------------------------------------------------------------


def pressure_step(bench):
    """tau = mu p2 - mu (p2 - p1) exp(-s/L) from the step on, s the slip; the block's own shear takes V t - s = tau / k."""
    mu, length, p1, p2, rate = 0.6, 0.1, 10.0, 12.0, 1.0
    young, height, cell, alpha = 70e3, 10.0, 5.0, 30.0
    for name in ("semismooth", "uzawa", "penalty"):
        changes = {"contact.0.enforce": {name: {}}}
        compliance = 2.0 * height / young
        if name == "penalty":  # whose springs, alpha E / h, let the block sink and lag
            changes["contact.0.enforce"] = {name: {"alpha": alpha}}
            changes["boundary.1.displacement.y"] = (
                f"-(p1*min(t,1) + (p2-p1)*min(max(t-3,0)/tiny,1))*(y + {cell / alpha})/E"
            )
            compliance += cell / (alpha * young)
        history = bench.run("prakash_clifton_step", changes).history
        time = history["time"]
        shear = np.abs(history["contact_surface_force_x"]) / 20.0
        pressure = history["contact_surface_force_y"] / 20.0
        before, after = np.flatnonzero(time <= 3.0)[-1], time > 3.0
        bench.close(f"{name}: steady shear before the step", shear[before], mu * p1, 1e-9)
        bench.close(f"{name}: pressure after it", pressure[before + 1], p2, 1e-9)
        bench.below(
            f"{name}: jump of the shear with the pressure / mu (p2 - p1)",
            abs(shear[before + 1] / (mu * p1) - 1.0), 1e-4,
        )
        slip = rate * (time[after] - 3.0) - (shear[after] - shear[before]) * compliance
        exact = mu * p2 - mu * (p2 - p1) * np.exp(-slip / length)
        bench.below(
            f"{name}: largest distance from exp(-s/L) / mu (p2 - p1)",
            np.abs(shear[after] - exact).max() / (mu * (p2 - p1)), 0.01,
        )


# --- slip_weakening_fault ---------------------------------------------------------------------------------------------

MU_S, MU_K = 0.7, 0.5


def weakening_run(bench, critical_slip, enforce, increments):
    """The fault's shear, slip and dissipation by increment from the end of pressing on."""
    stiffness, width, rate = 150.0, 100.0, MU_S * PRESSURE / 150.0
    history = bench.run(
        "slip_weakening_fault",
        {
            "contact.0.friction.slip_weakening.D_c": critical_slip,
            "contact.0.enforce": enforce,
            "steps.2.increments": increments,
        },
    ).history
    shear = np.abs(history["contact_fault_force_x"]) / width
    slip = rate * np.maximum(0.0, history["time"] - 1.0) - shear / stiffness
    bench.close("pressure", history["contact_fault_force_y"][-1] / width, PRESSURE, 1e-9)
    return history, shear, slip, history["energy_dissipated"] / width


def weakening(bench):
    """tau = p (mu_s - (mu_s - mu_k) min(D/D_c, 1)) all the way, its peak and residual, and the work that it takes."""
    critical_slip = 0.02
    for name in ("semismooth", "uzawa"):
        enforce = {"uzawa": {"tolerance": 1e-9}} if name == "uzawa" else {"semismooth": {}}
        history, shear, slip, dissipated = weakening_run(bench, critical_slip, enforce, 50)
        law = PRESSURE * (MU_S - (MU_S - MU_K) * np.minimum(slip / critical_slip, 1.0))
        moving = history["time"] > 2.0 + 1e-9
        bench.below(f"{name}: slip up to the peak / D_c", np.abs(slip[~moving]).max() / critical_slip, 1e-7)
        bench.close(f"{name}: peak", shear.max(), MU_S * PRESSURE, 1e-8)
        bench.close(f"{name}: residual", shear[-1], MU_K * PRESSURE, 1e-8)
        bench.below(
            f"{name}: distance from the law / residual", np.abs(shear - law)[moving].max() / (MU_K * PRESSURE), 1e-7
        )
        # Work of the shear at the ends of increments: a sum to the right of a falling line, exact but for that.
        work = MU_K * PRESSURE * slip[-1] + 0.5 * (MU_S - MU_K) * PRESSURE * critical_slip
        bench.close(f"{name}: work on the fault", dissipated[-1], work, 0.02)
        bench.close(f"{name}: work on the fault by increments", dissipated[-1], np.sum(shear[1:] * np.diff(slip)), 1e-6)


def drop(bench):
    """k = 3/4 W: no equilibrium between peak and residual; the increment after the peak ends on the residual.

    Newton's method gets there when its first iterate does: the points' own springs eps = alpha E / h = 1.25 W are taken just above
    W, and the increment dU beyond the peak so large that k dU = 0.7 MPa > (eps - W) D_c = 0.5 MPa.
    """
    history, shear, slip, _ = weakening_run(bench, 0.01, {"semismooth": {"alpha": 1.25 * 200.0 * 12.5 / 30e3}}, 5)
    peak = np.flatnonzero(np.abs(history["time"] - 2.0) < 1e-9)[0]
    bench.close("peak", shear[peak], MU_S * PRESSURE, 1e-8)
    bench.close("shear in the increment after it", shear[peak + 1], MU_K * PRESSURE, 1e-8)
    bench.below("slip in that increment: D_c / slip", 0.01 / slip[peak + 1], 1.0)
    bench.close("residual", shear[-1], MU_K * PRESSURE, 1e-8)


# --- friction_laws_gallery --------------------------------------------------------------------------------------------


def gallery_laws():
    path = harness.TOP / "inputs" / "friction_laws_gallery" / "laws.yaml"
    return yaml.safe_load(path.read_text(encoding="utf-8"))


def trace_law(history, compliance):
    """Per increment: duration, pressure, shear, slip, and whether it slides.

    The slip is the motion of the top less the block's own shear. Creep of rate and state below a thousandth of that motion is lost in
    the difference and counts as rest.
    """
    time, area = history["time"], 400.0
    pressure = history["contact_base_force_z"] / area
    shear = np.hypot(history["contact_base_force_x"], history["contact_base_force_y"]) / area
    growth = np.log(100.0) / 3.0
    pull = 0.1 * (np.maximum(np.minimum(time, 1.0) - 0.01, 0.0) + np.expm1(growth * np.maximum(time - 1.0, 0.0)) / growth)
    slip = np.diff(pull - shear * compliance, prepend=0.0)
    slides = (history["contact_base_slip_area"] > 0.0) & (slip > 1e-3 * np.diff(pull, prepend=0.0))
    return np.diff(time, prepend=0.0), pressure, shear, np.where(slides, slip, 0.0), slides


def check_law(bench, name, parameters, enforce):
    """Every increment on the law: the shear at the limit in slip, at most the limit in stick."""
    kind, options = next(iter(enforce.items()))
    compliance = 10.0 / 105e3
    changes = {"contact.0.friction": {name: parameters}, "contact.0.enforce": enforce}
    if kind == "penalty":  # springs of alpha E / h let the base sink and lag
        compliance += 10.0 / (options["alpha"] * 210e3)
        changes["boundary.1.displacement.z"] = (
            f"-(p0*min(t/0.01,1) + (p1-p0)*min(max(t-0.03,0)/0.97,1))*(z + {10.0 / options['alpha']})/E"
        )
    history = bench.run("friction_laws_gallery", changes).history
    duration, pressure, shear, slip, slides = trace_law(history, compliance)
    state, off, above = None, 0.0, 0.0
    for i in range(1, len(shear)):  # the first increment only presses
        if name == "rate_and_state" and not slides[i]:
            continue  # it creeps, unseen
        limit, state = friction_laws.LAWS[name](parameters, pressure[i], slip[i], duration[i], state)
        if slides[i]:
            off = max(off, abs(shear[i] / limit - 1.0))
        else:
            above = max(above, shear[i] / limit - 1.0)
    sine = -history["contact_base_force_y"][slides] / (400.0 * shear[slides])
    bench.below(f"{name}, {kind}: sliding increments (negative)", -np.count_nonzero(slides), -50)
    bench.below(f"{name}, {kind}: distance of sliding increments from the law, relative", off, 1e-6)
    bench.below(f"{name}, {kind}: sticking increments above the law, relative", above, 1e-6)
    bench.below(f"{name}, {kind}: direction of the shear", np.abs(sine - 0.5).max(), 1e-6)


def gallery(bench):
    for name, parameters in gallery_laws().items():
        check_law(bench, name, parameters, {"semismooth": {}})


def gallery_formulations(bench):
    for name, parameters in gallery_laws().items():
        check_law(bench, name, parameters, {"uzawa": {"tolerance": 1e-9}})
        check_law(bench, name, parameters, {"penalty": {"alpha": 20}})


def release(bench):
    """Weakened, unloaded to no pressure, moved, lifted, pressed again: the surface has forgotten, whatever the law remembers."""
    touching = "(-0.005*(min(t,1)-min(max(t-2,0),1)) + 0.01*min(max(t-4,0),1) - 0.015*min(max(t-5,0),1))"
    lifted = "(-0.005*min(t,1) + 0.015*min(max(t-2,0),1) - 0.015*min(max(t-5,0),1))"  # at once
    pull = "(0.5*min(max(t-1,0),1) + 0.1*min(max(t-3,0),1) + 0.5*max(t-6,0))"
    steps = [("press", 1, 1), ("slide", 2, 20), ("unload", 3, 2), ("move", 4, 2), ("lift", 5, 2), ("close", 6, 4)]
    steps.append(("slide_again", 7, 40))
    parameters = gallery_laws()["slip_weakening"]
    kinds = {
        "semismooth": ({"semismooth": {}}, touching),
        "dual basis": (common_checks.DUAL, touching),
        "uzawa": ({"uzawa": {"tolerance": 1e-9}}, lifted),
    }
    for kind, (enforce, depth) in kinds.items():
        history = bench.run(
            "friction_laws_gallery",
            {
                "boundary.0": {"on": "top", "displacement": {"x": pull, "y": "0", "z": depth}},
                "boundary.1.displacement.z": f"{depth} < 0 ? {depth}*z/10 : {depth}",
                "contact.0.friction": {"slip_weakening": parameters},
                "contact.0.enforce": enforce,
                "steps": [{"name": name, "to": to, "increments": count} for name, to, count in steps],
            },
        ).history
        time, area = history["time"], 400.0
        pressure, shear = history["contact_base_force_z"] / area, np.abs(history["contact_base_force_x"]) / area
        top = 0.5 * np.clip(time - 1.0, 0.0, 1.0) + 0.1 * np.clip(time - 3.0, 0.0, 1.0) + 0.5 * np.maximum(time - 6.0, 0.0)
        full = 0.005 / 10.0 * 210e3
        at = lambda moment: np.argmin(np.abs(time - moment))
        bench.close(f"{kind}: residual before the release", shear[at(2.0)], parameters["mu_k"] * full, 1e-8)
        idle = (time > 3.0 - 1e-9) & (time < 5.0 + 1e-9)
        bench.below(
            f"{kind}: pressure and shear while unloaded, moved and lifted",
            max(pressure[idle].max(), shear[idle].max()) / full, 1e-9,
        )
        bench.close(f"{kind}: pressure after closing", pressure[at(6.0)], full, 1e-8)
        bench.below(f"{kind}: shear after closing without motion", shear[at(6.0)] / full, 1e-9)
        again = time > 6.0 + 1e-9
        slip = top[again] - top[at(6.0)] - shear[again] * 10.0 / 105e3
        law = friction_laws.slip_weakening(parameters, full, 0.0, 1.0, 0.0)[0] - full * 0.2 * np.minimum(slip / 0.2, 1.0)
        bench.below(f"{kind}: slides again from mu_s, relative", np.abs(shear[again] / law - 1.0).max(), 1e-6)
        bench.close(f"{kind}: residual at the end", shear[-1], parameters["mu_k"] * full, 1e-8)


def no_coefficient(bench):
    """mu = 0 is a frictionless block."""
    for enforce in ({"semismooth": {}}, common_checks.DUAL, {"uzawa": {}}):
        history = bench.run(
            "friction_laws_gallery", {"contact.0.friction": {"coulomb": {"mu": 0}}, "contact.0.enforce": enforce}
        ).history
        shear = np.hypot(history["contact_base_force_x"], history["contact_base_force_y"])
        bench.below(
            f"{next(iter(enforce))}: shear / normal force", (shear / history["contact_base_force_z"]).max(), 1e-12
        )
        bench.below(
            f"{next(iter(enforce))}: dissipation / stored energy",
            history["energy_dissipated"].max() / history["energy_stored"].max(), 1e-12,
        )


# --- belt on a drum ---------------------------------------------------------------------------------------------------


def belt_tension(deck, angle, sense):
    """Tension at an angle from the loaded end where all of the belt slides, away from the load (1) or towards it (-1), as
    a multiple of the load. Moments about the drum's axis: dT (R + t/2) = mu p R^2 dθ, with p R = T."""
    size = deck["mesh"]["parameters"]
    mu = deck["contact"][0]["friction"]["coulomb"]["mu"]
    return np.exp(sense * mu * angle * size["R"] / (size["R"] + size["t"] / 2))


def belt(bench):
    """Euler's and Eytelwein's belt: tension at the held end, pressure along the drum, and few iterations while it goes on
    sliding."""
    results = bench.run("capstan")
    history, load = results.history, 1.0
    tension = -history["reaction_held_x"]
    end_of_load = int(np.argmin(np.abs(history["time"] - 1.0)))
    for name, row, sense in (("sliding to the load", end_of_load, -1), ("pulled", -1, 1)):
        bench.close(f"{name}: tension", tension[row], load * belt_tension(results.deck, np.pi / 2, sense), 1e-3)
        bench.below(f"{name}: area that sticks", history["contact_drum_stick_area"][row], 1e-12)
    points = results.points["drum"]
    angle = np.arctan2(points["places"][:, 1], points["places"][:, 0])
    expected = load * belt_tension(results.deck, angle, 1) / results.deck["mesh"]["parameters"]["R"]
    for start in range(9, 81, 9):  # whole cells
        part = (angle >= np.radians(start)) & (angle < np.radians(start + 9))
        force, reference = (np.sum(p[part] * points["weight"][part]) for p in (points["pressure"], expected))
        bench.close(f"force on the drum from {start} to {start + 9} degrees", force, reference, 5e-3)
    goes_on = np.delete(history["newton"], [0, end_of_load + 1])  # all but the first increment of each step
    bench.below("most iterations of an increment that goes on like the one before", goes_on.max(), 4)


CASES = {
    "friction_laws_gallery": {
        "reference": gallery,
        "formulations": gallery_formulations,
        "release": release,
        "no_coefficient": no_coefficient,
    },
    "block_on_incline": {"reference": incline, "solid": incline_solid},
    "capstan": {"reference": belt},
    "slip_weakening_fault": {"reference": weakening, "drop": drop},
    "prakash_clifton_step": {"reference": pressure_step},
    "rate_and_state_slider": {
        "velocity_step": velocity_step,
        "critical_stiffness": critical_stiffness,
        "stick_slip": stick_slip,
    }
}
