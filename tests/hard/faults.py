#!/usr/bin/python3
"""What may go wrong around a run: faults.py --program PATH [CASE...] [--count N].

killed       SIGKILL at a random moment, N times: what is there then restarts and ends like the uninterrupted run
unwritable   an output directory that cannot be made: status 2, and the message names it
checkpoints  N damaged checkpoints: refused with status 2, or harmless
decks        N damaged decks, and meshes: any status of the manual, within the time limit, never a crash
Random choices have fixed seeds. Exit status 0 when all goes as it must.
"""
import argparse
import concurrent.futures
import csv
import random
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import yaml
from run import SECONDS_HANGING, environment, start
from scenes import SCENES

# Status 1 is a fault of the program or of PETSc; a signal is negative, or 128 and more through mpirun.
STATUSES = (0, 2, 3, 4, 5)


class Score:
    def __init__(self):
        self.checks = self.failed = 0

    def expect(self, what, good, detail=""):
        self.checks += 1
        self.failed += not good
        if not good:
            print(f"FAIL {what} {detail}", flush=True)


def write(folder, name, change=None):
    """A hard scene as deck.yaml and mesh.msh in the folder."""
    folder.mkdir(parents=True)
    mesh, deck, _ = SCENES[name].make(0)
    if change:
        change(deck)
    mesh.write(folder / "mesh.msh")
    (folder / "deck.yaml").write_text(yaml.safe_dump(deck, sort_keys=False), encoding="utf-8")
    return folder / "deck.yaml"


def history(folder):
    with open(folder / "history.csv", encoding="utf-8", newline="") as file:
        return [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]


def killed(options, folder, score):
    def longer(deck):
        deck["steps"] = [{"name": "cycle", "to": 6, "increments": 36}]

    deck = write(folder / "scene", "reversals", longer)
    whole = start(options, 1, [deck, "--out", folder / "whole"])
    score.expect("the uninterrupted run", whole.returncode == 0, whole.stdout)
    wanted, chance = history(folder / "whole")[-1], random.Random(1)
    forces = [key for key in wanted if key.startswith(("reaction", "contact")) and "force" in key or key.startswith("reaction")]
    scale = max(abs(wanted[key]) for key in forces)
    while_running = 0
    for i in range(options.count):
        out = folder / f"killed_{i}"
        command = [options.program, str(deck), "--out", str(out)]
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env=environment())
        rows = chance.randint(1, 30)  # killed a moment after so many of the 36 increments
        while process.poll() is None and (not (out / "history.csv").exists() or (out / "history.csv").read_bytes().count(b"\n") <= rows):
            time.sleep(0.001)
        time.sleep(chance.uniform(0, 0.02))
        while_running += process.poll() is None
        process.kill()
        process.wait()
        if not (out / "checkpoint.h5").exists():  # killed before the first: nothing to go on from, nothing damaged
            continue
        done = start(options, 1, [deck, "--out", out, "--restart", out / "checkpoint.h5"])
        score.expect(f"kill {i}: the restart ends with 0", done.returncode == 0, done.stdout[-500:] + done.stderr[-500:])
        if done.returncode == 0:
            rows = history(out)
            error = max(abs(rows[-1][key] - wanted[key]) for key in forces) / scale
            score.expect(f"kill {i}: same forces at the end", error <= 1e-10, f"off by {error:.1e}")
            score.expect(f"kill {i}: no increment is missing or doubled", len(rows) == 36, f"{len(rows)} rows")
    score.expect("runs were killed while running", while_running > 0)
    print(f"killed: {while_running} of {options.count} runs were killed before their end")


def unwritable(options, folder, score):
    deck = write(folder / "scene", "press_at_once")
    (folder / "file").write_text("not a folder", encoding="utf-8")
    done = start(options, 1, [deck, "--out", folder / "file" / "results"])
    score.expect("a folder below a file: status 2", done.returncode == 2, f"{done.returncode} {done.stderr[-500:]}")
    score.expect("and the message names it", "file/results" in done.stderr, done.stderr[-500:])


def damaged(content, chance, words):
    """Bytes cut, doubled, flipped, or (with words) exchanged for others."""
    content = bytearray(content)
    for _ in range(chance.randint(1, 3)):
        at = chance.randrange(len(content)) if content else 0
        end = min(len(content), at + chance.randint(1, 40))
        kind = chance.randrange(5 if words else 4)
        if kind == 0:
            del content[at:end]
        elif kind == 1:
            content[at:at] = content[at:end]
        elif kind == 2 and content:
            content[at] ^= 1 << chance.randrange(8)
        elif kind == 3 and chance.random() < 0.3:
            del content[at:]
        elif kind == 4:
            tokens = bytes(content).split(b" ")
            tokens[chance.randrange(len(tokens))] = chance.choice(words)
            content = bytearray(b" ".join(tokens))
    return bytes(content)


WORDS = [b"-1", b"0", b"1e308", b"nan", b"inf", b"99999999999999999999", b"{}", b"[]", b"[", b"~", b"lower", b"''", b"\n", b"x", b"t/0", b"&a", b"*a"]


def crowd(options, score, jobs, statuses):
    """Runs (name, words) a few at a time; each must end in time with one of the statuses."""

    def one(job):
        name, words = job
        try:
            return name, start(options, 1, words)
        except subprocess.TimeoutExpired:
            return name, None

    counts = {}
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        for name, done in pool.map(one, jobs):
            status = done.returncode if done else f"none within {SECONDS_HANGING} s"
            counts[status] = counts.get(status, 0) + 1
            detail = done.stderr.strip()[-400:] if done else ""
            score.expect(f"{name}: status {status}", status in statuses, detail)
            if status == 2:
                score.expect(f"{name}: says why", "error: " in done.stderr, detail)
    return ", ".join(f"{count} with status {status}" for status, count in counts.items())


def checkpoints(options, folder, score):
    deck = write(folder / "scene", "reversals")
    done = start(options, 1, [deck, "--out", folder / "whole"])
    score.expect("the run itself", done.returncode == 0, done.stderr)
    content, chance, jobs = (folder / "whole" / "checkpoint.h5").read_bytes(), random.Random(2), []
    for i in range(options.count):
        path = folder / f"checkpoint_{i}.h5"
        path.write_bytes(damaged(content, chance, []))
        jobs.append((f"checkpoint {i}", [deck, "--out", folder / f"out_{i}", "--restart", path]))
    print("checkpoints:", crowd(options, score, jobs, (0, 2)))


def decks(options, folder, score):
    chance, jobs = random.Random(3), []
    for i in range(2 * options.count):
        path = write(folder / f"scene_{i}", chance.choice(["slide_mu_0.5", "press_at_once", "node_in_valley"]))
        target = path if i % 2 else path.with_name("mesh.msh")
        target.write_bytes(damaged(target.read_bytes(), chance, WORDS))
        jobs.append((f"{target.name} {i}", [path, "--out", folder / f"scene_{i}" / "results"]))
    print("decks and meshes:", crowd(options, score, jobs, STATUSES))


CASES = {"killed": killed, "unwritable": unwritable, "checkpoints": checkpoints, "decks": decks}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("cases", nargs="*", metavar="CASE", help=", ".join(CASES))
    parser.add_argument("--program", required=True, help="the amontons executable")
    parser.add_argument("--mpirun", default="mpirun --oversubscribe --bind-to none", help="how ranks are started")
    parser.add_argument("--count", type=int, default=10)
    parser.add_argument("--jobs", type=int, default=2, help="runs at a time")
    parser.add_argument("--keep", help="folder that failed runs can be looked at in; default: none")
    options = parser.parse_args()
    options.program = str(Path(options.program).resolve())
    score = Score()
    with tempfile.TemporaryDirectory() as temporary:
        for case in options.cases or CASES:
            folder = Path(options.keep or temporary) / case
            shutil.rmtree(folder, ignore_errors=True)
            CASES[case](options, folder, score)
    print(f"{score.checks} checks, {score.failed} failed")
    return 0 if score.checks and not score.failed else 1


if __name__ == "__main__":
    sys.exit(main())
