#!/usr/bin/python3
"""An effect that is off is not there: instructions.py CASE --program PATH [--valgrind valgrind]

Runs of patch_2d, counted by valgrind's callgrind (allocations; instructions of the whole process, start-up of MPI and reading
the deck included; and the 5 % of them that are in the program and in the libraries that compute, for which a difference
of the rest is no cover) and by PETSc (objects).

off: the deck with only what it must say against the same with every effect written down as off: equal unknowns and
PETSc objects, instructions and allocations within a hundredth; and in neither has any function of any effect of the
table run.
elastic: the same for the two bodies without a contact pair; nothing of contact runs.
on: the effects of the table switched on, as the control that their functions can be seen at all.
"""
import argparse
import copy
import json
import os
import re
import subprocess
import sys
import tempfile
from collections import Counter
from pathlib import Path

import yaml

TOP = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(TOP / "scripts"), str(TOP / "tests/scenes"), str(TOP / "tests/support")]
from harness import load_deck, set_key  # noqa: E402
from score import Score  # noqa: E402

# Effect -> functions that compute it. Declaring keys, and asking whether a deck has them, is not an effect.
EFFECTS = {
    "friction": r"TangentialPart::|ContactForm::evaluate_friction|\w+::limit\(amontons::FrictionContext",
    "state of friction": r"\w+::initial_state\(amontons::FrictionContext",
    "finite kinematics": r"FiniteBulkForm::",
    "pressure that follows": r"FollowerPressureForm::",
    "plasticity": r"radial_return|FinitePlastic::",
    "stabilization": r"ViscousForm::",
    "path error": r"IncrementSolver::solve_halves|path_difference|PathRecord::",
    "path control": r"PathControl::",
    "other solutions": r"SolutionCensus::",
    "adaptive meshing": r"Adaptation::|wanted_sizes|simplex_errors",
    "multipliers in an outer loop": r"UzawaLoop::|UzawaMultipliers::",
    "bounds": r"BoundedNewton::|MortarTransform::",
    "dual basis": r"CondensedNewton::|CondensedContact::",
    "segments": r"place_by_segments",
    "contact with itself": r"is_partner",
    "refinement": r"refined\(amontons::PlexMesh",
    "audit of inertia": r"audit_motion",
    "audit of yielding": r"audit_yield",
}

# Changes to the deck that switch effects on, as many at a time as go together.
PLASTIC = {"elastic_plastic": {"E": 70, "nu": 0.2, "hardening": {"linear": {"yield": 0.5, "H": 10}}}}
AGEING = {"rate_and_state": {"mu": 0.02, "a": 0.001, "b": 0.002, "L": 0.1, "v0": 1, "evolution": "ageing"}}
ON = (
    (("friction", "state of friction", "finite kinematics", "pressure that follows", "plasticity", "stabilization",
      "path error", "other solutions", "refinement", "audit of inertia", "audit of yielding"),
     {"kinematics": "finite", "materials.soft": PLASTIC, "materials.stiff.density": 1e-9, "mesh.refine": 1,
      "materials.stiff.yield_stress": 100, "contact.0.friction": AGEING, "look_for_other_solutions": True,
      "estimate_path_error": True, "stabilization": {"viscous": {"ratio": 1e-6}}}),
    (("path control", "multipliers in an outer loop", "contact with itself"),
     {"kinematics": "finite", "contact.0": {"name": "all", "between": "all", "enforce": {"uzawa": {}}},
      "steps.0.increments": {"auto": {"first": 1, "path_tolerance": 0.5}}}),
    (("adaptive meshing",),
     {"mesh.parameters": {"n_lower": 3, "n_upper": 5, "quads": 0, "structured": 0},
      "adapt": {"quantity": "energy_norm", "target_error": 0.5, "max_passes": 1}}),
    (("bounds", "segments"), {"contact.0.enforce": {"vi": {}}, "contact.0.integration": {"segment": {}}}),
    (("dual basis",), {"contact.0.enforce": {"semismooth": {"basis": "dual"}}}),
)
CONTACT = r"Contact(Form|Points|Search)::|MasterSurface::|peak_deviation"

# All that a deck can say of effects without having any.
OFF = {"kinematics": "small", "estimate_path_error": False, "look_for_other_solutions": False, "figures": {},
       "body_force": {}, "mesh.refine": 0, "materials.soft.density": 0}
OFF_OF_PAIRS = {"contact.0.projection": {"closest_point": {}}}


COMPUTES = re.compile(r"/lib(petsc|dmumps|mumps|pord|openblas|blas|lapack|gmsh|hdf5|metis)|/amontons")


def counted(path):
    """(instructions by function where it is computed, allocations, instructions of all) of a callgrind file."""
    names, own, allocations, total = {}, Counter(), 0, 0
    library = function = called = ""
    skip = False

    def name_of(text):
        number, _, name = text.partition(" ")
        return names.setdefault((kind, number), name) if name else names[kind, number]

    with open(path, encoding="utf-8") as file:
        for line in file:
            key, is_key, value = line.rstrip("\n").partition("=")
            kind = {"cob": "ob", "cfn": "fn"}.get(key, key)
            if key.startswith("totals:"):
                total = int(key.split()[1])
            if is_key and key == "ob":
                library = name_of(value)
            elif is_key and key == "fn":
                function = name_of(value)
            elif is_key and key in ("cfn", "cob"):
                name = name_of(value)
                called = name if key == "cfn" else called
            elif key == "calls":
                if called in ("malloc", "calloc", "operator new(unsigned long)"):
                    allocations += int(value.split()[0])
                skip = True  # the next line has the cost of what was called
            elif line[0] in "0123456789+-*":
                if not skip and COMPUTES.search(library):
                    own[function] += int(line.split()[1])
                skip = False
    return own, allocations, total


class Run:
    """What a run of a deck with `options.program` took."""

    def __init__(self, options, folder, deck):
        path, counts, objects = (folder / name for name in ("deck.yaml", "callgrind.out", "objects.txt"))
        path.write_text(yaml.safe_dump(deck, sort_keys=False), encoding="utf-8")
        done = subprocess.run([options.valgrind, "--tool=callgrind", f"--callgrind-out-file={counts}", options.program,
                               str(path), "--out", str(folder / "results"), "-log_view", f"ascii:{objects}"],
                              capture_output=True, text=True, check=False,
                              env={**os.environ, "OPENBLAS_NUM_THREADS": "1"})
        if done.returncode not in (0, 4):
            sys.exit(f"the run under valgrind ended with {done.returncode}\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
        self.own, self.allocations, self.total = counted(counts)
        self.instructions = sum(self.own.values())
        self.unknowns = json.loads((folder / "results/summary.json").read_text(encoding="utf-8"))["scene"]["unknowns"]
        table = objects.read_text(encoding="utf-8").partition("Object Type")[2]
        self.objects = {name: int(made) for name, made in re.findall(r"^ +(\S.*?) {2,}(\d+) +\d+$", table, re.MULTILINE)}

    def inside(self, functions):
        """Instructions in the program's own functions of this description."""
        pattern = re.compile(r"amontons::.*(" + functions + ")")
        reading = re.compile(r"Rule<|Reading|DeckNode")
        return sum(count for name, count in self.own.items() if pattern.search(name) and not reading.search(name))


def minimal(pairs=True):
    deck = load_deck("patch_2d")
    deck["mesh"]["file"] = str(TOP / "inputs/patch_2d/patch_2d.geo")
    set_key(deck, "mesh.parameters.n_upper", 5)
    deck["contact"][0].pop("integration")
    if not pairs:
        del deck["contact"]
        deck["boundary"].append({"on": "upper_bottom", "displacement": {"y": 0}})
    return deck


def changed(deck, changes):
    deck = copy.deepcopy(deck)
    for path, value in changes.items():
        set_key(deck, path, value)
    return deck


def compare(score, options, folder, deck, off, effects):
    plain, written = Run(options, folder, deck), Run(options, folder, changed(deck, off))
    print(f"     {plain.instructions} and {written.instructions} instructions of {plain.total} and {written.total}, "
          f"{plain.allocations} and {written.allocations} allocations, {sum(plain.objects.values())} PETSc objects")
    score.expect("instructions and objects were counted", plain.instructions > 1e7 and plain.allocations > 1e4
                 and plain.objects.get("SNES") == 1, (plain.instructions, plain.allocations, plain.objects))
    score.expect("no more unknowns", plain.unknowns == written.unknowns, (plain.unknowns, written.unknowns))
    score.expect("no more PETSc objects", plain.objects == written.objects, (plain.objects, written.objects))
    for what, words in (("instructions", "instructions that compute"), ("total", "instructions of the whole process"),
                        ("allocations", "allocations")):
        ratio = getattr(written, what) / getattr(plain, what)
        score.expect(f"as many {words} within 1 %: {100 * (ratio - 1):+.2f} %", abs(ratio - 1.0) < 0.01)
    for name, functions in effects.items():
        for run in (plain, written):
            found = run.inside(functions)
            score.expect(f"nothing of {name} has run", found == 0, found)


def off(score, options, folder):
    compare(score, options, folder, minimal(), {**OFF, **OFF_OF_PAIRS}, EFFECTS)


def elastic(score, options, folder):
    compare(score, options, folder, minimal(pairs=False), OFF,
            {"contact": CONTACT, **EFFECTS})


def on(score, options, folder):
    seen = {"contact": Run(options, folder, minimal()).inside(CONTACT)}
    for names, changes in ON:
        run = Run(options, folder, changed(minimal(), changes))
        seen.update({name: run.inside(EFFECTS[name]) for name in names})
    for name, found in seen.items():
        score.expect(f"{name} can be seen: {found} instructions", found > 0)
    score.expect("every effect was switched on", set(seen) == {"contact", *EFFECTS}, set(EFFECTS) - set(seen))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    cases = {"off": off, "elastic": elastic, "on": on}
    parser.add_argument("case", choices=cases)
    parser.add_argument("--program", required=True)
    parser.add_argument("--valgrind", default="valgrind")
    options = parser.parse_args()
    score = Score()
    with tempfile.TemporaryDirectory() as folder:
        cases[options.case](score, options, Path(folder))
    return score.status()


if __name__ == "__main__":
    sys.exit(main())
