#!/usr/bin/python3
"""Puts shipped scenes through what must not change their results: invariances.py --program PATH [SCENE...] [--seed N].

ranks (2 and 3 instead of 1), numbering of nodes and cells, a quarter turn and a shift of the whole scene, units (lengths
and stresses in others), a restart after a random increment on another number of ranks, a random increment that is given
up although it converged and done in halves (-cutback_at; against a run with the same increments declared), slave and
master exchanged (within the discretization error). A second run must give the same bits. Scenes run on coarse meshes, made once by gmsh and changed here. Exit status 0 when all hold.
"""
import argparse
import copy
import csv
import random
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import yaml
from meshes import read_mesh
from run import start

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "scenes"))
from harness import TOP, load_deck  # noqa: E402

# Coarse parameters of the mesh; increments of each step that is run (None: the deck's own steps); what exchanging slave and
# master may change (None: a rigid or one-sided master), the discretization error of so coarse a mesh; what is left out, for
# the deck has places in its expressions, lengths and stresses among its constants or laws, or an axis of revolution.
PLACES, UNITS = {"quarter_turn", "shifted"}, {"units"}
SCENES = {
    "patch_2d": ({"n_lower": 3, "n_upper": 7}, [2], 0.01, set()),
    "patch_3d": ({}, [2], 0.01, set()),
    "hertz_2d": ({"h": 0.25}, [2], 0.05, set()),
    "hertz_3d": ({"n": 3}, [2], 0.1, set()),
    "hertz_axisymmetric": ({"h": 0.25}, [2], 0.05, PLACES | UNITS),
    "flat_punch": ({"n": 6, "n_punch": 4}, [2], 0.05, set()),
    "rigid_shapes": ({"n": 3}, [2], None, set()),
    "wavy_block": ({"n": 8}, [2], None, set()),
    "block_on_incline": ({"n": 2}, [1, 4], None, set()),
    "cattaneo_mindlin_2d": ({"h": 0.3}, [2, 2], 0.05, UNITS),
    "cylinder_press_shear_path": ({"h": 0.8}, [2, 2], 0.1, set()),
    "mindlin_sphere_cycling": ({"n": 2}, [1, 2], None, UNITS),
    "friction_laws_gallery": ({}, [1, 2], None, PLACES | UNITS),
    "slip_weakening_fault": ({}, [1, 2, 4], None, PLACES | UNITS),
    "rate_and_state_slider": ({}, [1, 4], None, PLACES | UNITS),
    "disc_stack": ({"columns": 2, "rows": 2, "h": 0.6}, None, None, set()),
    "stack_with_friction_3d": ({}, None, None, set()),
}
EXACT = 1e-7  # relative: the solver's tolerance is 1e-10 of the forces, times what meshes and stiffnesses make of it
SHIFT = np.array([3.0, -7.0, 0.0])
LENGTH, STRESS = 1e-3, 1e6  # mm and MPa to m and Pa
FINER = 3  # times as many increments where one of them is chosen at random


def vectors(deck):
    """Every map of components {x, y, z} in the deck with the kind of quantity it holds."""
    for entry in deck.get("boundary", []):
        for kind in ("displacement", "traction", "resultant"):
            if kind in entry:
                yield kind, entry[kind]
    for force in deck.get("body_force", {}).values():
        yield "body_force", force
    for contact in deck["contact"]:
        if isinstance(contact["master"], dict):
            for shape in contact["master"].values():
                if "displacement" in shape:
                    yield "displacement", shape["displacement"]


def rigid_shapes(deck):
    return [shape for contact in deck["contact"] if isinstance(contact["master"], dict) for shape in contact["master"].values()]


def quarter_turn(deck, mesh):
    """(x, y) -> (-y, x)"""
    mesh.nodes = mesh.nodes @ np.array([[0.0, 1, 0], [-1, 0, 0], [0, 0, 1]])
    for _, parts in vectors(deck):
        turned = {"y": parts.get("x"), "x": None if "y" not in parts else f"-({parts['y']})", "z": parts.get("z")}
        parts.clear()
        parts.update({key: value for key, value in turned.items() if value is not None})
    for shape in rigid_shapes(deck):
        for key in ("point", "normal", "centre", "axis"):
            if key in shape:
                shape[key] = [-shape[key][1], shape[key][0], *shape[key][2:]]


def shifted(deck, mesh):
    mesh.move(SHIFT)
    for shape in rigid_shapes(deck):
        for key in ("point", "centre"):
            if key in shape:
                shape[key] = [float(a + b) for a, b in zip(shape[key], SHIFT)]


def other_units(deck, mesh):
    mesh.scale(LENGTH)
    force = STRESS * LENGTH ** (2 if deck["space"] == "solid" else 1)
    factors = {"displacement": LENGTH, "traction": STRESS, "resultant": force, "body_force": STRESS / LENGTH}
    for kind, parts in vectors(deck):
        for key in parts:
            parts[key] = f"{factors[kind]}*({parts[key]})"
    for entry in deck.get("boundary", []):
        if "pressure" in entry:
            entry["pressure"] = f"{STRESS}*({entry['pressure']})"
    for material in deck["materials"].values():
        material["elastic"]["E"] = float(material["elastic"]["E"]) * STRESS
    for shape in rigid_shapes(deck):
        for key in ("point", "centre"):
            if key in shape:
                shape[key] = [x * LENGTH for x in shape[key]]
        if "radius" in shape:
            shape["radius"] *= LENGTH
    for contact in deck["contact"]:
        if "search_distance" in contact:
            contact["search_distance"] *= LENGTH


def renumbered(_, mesh):
    mesh.renumber(1)


def exchanged(deck, _):
    for contact in deck["contact"]:
        contact["slave"], contact["master"] = contact["master"], contact["slave"]


class Harness:
    def __init__(self, options, folder):
        self.options, self.folder, self.failed, self.checks = options, Path(folder), 0, 0

    def run(self, name, deck, mesh, ranks=1, words=(), folder=None):
        """The last row of the history."""
        folder = folder or self.folder / name
        folder.mkdir(parents=True, exist_ok=True)
        mesh.write(folder / "mesh.msh")
        path = folder / "deck.yaml"
        path.write_text(yaml.safe_dump(deck, sort_keys=False), encoding="utf-8")
        done = start(self.options, ranks, [path, "--out", folder / "results", *words])
        # 4: so coarse a mesh may fail a tolerance of the certificate; that is not what is asked here.
        if done.returncode not in (0, 4):
            raise SystemExit(f"{name} ended with {done.returncode}\n{done.stdout[-2000:]}\n{done.stderr[-2000:]}")
        return self.history(folder)[-1]

    @staticmethod
    def history(folder):
        with open(folder / "results" / "history.csv", encoding="utf-8", newline="") as file:
            return [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]

    def compare(self, name, rows, factors, tolerance):
        """factors: of energies, forces, pressures, areas between the two rows."""
        plain, changed = rows
        worst, where = 0.0, ""
        energy, force, pressure, area = factors
        pairs = [(key.removesuffix("_area"), key) for key in plain if key.startswith("contact_") and key.endswith("_area")]
        values = [("energy_stored", plain["energy_stored"] * energy, changed["energy_stored"])]
        scale = max(np.linalg.norm(self.force(plain, pair)) for pair, _ in pairs)
        for pair, key in pairs:
            sizes = [np.linalg.norm(self.force(row, pair)) for row in rows]
            if sizes[0] > 1e-6 * scale:
                values.append((f"{pair} force", sizes[0] * force, sizes[1]))
                if tolerance == EXACT:
                    values.append((key, plain[key] * area, changed[key]))
                    values.append((f"{pair}_max_pressure", plain[f"{pair}_max_pressure"] * pressure, changed[f"{pair}_max_pressure"]))
        for what, value, other in values:
            error = abs(other - value) / abs(value)
            if error > worst:
                worst, where = error, what
        good = worst <= tolerance
        self.checks += 1
        self.failed += not good
        print(f"{'ok  ' if good else 'FAIL'} {name}: {worst:.1e} (at most {tolerance:.0e}) {where}", flush=True)

    def same_bits(self, name, one, other):
        different = [key for key in one if one[key] != other[key] and not (one[key] != one[key] and other[key] != other[key])]
        self.checks += 1
        self.failed += bool(different)
        print(f"{'FAIL' if different else 'ok  '} {name}: {len(one) - len(different)} of {len(one)} numbers have the same bits {different[:3]}", flush=True)

    @staticmethod
    def force(row, pair):
        return [row.get(f"{pair}_force_{c}", 0.0) for c in "xyz"]


def finer(deck):
    """The deck with more increments in each step up to the first that chooses its own, the others left out; how many."""
    fine, total = copy.deepcopy(deck), 0
    counts = [step.get("increments", 1) for step in fine["steps"]]
    counted = next((i for i, count in enumerate(counts) if not isinstance(count, int)), len(counts))
    fine["steps"] = fine["steps"][:counted]
    for step, count in zip(fine["steps"], counts):
        step["increments"] = FINER * count
        total += FINER * count
    return fine, total


def first_increments(deck, wanted):
    """The deck up to the end of so many increments."""
    part, begin = copy.deepcopy(deck), 0.0
    for i, step in enumerate(part["steps"]):
        if wanted <= step["increments"]:
            if wanted < step["increments"]:
                step["to"] = begin + (step["to"] - begin) / step["increments"] * wanted
            step["increments"] = wanted
            part["steps"] = part["steps"][: i + 1]
            return part
        wanted, begin = wanted - step["increments"], step["to"]
    raise ValueError("the deck has fewer increments")


def with_times(deck, times):
    """The deck with one increment to each of these times."""
    steps = [{"name": f"increment_{i}", "to": time, "increments": 1} for i, time in enumerate(times)]
    return {**deck, "steps": steps}


def stopped_and_cut(harness, scene, variant):
    """A restart and a cutback at increments, and on ranks, that the seed chooses."""
    seed, same = harness.options.seed, (1.0, 1.0, 1.0, 1.0)
    chance = random.Random(f"{seed} {scene}")
    (plain_deck, mesh), folder = variant(), harness.folder / scene
    deck, total = finer(plain_deck)
    after, before, restarted = chance.randint(1, total - 1), *chance.sample([1, 2, 3], 2)
    whole = harness.run(f"{scene}/finer", deck, mesh)
    harness.run("", first_increments(deck, after), mesh, before, folder=folder / "restart")
    words = ("--restart", folder / "restart" / "results" / "checkpoint.h5")
    row = harness.run("", deck, mesh, restarted, words, folder / "restart")
    said = f"seed {seed}: restart after increment {after} of {total}, ranks {before} to {restarted}"
    harness.compare(f"{scene} {said}", (whole, row), same, EXACT)
    at = chance.randint(0, total - 1)
    row = harness.run(f"{scene}/cutback", deck, mesh, 1, ("-cutback_at", at))
    times = [line["time"] for line in harness.history(folder / "cutback")]
    if len(times) <= total:
        raise SystemExit(f"{scene}: no increment was cut")
    declared = harness.run(f"{scene}/declared", with_times(deck, times), mesh)
    harness.compare(f"{scene} seed {seed}: forced cutback of increment {at + 1} of {total}", (declared, row), same, EXACT)


def make_variants(harness, scene):
    """A function of a change of deck and mesh that gives both, on a coarse mesh that is made once."""
    parameters, increments, _, _ = SCENES[scene]
    deck = load_deck(scene)
    geometry = TOP / "inputs" / scene / deck["mesh"]["file"]
    given = {**deck["mesh"].get("parameters", {}), **parameters}
    dim = dimension(deck)
    folder = harness.folder / scene
    folder.mkdir()
    numbers = [word for key, value in given.items() for word in ("-setnumber", key, str(value))]
    made = ["gmsh", f"-{dim}", "-format", "msh22", *numbers, "-o", str(folder / "made.msh"), str(geometry)]
    subprocess.run(made, capture_output=True, check=True)
    deck["mesh"] = {"file": "mesh.msh"}
    if scene == "disc_stack":
        deck["bodies"] = {body: name for body, name in deck["bodies"].items() if body[5] in "12" and body[7] in "12"}
        kept = {"floor", "rows_1_2", "left_wall", "columns_1_2"}
        lid = {"name": "lid", "slave": "top_2", "master": {"plane": {"point": [0, 40], "normal": [0, -1], "displacement": {"y": "-0.2*t"}}}}
        wall = {"name": "right_wall", "slave": "east_2", "master": {"plane": {"point": [40, 0], "normal": [-1, 0]}}}
        deck["contact"] = [contact for contact in deck["contact"] if contact["name"] in kept] + [lid, wall]
    if increments:  # and no steps after them: unloaded scenes have nothing to compare
        deck["steps"] = deck["steps"][: len(increments)]
    for step, count in zip(deck["steps"], increments or []):
        step["increments"] = count

    def variant(change=None):
        mesh, other = read_mesh(folder / "made.msh"), copy.deepcopy(deck)
        if change:
            change(other, mesh)
        return other, mesh

    return variant


def dimension(deck):
    return 3 if deck["space"] == "solid" else 2


def examine(harness, scene):
    _, _, exchange, left_out = SCENES[scene]
    variant = make_variants(harness, scene)
    if harness.options.stops_only:
        stopped_and_cut(harness, scene, variant)
        return
    same = (1.0, 1.0, 1.0, 1.0)
    plain = harness.run(f"{scene}/plain", *variant())
    for ranks in (2, 3):
        harness.compare(f"{scene} {ranks} ranks", (plain, harness.run(f"{scene}/ranks{ranks}", *variant(), ranks)), same, EXACT)
    harness.same_bits(f"{scene} again", plain, harness.run(f"{scene}/again", *variant()))
    for change in (renumbered, quarter_turn, shifted):
        if change.__name__ in left_out:
            continue
        name = f"{scene} {change.__name__}"
        harness.compare(name, (plain, harness.run(f"{scene}/{change.__name__}", *variant(change))), same, EXACT)
    if "units" not in left_out:
        compare_units(harness, scene, plain, variant, dimension(variant()[0]))
    if exchange:
        other = harness.run(f"{scene}/exchanged", *variant(exchanged))
        harness.compare(f"{scene} slave and master exchanged", (plain, other), same, exchange)
    stopped_and_cut(harness, scene, variant)


def compare_units(harness, scene, plain, variant, dim):
    units = STRESS * LENGTH**dim, STRESS * LENGTH ** (dim - 1), STRESS, LENGTH ** (dim - 1)
    harness.compare(f"{scene} other units", (plain, harness.run(f"{scene}/units", *variant(other_units))), units, EXACT)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help=", ".join(SCENES))
    parser.add_argument("--program", required=True, help="the amontons executable")
    parser.add_argument("--mpirun", default="mpirun --oversubscribe --bind-to none", help="how ranks are started")
    parser.add_argument("--seed", type=int, default=1, help="of the increments and ranks of restart and cutback")
    parser.add_argument("--stops_only", action="store_true", help="only restart and cutback")
    options = parser.parse_args()
    options.program = str(Path(options.program).resolve())
    if unknown := set(options.scenes) - set(SCENES):
        parser.error(f"unknown scenes {', '.join(unknown)}")
    with tempfile.TemporaryDirectory() as folder:
        harness = Harness(options, folder)
        for scene in options.scenes or SCENES:
            examine(harness, scene)
    print(f"{harness.checks} checks, {harness.failed} failed")
    return 0 if harness.checks and not harness.failed else 1


if __name__ == "__main__":
    sys.exit(main())
