#!/usr/bin/python3
"""Runs one case of one scene and compares it with closed forms: check.py SCENE CASE --program PATH [--ranks N].

Without CASE: every case of the scene. Without SCENE: the list. Exit status 1 when a check fails or none was made.
"""
import argparse
import sys
import tempfile
from pathlib import Path

import adapt_cases
import block_cases
import condensed_cases
import finite_contact_cases
import forming_cases
import friction_cases
import hertz_cases
import obstacle_cases
import other_cases
import patch_cases
import self_contact_cases
import solid_cases
import solver_cases
import vi_cases
from harness import Bench

CASES = {
    **patch_cases.CASES,
    **hertz_cases.CASES,
    **other_cases.CASES,
    **friction_cases.CASES,
    **block_cases.CASES,
    **solid_cases.CASES,
    **vi_cases.CASES,
    **obstacle_cases.CASES,
    **adapt_cases.CASES,
    **finite_contact_cases.CASES,
    **forming_cases.CASES,
    **solver_cases.CASES,
    **self_contact_cases.CASES,
}
for scene, case in vi_cases.VI.items():
    CASES[scene]["vi"] = case
for scene, case in vi_cases.UNLOAD.items():
    CASES[scene]["vi_unload"] = case
for scene, cases in condensed_cases.SCENES.items():
    CASES[scene].update(cases)
CASES["hertz_3d"]["multigrid"] = vi_cases.multigrid_on_graded_cells
CASES["hertz_3d"]["estimates"] = vi_cases.estimates_by_multigrid


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene", nargs="?", choices=sorted(CASES))
    parser.add_argument("case", nargs="?")
    parser.add_argument("--program", help="the amontons executable")
    parser.add_argument("--mpirun", default="mpirun --oversubscribe --bind-to none", help="how ranks are started")
    parser.add_argument("--ranks", type=int, default=2)
    parser.add_argument("--keep", help="folder for the runs; default: a temporary one, removed at the end")
    options = parser.parse_args()
    if not options.scene:
        for scene, cases in CASES.items():
            print(scene, *cases)
        return 0
    if options.case and options.case not in CASES[options.scene]:
        parser.error(f"{options.scene} has the cases {', '.join(CASES[options.scene])}")
    if not options.program:
        parser.error("--program is needed to run a scene")

    with tempfile.TemporaryDirectory() as temporary:
        program = str(Path(options.program).resolve())
        bench = Bench(program, options.mpirun.split(), options.ranks, options.keep or temporary)
        for case in [options.case] if options.case else CASES[options.scene]:
            print(f"--- {options.scene} {case}", flush=True)
            CASES[options.scene][case](bench)
    print(f"{bench.num_checks} checks in {bench.num_runs} runs, {bench.num_failed} failed")
    return 0 if bench.num_checks and not bench.num_failed else 1


if __name__ == "__main__":
    sys.exit(main())
