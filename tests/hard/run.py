#!/usr/bin/python3
"""Runs the hard scenes: run.py --program PATH [--scenes NAME...] [--seeds N...] [--formulations NAME...] [--table] [--record FILE].

Each scene runs with each of its formulations on meshes perturbed by each seed (0: not), on 1 rank for even seeds and on
2 for odd ones. A run is

  certified   status 0, and what must come out comes out
  refused     status 3 or 4 with a diagnosis in the log; for a scene without a solution that is the right answer
  wrong       anything else: another result, a crash, no end within the time limit

Exit status 0 when no run is wrong. --table prints Markdown. --record keeps each run as it ends in a file of JSON lines,
and a call with the same file and the same program makes the missing runs only.
"""
import argparse
import collections
import concurrent.futures
import functools
import hashlib
import json
import os
import resource
import subprocess
import sys
import tempfile
from dataclasses import asdict, dataclass, field
from pathlib import Path

import yaml

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "scenes"))
from harness import Results  # noqa: E402
import finite_scenes  # noqa: E402, F401 (adds to the table)
from scenes import SCENES  # noqa: E402

# A rank that spins is ended by the first, as no run takes more than a minute of CPU; ranks that wait for ever by the second.
CPU_SECONDS_HANGING, SECONDS_HANGING = 600, 2400
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
    helped: dict = field(default_factory=dict)  # remedies by name: how many increments each has got through
    seconds: float = 0.0  # of CPU, all ranks and their start
    certificate: float = 0.0  # its share of the run's time


def environment():
    found = {**os.environ, "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
    if os.geteuid() == 0:  # Open MPI refuses to run as root unless told that this is meant
        found.update(OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
    return found


def start(options, ranks, words):
    """Finished process of the program, one rank without mpirun."""
    mpirun = [*options.mpirun.split(), "-n", str(ranks)] if ranks > 1 else []
    command = ["prlimit", f"--cpu={CPU_SECONDS_HANGING}", *mpirun, options.program, *map(str, words)]
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


def cpu_of_children():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def run(options, root, job):
    """Outcome of one run (scene, formulation, seed), in a folder of its own below root. One at a time in a process, whose
    children's time is that of the run."""
    name, formulation, seed = job
    scene = SCENES[name]
    folder = Path(root) / f"{name}-{formulation}-{seed}"
    folder.mkdir(parents=True, exist_ok=True)
    mesh, whole, check = scene.make(seed)
    mesh.write(folder / "mesh.msh")
    for contact in whole["contact"]:
        contact["enforce"] = ENFORCE[formulation]
    path = folder / "deck.yaml"
    path.write_text(yaml.safe_dump(whole, sort_keys=False), encoding="utf-8")
    before = cpu_of_children()
    try:
        done = start(options, 1 + seed % 2, [path, "--out", folder / "results"])
    except subprocess.TimeoutExpired:
        return Outcome(name, formulation, seed, WRONG, f"no end within {SECONDS_HANGING} s")
    verdict, words = judge(scene, check, formulation, done, lambda: Results(whole, folder / "results"))
    outcome = Outcome(name, formulation, seed, verdict, words)
    outcome.seconds = cpu_of_children() - before
    try:
        summary = json.loads((folder / "results" / "summary.json").read_text(encoding="utf-8"))
    except OSError:
        return outcome
    outcome.newton, outcome.cutbacks = summary["newton_iterations"], summary["cutbacks"]
    outcome.helped = {word: used["helped"] for word, used in summary["remedies"].items() if isinstance(used, dict) and used["helped"]}
    times = summary["resources"]
    outcome.certificate = times["phase_seconds"].get("certificate", 0.0) / times["wall_seconds"]
    return outcome


class Record:
    """The outcomes in a file: a line for the program, then one a run. Of another program, it is refused."""

    def __init__(self, path, program):
        self.path, self.outcomes = path, {}
        own = {"program": hashlib.sha256(Path(program).read_bytes()).hexdigest()}
        if path is None:
            return
        if not Path(path).exists():
            Path(path).write_text(json.dumps(own) + "\n", encoding="utf-8")
        first, *rest = map(json.loads, Path(path).read_text(encoding="utf-8").splitlines())
        if first != own:
            sys.exit(f"{path} has the runs of another program: give another file, or remove this one")
        for outcome in (Outcome(**line) for line in rest):
            self.outcomes[outcome.scene, outcome.formulation, outcome.seed] = outcome

    def add(self, outcome):
        self.outcomes[outcome.scene, outcome.formulation, outcome.seed] = outcome
        if self.path is not None:
            with open(self.path, "a", encoding="utf-8") as file:
                file.write(json.dumps(asdict(outcome)) + "\n")


def table(outcomes):
    """Markdown: a line a scene; certified/refused/wrong of its runs, Newton iterations and cutbacks per formulation, the
    increments that a remedy got through, CPU time of all its runs."""
    by_scene = collections.defaultdict(list)
    for outcome in outcomes:
        by_scene[outcome.scene].append(outcome)
    names = sorted({outcome.formulation for outcome in outcomes}, key=list(ENFORCE).index)
    print("| scene | certified / refused / wrong | " + " | ".join(names) + " | remedies | CPU s |")
    print("|---|---|" + "---|" * (len(names) + 2))
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
        helped = sum((collections.Counter(outcome.helped) for outcome in runs), collections.Counter())
        remedies = ", ".join(f"{word} {count}" for word, count in sorted(helped.items()))
        print(f"| {scene} | {counts[CERTIFIED]} / {counts[REFUSED]} / {counts[WRONG]} | " + " | ".join(cells)
              + f" | {remedies} | {sum(outcome.seconds for outcome in runs):.1f} |")
    print()


def certificate_share(outcomes):
    shares = sorted(outcome.certificate for outcome in outcomes)
    above = sum(share > 0.03 for share in shares)
    return f"certificate's share of a run's time: median {shares[len(shares) // 2]:.2%}, largest {shares[-1]:.2%}, above 3 % in {above}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", required=True, help="the amontons executable")
    parser.add_argument("--mpirun", default="mpirun --oversubscribe --bind-to none", help="how ranks are started")
    parser.add_argument("--scenes", nargs="+", choices=list(SCENES), default=list(SCENES), metavar="NAME")
    parser.add_argument("--seeds", nargs="+", type=int, default=[0, 1, 2])
    parser.add_argument("--formulations", nargs="+", choices=list(ENFORCE), default=list(ENFORCE), metavar="NAME")
    parser.add_argument("--jobs", type=int, default=2, help="runs at a time")
    parser.add_argument("--table", action="store_true", help="Markdown instead of a line a run")
    parser.add_argument("--record", help="file of the runs that are made already, and of these; default: none")
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
    record = Record(options.record, options.program)
    missing = [job for job in jobs if job not in record.outcomes]
    with tempfile.TemporaryDirectory() as temporary, concurrent.futures.ProcessPoolExecutor(options.jobs) as pool:
        pending = [pool.submit(functools.partial(run, options, options.keep or temporary), job) for job in missing]
        for done in concurrent.futures.as_completed(pending):
            outcome = done.result()
            record.add(outcome)
            if not options.table:
                print(f"{outcome.verdict:9} {outcome.scene} {outcome.formulation} seed {outcome.seed}: newton "
                      f"{outcome.newton}, {outcome.cutbacks} cutbacks, {outcome.seconds:.1f} s of CPU {outcome.words}", flush=True)
    outcomes = [record.outcomes[job] for job in jobs]
    if options.table:
        table(outcomes)
        for outcome in outcomes:
            if outcome.verdict == WRONG or (outcome.verdict == REFUSED and SCENES[outcome.scene].status == 0):
                print(f"- {outcome.verdict}: {outcome.scene}, {outcome.formulation}, seed {outcome.seed}: {outcome.words}")
        print(certificate_share(outcomes))
    counts = collections.Counter(outcome.verdict for outcome in outcomes)
    as_must = sum(outcome.verdict == REFUSED and SCENES[outcome.scene].status != 0 for outcome in outcomes)
    print(f"{len(outcomes)} runs of {len(options.scenes)} scenes: {counts[CERTIFIED]} certified, {as_must} without a solution "
          f"refused, {counts[REFUSED] - as_must} others refused, {counts[WRONG]} wrong")
    return 0 if outcomes and not counts[WRONG] else 1


if __name__ == "__main__":
    sys.exit(main())
