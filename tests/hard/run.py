#!/usr/bin/python3
"""Runs the hard scenes: run.py --program PATH [--scenes NAME...] [--seeds N...] [--formulations NAME...] [--table].

Each scene runs with each of its formulations on meshes perturbed by each seed (0: not), on 1 rank for even seeds and on
2 for odd ones. A run is

  certified   status 0, and what must come out comes out
  refused     status 3 or 4 with a diagnosis in the log; for a scene without a solution that is the right answer
  wrong       anything else: another result, a crash, no end within the time limit

Exit status 0 when no run is wrong. --table prints Markdown.
"""
import argparse
import collections
import concurrent.futures
import os
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import yaml

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "scenes"))
from harness import Results  # noqa: E402
import finite_scenes  # noqa: E402, F401 (adds to the table)
from scenes import SCENES  # noqa: E402

SECONDS_HANGING = 600  # no run takes more than half a minute on a machine that is free
# Penalty lets bodies overlap by pressure x h / (alpha stiffness): with alpha = 30 up to a thirtieth of a body one cell thick.
PENALTY_TOLERANCE = 0.05
# `enforce` of the deck by the names of the table.
ENFORCE = {"semismooth": {"semismooth": {}}, "dual": {"semismooth": {"basis": "dual"}}, "uzawa": {"uzawa": {}}, "penalty": {"penalty": {}}, "vi": {"vi": {}}}
CERTIFIED, REFUSED, WRONG = "certified", "refused", "wrong"


@dataclass
class Outcome:
    scene: str
    formulation: str
    seed: int
    verdict: str
    words: str = ""
    newton: int = 0
    cutbacks: int = 0
    seconds: float = 0.0


def environment():
    found = {**os.environ, "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
    if os.geteuid() == 0:  # Open MPI refuses to run as root unless told that this is meant
        found.update(OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
    return found


def start(options, ranks, words):
    """Finished process of the program, one rank without mpirun."""
    mpirun = [*options.mpirun.split(), "-n", str(ranks)] if ranks > 1 else []
    command = [*mpirun, options.program, *map(str, words)]
    return subprocess.run(command, capture_output=True, text=True, errors="replace", env=environment(), timeout=SECONDS_HANGING, check=False)


def judge(scene, check, formulation, done, results):
    """Verdict and words on a finished run; `results` reads them."""
    if done.returncode in (3, 4):
        lines = [line.strip() for line in done.stdout.splitlines() if "not reached" in line or "certificate:" in line]
        if done.returncode == scene.status and scene.diagnosis not in done.stdout:
            return WRONG, f"refused without '{scene.diagnosis}'"
        return (REFUSED, lines[-1]) if lines else (WRONG, "refused without a diagnosis")
    if done.returncode != 0:
        return WRONG, f"exit status {done.returncode}: {done.stderr.strip()[-300:]}"
    if scene.status != 0:
        return WRONG, "a solution was certified where there is none"
    faults = []
    for what, error, tolerance in check(results()):
        limit = max(tolerance, PENALTY_TOLERANCE) if formulation == "penalty" else tolerance
        if not error <= limit:
            faults.append(f"{what}: off by {error:.3g}, allowed {limit:.3g}")
    return (WRONG, "; ".join(faults)) if faults else (CERTIFIED, "")


def run(options, name, formulation, seed, root):
    """Outcome of one run, in a folder of its own below root."""
    scene = SCENES[name]
    folder = Path(root) / f"{name}-{formulation}-{seed}"
    folder.mkdir(parents=True)
    mesh, whole, check = scene.make(seed)
    mesh.write(folder / "mesh.msh")
    for contact in whole["contact"]:
        contact["enforce"] = ENFORCE[formulation]
    path = folder / "deck.yaml"
    path.write_text(yaml.safe_dump(whole, sort_keys=False), encoding="utf-8")
    begun = time.monotonic()
    try:
        done = start(options, 1 + seed % 2, [path, "--out", folder / "results"])
    except subprocess.TimeoutExpired:
        return Outcome(name, formulation, seed, WRONG, f"no end within {SECONDS_HANGING} s")
    verdict, words = judge(scene, check, formulation, done, lambda: Results(whole, folder / "results"))
    outcome = Outcome(name, formulation, seed, verdict, words)
    outcome.seconds = time.monotonic() - begun
    try:
        summary = yaml.safe_load((folder / "results" / "summary.json").read_text(encoding="utf-8"))
        outcome.newton, outcome.cutbacks = summary["newton_iterations"], summary["cutbacks"]
    except OSError:
        pass
    return outcome


def table(outcomes):
    """Markdown: a line a scene; certified/refused/wrong of its runs, Newton iterations and cutbacks per formulation."""
    by_scene = collections.defaultdict(list)
    for outcome in outcomes:
        by_scene[outcome.scene].append(outcome)
    names = sorted({outcome.formulation for outcome in outcomes}, key=list(ENFORCE).index)
    print("| scene | certified / refused / wrong | " + " | ".join(names) + " | slowest s |")
    print("|---|---|" + "---|" * (len(names) + 1))
    for scene, runs in by_scene.items():
        counts = collections.Counter(outcome.verdict for outcome in runs)
        cells = []
        for name in names:
            mine = [outcome for outcome in runs if outcome.formulation == name]
            iterations = sorted({outcome.newton for outcome in mine})
            cuts = max((outcome.cutbacks for outcome in mine), default=0)
            marks = "".join({CERTIFIED: "", REFUSED: " R", WRONG: " W"}[outcome.verdict] for outcome in mine)
            span = f"{iterations[0]}-{iterations[-1]}" if len(iterations) > 1 else "".join(map(str, iterations))
            cells.append(span + (f", {cuts} cut" if cuts else "") + marks)
        print(f"| {scene} | {counts[CERTIFIED]} / {counts[REFUSED]} / {counts[WRONG]} | " + " | ".join(cells)
              + f" | {max(outcome.seconds for outcome in runs):.1f} |")
    print()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", required=True, help="the amontons executable")
    parser.add_argument("--mpirun", default="mpirun --oversubscribe --bind-to none", help="how ranks are started")
    parser.add_argument("--scenes", nargs="+", choices=list(SCENES), default=list(SCENES), metavar="NAME")
    parser.add_argument("--seeds", nargs="+", type=int, default=[0, 1, 2])
    parser.add_argument("--formulations", nargs="+", choices=list(ENFORCE), default=list(ENFORCE), metavar="NAME")
    parser.add_argument("--jobs", type=int, default=2, help="runs at a time")
    parser.add_argument("--table", action="store_true", help="Markdown instead of a line a run")
    parser.add_argument("--keep", help="folder for the runs; default: a temporary one, removed at the end")
    options = parser.parse_args()
    options.program = str(Path(options.program).resolve())
    jobs = [
        (name, formulation, seed)
        for name in options.scenes
        for formulation in SCENES[name].formulations
        if formulation in options.formulations
        for seed in options.seeds
    ]
    outcomes = []
    with tempfile.TemporaryDirectory() as temporary, concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        for outcome in pool.map(lambda job: run(options, *job, options.keep or temporary), jobs):
            outcomes.append(outcome)
            if not options.table:
                print(f"{outcome.verdict:9} {outcome.scene} {outcome.formulation} seed {outcome.seed}: newton "
                      f"{outcome.newton}, {outcome.cutbacks} cutbacks, {outcome.seconds:.1f} s {outcome.words}", flush=True)
    if options.table:
        table(outcomes)
        for outcome in outcomes:
            if outcome.verdict == WRONG or (outcome.verdict == REFUSED and SCENES[outcome.scene].status == 0):
                print(f"- {outcome.verdict}: {outcome.scene}, {outcome.formulation}, seed {outcome.seed}: {outcome.words}")
    counts = collections.Counter(outcome.verdict for outcome in outcomes)
    as_must = sum(outcome.verdict == REFUSED and SCENES[outcome.scene].status != 0 for outcome in outcomes)
    print(f"{len(outcomes)} runs of {len(options.scenes)} scenes: {counts[CERTIFIED]} certified, {as_must} without a solution "
          f"refused, {counts[REFUSED] - as_must} others refused, {counts[WRONG]} wrong")
    return 0 if outcomes and not counts[WRONG] else 1


if __name__ == "__main__":
    sys.exit(main())
