"""Friction through a restart: the second half of a run, on any number of ranks, against the run in one piece."""
from pathlib import Path

import numpy as np

from harness import TOP, Results, load_deck, set_key

SOLVER = {"snes_rtol": "1e-13"}  # what two partitions may differ by is what the solver leaves
PRESS_AND_SHEAR = [{"name": "press", "to": 1, "increments": 2}, {"name": "shear", "to": 2, "increments": 4}]
HALF_WAY = [PRESS_AND_SHEAR[0], {"name": "shear", "to": 1.5, "increments": 2}]

CYLINDER = {
    "mesh.parameters.h": 0.2,
    "materials.rubber.elastic.nu": 0.3,
    "contact.0.friction_factor": "1 + 0.1*x",
    "contact.0.master.cylinder.displacement.x": "0.02*max(t-1,0)",
    "petsc": SOLVER,
}
BLOCKS = {
    "mesh.parameters": {"n_lower": 2, "n_upper": 3, "hexes": 1, "structured": 1},
    "boundary": [
        {"on": "lower_bottom", "displacement": {"x": 0, "y": 0, "z": 0}},
        {
            "on": "upper_top",
            "displacement": {"x": "0.0094*max(t-1,0)", "y": "0.003*max(t-1.4,0)", "z": "-0.01*min(t,1)"},
        },
    ],
    "contact.0.integration": {"facet": {"order": 4}},
    "contact.0.friction": {"coulomb": {"mu": 0.3}},
    "certificate.penetration": 0.1,
    "petsc": SOLVER,
}
RATE_AND_STATE = {"rate_and_state": {"mu": 0.3, "a": 0.02, "b": 0.03, "L": 0.002, "v0": 0.01}}

# name: scene, its changes, more changes, ranks to go on with
VARIANTS = {
    "cylinder, semismooth": ("pressed_cylinder", CYLINDER, {}, (1, 2, 3)),
    "cylinder, uzawa": (
        "pressed_cylinder",
        CYLINDER,
        {"contact.0.enforce": {"uzawa": {"tolerance": 1e-12, "alpha": 5}}},
        (3,),
    ),
    "cylinder, penalty": (
        "pressed_cylinder",
        CYLINDER,
        {"contact.0.enforce": {"penalty": {}}, "certificate.penetration": 0.5, "certificate.complementarity": 0.5},
        (1,),
    ),
    # One solver on any number of ranks. The last step of Newton's method ends below what may be rounding (8 machine
    # epsilons, 1.3e-12 of the forces) at 1.2e-12 with LU and at 7e-14 with the condensed factorization of one rank, whose
    # iterates are others; this law makes 3.3e-10 of the shear of that, with any factorization.
    "cylinder, rate and state": (
        "pressed_cylinder",
        CYLINDER,
        {"contact.0.friction": RATE_AND_STATE, "petsc": {**SOLVER, "pc_type": "lu", "pc_factor_mat_solver_type": "mumps"}},
        (1, 3),
    ),
    "cylinder, dual basis": ("pressed_cylinder", CYLINDER, {"contact.0.enforce": {"semismooth": {"basis": "dual"}}}, (1, 3)),
    "hexahedra": ("patch_3d", BLOCKS, {}, (1, 2, 3)),
    "hexahedra, dual basis": ("patch_3d", BLOCKS, {"contact.0.enforce": {"semismooth": {"basis": "dual"}}}, (3,)),
    "tetrahedra": ("patch_3d", BLOCKS, {"mesh.parameters.hexes": 0}, (3,)),
}


LENGTHS = ("gap", "slip", "accumulated_slip")


def variant_deck(case, name, steps, file_name):
    scene, changes, more, _ = VARIANTS[name]
    scenes = TOP / "inputs" if (TOP / "inputs" / scene).is_dir() else Path(__file__).parent
    deck = load_deck(scene, scenes)
    deck["mesh"]["file"] = str((scenes / scene / deck["mesh"]["file"]).resolve())
    for path, value in {**changes, **more, "steps": steps}.items():
        set_key(deck, path, value)
    return deck, case.write(deck, file_name)


def point_fields(results):
    """Fields at the quadrature points, in an order that does not depend on ranks. (With the dual basis they are nodes of
    facets, and facets share places.)"""
    points = next(iter(results.points.values()))
    keys = np.round(points["places"], 9)
    order = np.lexsort((np.round(points["weight"], 12), keys[:, 2], keys[:, 1], keys[:, 0]))
    return {name: values[order] for name, values in points.items() if name != "vertices"}


def largest_difference(a, b):
    """The largest difference of two runs in history (last row) and point fields, and where. Each quantity is relative
    to its own largest value; forces along another axis and slip out of the plane may be rounding only, and so may all gaps
    (with the dual basis), so vectors, forces and lengths are taken together. Numbers of the solver are not compared."""
    worst = (0.0, "nothing")
    first, second = point_fields(a), point_fields(b)
    if set(first) != set(second):
        return np.inf, f"fields {set(first) ^ set(second)}"
    length = max(np.abs(first[name]).max() for name in LENGTHS)
    for name, values in first.items():
        scale = length if name in LENGTHS else np.abs(values).max()
        if scale > 0:
            worst = max(worst, (float(np.abs(values - second[name]).max() / scale), name))
    force = max(abs(values[-1]) for name, values in a.history.items() if "force" in name or "reaction" in name)
    for name, values in a.history.items():
        if name in ("newton", "linear", "outer", "residual", "path_error") or "penetration" in name:
            continue
        scale = force if "force" in name or "reaction" in name else abs(values[-1])
        if scale > 0:
            worst = max(worst, (abs(values[-1] - b.history[name][-1]) / scale, name))
    return worst


def restart_of_friction(case):
    """Stopped in the middle of the shear on two ranks, gone on with on 1, 2 and 3: shear, slip, status, states, forces
    and books at the end are those of the uninterrupted run."""
    for number, name in enumerate(VARIANTS):
        whole_deck, whole_path = variant_deck(case, name, PRESS_AND_SHEAR, f"whole_{number}")
        _, half_path = variant_deck(case, name, HALF_WAY, f"half_{number}")
        whole, half = case.folder / f"whole_{number}", case.folder / f"half_{number}"
        status, text = case.run(2, whole_path, "--out", whole)
        case.expect(f"{name}: the whole run ends with 0", status == 0, text)
        status, text = case.run(2, half_path, "--out", half)
        case.expect(f"{name}: the first half ends with 0", status == 0, text)
        reference = Results(whole_deck, whole)
        moved = point_fields(reference)["status"]
        case.expect(f"{name}: some points slide and some do not", 0 < np.sum(moved == 2) < len(moved))
        for ranks in VARIANTS[name][3]:
            out = case.folder / f"rest_{number}_{ranks}"
            status, text = case.run(ranks, whole_path, "--out", out, "--restart", half / "checkpoint.h5")
            case.expect(f"{name}: the restart on {ranks} ends with 0", status == 0, text)
            if status != 0:
                continue
            difference, where = largest_difference(reference, Results(whole_deck, out))
            print(f"     {name}, {ranks} ranks: largest difference {difference:.1e} in {where}")
            case.expect(f"{name}: the same end on {ranks} ranks", difference <= 1e-10, f"{difference} in {where}")


def path_control(case):
    """A frictional cylinder, pressed and sheared. The fine answer (200 + 100 increments) is found within the tolerance in
    a fraction of the increments, where 1 + 2 increments miss it; the summary says so; a restart goes on with the same
    books; with fixed increments the estimate covers what they are off, and changes nothing."""
    decks = {
        "fine": equal_steps(200, 100),
        "rough": equal_steps(1, 2),
        "controlled": [
            {"name": name, "to": to, "increments": {"auto": {"path_tolerance": 0.01}}}
            for name, to in (("press", 1), ("shear", 2))
        ],
        "plain": equal_steps(5, 5),
        "estimated": equal_steps(5, 5),
    }
    results = {}
    for name, steps in decks.items():
        results[name] = run_cylinder(case, name, steps, {"estimate_path_error": name == "estimated"})
    fine = point_fields(results["fine"])

    def shear_off(name):
        """L2 of the difference to the fine shear, relative to that of the bound, as the estimate has it."""
        fields = point_fields(results[name])
        square = np.sum(fine["weight"] * np.sum((fields["shear"] - fine["shear"]) ** 2, axis=1))
        return float(np.sqrt(square / np.sum(fine["weight"] * fine["tau_c"] ** 2)))

    path = results["controlled"].summary["path"]
    count = results["controlled"].summary["increments"]
    print(f"     {count} increments, off by {shear_off('controlled'):.1e}, said {path['estimated_error']:.1e}")
    case.expect("1 + 2 increments miss the tolerance", shear_off("rough") > 0.05, shear_off("rough"))
    case.expect("path control keeps it", shear_off("controlled") <= 0.01, shear_off("controlled"))
    case.expect("and says so", path["estimated_error"] <= 0.02 and path["beyond_tolerance"] == 0, path)
    case.expect("with a third of the increments at most", count <= 100, count)
    case.expect("as many rows as increments", len(results["controlled"].history["time"]) == count)
    case.expect("every half is certified", np.all(results["controlled"].history["certified"] == 1))

    spread = {
        name: run.summary["energy"]["external_work_uncertainty"] / run.summary["energy"]["external_work"]
        for name, run in results.items()
    }
    print(f"     uncertainty of the work: {spread['plain']:.1e} with 5 + 5, {spread['fine']:.1e} with 200 + 100 increments")
    case.expect("the books get as exact as the increments are fine", spread["fine"] <= 0.1 * spread["plain"], spread)

    path = results["estimated"].summary["path"]
    print(f"     fixed: off by {shear_off('estimated'):.1e}, said {path['estimated_error']:.1e}")
    case.expect("the estimate covers the error", shear_off("estimated") <= path["estimated_error"] <= 0.5, path)
    difference, where = largest_difference(results["plain"], results["estimated"])
    case.expect("the estimate changes nothing", difference <= 1e-10, f"{difference} in {where}")
    work = results["plain"].summary["newton_iterations"] + path["extra_newton_iterations"]
    case.expect("its cost is stated", work == results["estimated"].summary["newton_iterations"], path)
    restarted_path(case, decks["controlled"], results["controlled"])
    held_load(case)


def equal_steps(press, shear):
    return [
        {"name": "press", "to": 1, "increments": press},
        {"name": "shear", "to": 2, "increments": shear},
    ]


def run_cylinder(case, name, steps, changes, *words):
    deck, path = variant_deck(case, "cylinder, semismooth", steps, name)
    for key, value in changes.items():
        set_key(deck, key, value)
    case.write(deck, name)
    status, text = case.run(1, path, "--out", case.folder / name, *words)
    case.expect(f"{name} ends with 0", status == 0, text)
    return Results(deck, case.folder / name)


def held_load(case):
    """A load that stays: tractions and slip stay, too, whatever number of increments it stays for."""
    hold = {"name": "hold", "to": 2}
    press = {"name": "press", "to": 1, "increments": 3}
    still = {"contact.0.master.cylinder.displacement.x": "0"}
    once, often = (
        point_fields(run_cylinder(case, f"held_{count}", [press, {**hold, "increments": count}], still))
        for count in (1, 20)
    )
    for name in ("pressure", "shear", "accumulated_slip"):
        difference = np.abs(once[name] - often[name]).max() / np.abs(once[name]).max()
        case.expect(f"a held load does not creep: {name}", difference <= 1e-10, difference)


def restarted_path(case, steps, reference):
    """Stopped at the end of the first step and gone on with: the same increments, the same sums."""
    run_cylinder(case, "first_step", steps[:1], {})
    checkpoint = case.folder / "first_step" / "checkpoint.h5"
    rest = run_cylinder(case, "second_step", steps, {}, "--restart", checkpoint)
    difference, where = largest_difference(reference, rest)
    case.expect("after a restart: the same end", difference <= 1e-10, f"{difference} in {where}")
    sums = [run.summary["path"]["estimated_error"] for run in (reference, rest)]
    case.expect("after a restart: the same sum", abs(sums[0] - sums[1]) <= 1e-9 * sums[0], sums)
    counts = [run.summary["increments"] for run in (reference, rest)]
    case.expect("after a restart: the same increments", counts[0] == counts[1], counts)
