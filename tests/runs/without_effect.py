#!/usr/bin/python3
"""An effect costs nothing where a deck does not ask for it: without_effect.py [EFFECT ...] [--together] [--edits]

Copies the sources, builds the program, and counts the instructions and allocations of a run of hertz_2d that asks for none
of the effects (valgrind's callgrind; everything is counted: start-up, MPI, libc, reading the deck). Then takes the effects
out of the sources, one at a time, as effect_cuts.py says, builds the program that is left, and counts the same run of it.
The two must agree within a hundredth, as must the instructions in the program and the libraries that compute alone, which
leaves out the start-up of MPI; and no function of the effect may be left in the program.

--together: takes the effects out all at once, which takes one build; then all of them together may take a hundredth of the
instructions, and each a hundredth of the allocations. --edits: only sees that all edits can still be made. Without names:
all effects. A table comes last.
"""
import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import yaml

TOP = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(TOP / "scripts"), str(TOP / "tests/scenes"), str(TOP / "tests/support")]
from effect_cuts import CUTS  # noqa: E402
from harness import load_deck, set_key  # noqa: E402
from instructions import Run  # noqa: E402
from score import Score  # noqa: E402

PARTS = ("CMakeLists.txt", "CMakePresets.json", "app", "lib")


def plain_deck():
    """Elastic, frictionless, small kinematics, one pair, one increment; 2,300 unknowns."""
    deck = load_deck("hertz_2d")
    deck["mesh"]["file"] = str(TOP / "inputs/hertz_2d/hertz_2d.geo")
    set_key(deck, "mesh.parameters.h", 0.1)
    set_key(deck, "steps.0.increments", 1)
    return deck


class Sources:
    """A copy of the sources, with one effect at a time out of it."""

    def __init__(self, folder):
        self.top, self.changed = folder / "sources", []
        self.build = self.top / ".build/release"  # as of the sources' own preset: what ccache has of that serves here, too
        self.top.mkdir()
        for part in PARTS:
            if (TOP / part).is_dir():
                shutil.copytree(TOP / part, self.top / part)
            else:
                shutil.copy2(TOP / part, self.top / part)
        (self.top / "tests").mkdir()
        (self.top / "tests/CMakeLists.txt").touch()
        shutil.copy2(TOP / "tests/runs/absent.hpp", self.top / "lib/base/absent.hpp")

    def restore(self):
        for name in self.changed:
            shutil.copy(TOP / name, self.top / name)  # with the time of now: it is to be compiled again
        self.changed = []

    def cut(self, effects):
        """Takes effects out; stops where an edit finds nothing to change."""
        for effect in effects:
            for name in CUTS[effect].sources:
                if not (self.top / name).is_file():
                    sys.exit(f"{effect}: there is no {name} to take out. Bring effect_cuts.py up to date.")
                self.write(name, "")
            for name, pattern, new in CUTS[effect].edits:
                text = (self.top / name).read_text(encoding="utf-8")
                text, count = re.subn(pattern, new, text, flags=re.MULTILINE | re.DOTALL)
                if count == 0:
                    sys.exit(f"{effect}: nothing in {name} matches\n  {pattern}\nBring effect_cuts.py up to date.")
                self.write(name, text if name in self.changed else '#include "base/absent.hpp"\n' + text)

    def write(self, name, text):
        (self.top / name).write_text(text, encoding="utf-8")
        if name not in self.changed:
            self.changed.append(name)

    def program(self):
        """Builds what there is."""
        environment = {**os.environ, "CCACHE_BASEDIR": str(self.top), "CCACHE_NOHASHDIR": "1"}
        commands = [["cmake", "--build", self.build, "--target", "amontons"]]
        if not self.build.exists():
            commands.insert(0, ["cmake", "-S", self.top, "-B", self.build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release"])
        for command in commands:
            done = subprocess.run(command, capture_output=True, text=True, check=False, env=environment)
            if done.returncode:
                sys.exit(f"{' '.join(map(str, command))} failed\n{done.stdout[-6000:]}{done.stderr[-2000:]}")
        return self.build / "amontons"


def functions_left(program, pattern):
    """Functions of the program that fit the pattern, by their demangled names."""
    names = subprocess.run(["nm", "-C", "--defined-only", program], capture_output=True, text=True, check=True).stdout
    code = re.findall(r"^[0-9a-f]+ [tTwWuV] (amontons::.*)$", names, re.MULTILINE)
    if len(code) < 500:
        sys.exit(f"{program} names {len(code)} functions only: it cannot be seen what is in it")
    return [name for name in code if re.search(pattern, name)]


def counted_run(valgrind, program, folder):
    folder.mkdir()
    return Run(argparse.Namespace(valgrind=valgrind, program=str(program)), folder, plain_deck())


def per_cent(run, plain, what):
    return 100.0 * (getattr(plain, what) / getattr(run, what) - 1.0)


def compare(score, sources, groups, options):
    """`groups`: effects that are taken out at the same time."""
    folder = sources.top.parent
    program = sources.program()
    present = {effect: len(functions_left(program, CUTS[effect].functions)) for group in groups for effect in group}
    plain = counted_run(options.valgrind, program, folder / "with")
    score.expect("the run was counted", plain.total > plain.instructions > 1e8 and plain.allocations > 1e5,
                 (plain.total, plain.instructions, plain.allocations))
    rows = [f"with all of them: {plain.total} instructions, {plain.instructions} of them in the program and in what "
            f"computes for it, {plain.allocations} allocations, {sum(plain.unknowns.values())} unknowns",
            "| effect | functions taken out | instructions | of the program | allocations |", "|---|---|---|---|---|"]
    for number, group in enumerate(groups):
        title = ", ".join(group)
        sources.cut(group)
        program = sources.program()
        for effect in group:
            left = functions_left(program, CUTS[effect].functions)
            score.expect(f"{effect}: its functions were there", present[effect] > 0)
            score.expect(f"{effect}: none is left", not left, left)
        run = counted_run(options.valgrind, program, folder / f"without_{number}")
        sources.restore()
        score.expect(f"{title}: the same unknowns", run.unknowns == plain.unknowns, (run.unknowns, plain.unknowns))
        costs = [per_cent(run, plain, what) for what in ("total", "instructions", "allocations")]
        bounds = (("instructions", 1.0), ("instructions of the program", 1.0), ("allocations", 1.0 * len(group)))
        for (what, bound), cost in zip(bounds, costs):
            score.expect(f"{title}: with it, {what} within {bound:g} %: {cost:+.3f} %", abs(cost) < bound)
        functions = sum(present[effect] for effect in group)
        rows.append(f"| {title} | {functions} | " + " | ".join(f"{cost:+.3f} %" for cost in costs) + " |")
        print(rows[-1], flush=True)
    print("\n".join(rows))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("effects", nargs="*", metavar="EFFECT", help=", ".join(CUTS))
    parser.add_argument("--together", action="store_true")
    parser.add_argument("--edits", action="store_true")
    parser.add_argument("--valgrind", default="valgrind")
    options = parser.parse_args()
    unknown = set(options.effects) - set(CUTS)
    if unknown:
        parser.error(f"no such effect: {', '.join(unknown)}. There are: {', '.join(CUTS)}")
    score, effects = Score(), options.effects or list(CUTS)
    with tempfile.TemporaryDirectory() as folder:
        sources = Sources(Path(folder))
        if not options.edits:
            compare(score, sources, [effects] if options.together else [[effect] for effect in effects], options)
        for effect in effects if options.edits else ():
            sources.cut([effect])
            score.expect(f"{effect} can be taken out", bool(sources.changed))
            sources.restore()
    return score.status()


if __name__ == "__main__":
    sys.exit(main())
