#!/usr/bin/python3
"""What may go wrong around a run: faults.py --program PATH [CASE...] [--count N].

killed       SIGKILL at a random moment, N times: what is there then restarts and ends like the uninterrupted run
rank_dies    SIGKILL for one of two ranks: the run ends, and restarts
full_disk    files that may not grow: status 2, the message asks for room, and the run restarts
memory       a factorization that gets too little: status 2, the estimate, what to change
unwritable   an output directory that cannot be made: status 2, and the message names it
checkpoints  N damaged checkpoints: refused with status 2, or harmless
decks        N damaged decks, and meshes: any status of the manual, within the time limit, never a crash
Random choices have fixed seeds. Exit status 0 when all goes as it must.
"""
import argparse
import concurrent.futures
import csv
import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import yaml
from run import SECONDS_HANGING, environment, start
from scenes import SCENES, confined_stack

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


class Cycle:
    """A run with friction that is long enough to be stopped on the way, and what it ends with when it is not."""

    def __init__(self, options, folder, score):
        def longer(deck):
            deck["steps"] = [{"name": "cycle", "to": 6, "increments": 36}]

        self.options, self.score = options, score
        self.deck = write(folder / "scene", "reversals", longer)
        whole = start(options, 1, [self.deck, "--out", folder / "whole"])
        score.expect("the uninterrupted run", whole.returncode == 0, whole.stdout)
        self.wanted = history(folder / "whole")[-1]
        self.forces = [key for key in self.wanted if key.startswith("reaction") or key.startswith("contact") and "force" in key]
        self.scale = max(abs(self.wanted[key]) for key in self.forces)

    def begin(self, out, ranks, rows):
        """A process with so many increments in its history, or one that has ended, and the numbers of its ranks."""
        mpirun = [*self.options.mpirun.split(), "-n", str(ranks)] if ranks > 1 else []
        # Writing beyond a limit is to be an error as on a full disk, and no signal.
        command = [*mpirun, "sh", "-c", 'trap "" XFSZ; exec "$@"', "sh", self.options.program, str(self.deck), "--out", str(out)]
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, env=environment(), text=True)
        file = out / "history.csv"
        while process.poll() is None and (not file.exists() or file.read_bytes().count(b"\n") <= rows):
            time.sleep(0.001)
        if ranks == 1 or process.poll() is not None:
            return process, [process.pid]
        children = Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text(encoding="utf-8").split()
        return process, [int(child) for child in children]

    def goes_on(self, name, out, ranks):
        """Restarted from its checkpoint, the run in the folder ends like the uninterrupted one."""
        done = start(self.options, ranks, [self.deck, "--out", out, "--restart", out / "checkpoint.h5"])
        self.score.expect(f"{name}: the restart ends with 0", done.returncode == 0, done.stdout[-500:] + done.stderr[-500:])
        if done.returncode == 0:
            rows = history(out)
            error = max(abs(rows[-1][key] - self.wanted[key]) for key in self.forces) / self.scale
            self.score.expect(f"{name}: same forces at the end", error <= 1e-10, f"off by {error:.1e}")
            self.score.expect(f"{name}: no increment is missing or doubled", len(rows) == 36, f"{len(rows)} rows")


def killed(options, folder, score):
    cycle, chance, while_running, restarted = Cycle(options, folder, score), random.Random(1), 0, 0
    for i in range(options.count):
        out = folder / f"killed_{i}"
        process, _ = cycle.begin(out, 1, chance.randint(1, 30))  # killed a moment after so many of the 36 increments
        time.sleep(chance.uniform(0, 0.02))
        while_running += process.poll() is None
        process.kill()
        process.communicate()
        if (out / "checkpoint.h5").exists():  # not there: killed before the first, and nothing is damaged
            restarted += 1
            cycle.goes_on(f"kill {i}", out, 1)
    score.expect("runs were killed while running", while_running > 0)
    print(f"killed: {while_running} of {options.count} runs were killed before their end, {restarted} had a checkpoint and were restarted")


def rank_dies(options, folder, score):
    """One rank of two is killed: the other ends, too, and the run goes on on one rank."""
    cycle, chance = Cycle(options, folder, score), random.Random(4)
    for i in range(2):
        out = folder / f"dead_{i}"
        process, numbers = cycle.begin(out, 2, chance.randint(5, 25))
        score.expect("there are two ranks", len(numbers) == 2, numbers)
        os.kill(numbers[i], signal.SIGKILL)
        try:
            process.communicate(timeout=SECONDS_HANGING)
        except subprocess.TimeoutExpired:
            process.kill()
        score.expect(f"rank {i} dies: the run ends, and not well", process.returncode not in (None, 0, *STATUSES), process.returncode)
        cycle.goes_on(f"rank {i} dies", out, 1)


def full_disk(options, folder, score):
    """No file may grow beyond a size (what the kernel says then is like a full disk, and needs no disk): status 2 and
    the reason; with room again the run goes on."""
    cycle = Cycle(options, folder, score)
    for i, (size, ranks) in enumerate([(8_000, 1), (60_000, 1), (60_000, 2), (150_000, 1)]):
        out, name = folder / f"full_{i}", f"{size} bytes on {ranks} ranks"
        process, numbers = cycle.begin(out, ranks, 1)
        for number in numbers:
            resource.prlimit(number, resource.RLIMIT_FSIZE, (size, size))
        _, said = process.communicate(timeout=SECONDS_HANGING)
        score.expect(f"{name}: status 2", process.returncode == 2, f"{process.returncode} {said[-500:]}")
        score.expect(f"{name}: says why", "Is the disk full?" in said, said[-500:])
        if (out / "checkpoint.h5").exists():
            cycle.goes_on(name, out, 1)


def memory(options, folder, score):
    """A factorization that gets less memory than it needs: status 2, the estimate, and what to change."""

    def run(name, words, mends, ranks=1, **shape):
        scene = folder / name
        scene.mkdir(parents=True)
        mesh, deck, _ = confined_stack(0, **shape)
        mesh.write(scene / "mesh.msh")
        (scene / "deck.yaml").write_text(yaml.safe_dump(deck, sort_keys=False), encoding="utf-8")
        done = start(options, ranks, [scene / "deck.yaml", "--out", scene / "results", *words])
        score.expect(f"{name}: status 2", done.returncode == 2, f"{done.returncode} {done.stderr[-500:]}")
        for word in ("ran out of memory", "MB in all", "-mat_mumps_icntl_22", mends):
            score.expect(f"{name}: says '{word}'", word in done.stderr, done.stderr[-500:])

    cells = ((60, 60), (40, 40))  # 11,000 unknowns: about 12 MB
    run("limit", ["-mat_mumps_icntl_23", "2"], "allows 2 MB", cells=cells)
    run("limit_on_2_ranks", ["-mat_mumps_icntl_23", "1"], "allows 1 MB", ranks=2, cells=cells)
    run("limit_of_kept_factors", ["-mat_mumps_icntl_23", "2", "-pc_type", "shell"], "allows 2 MB", cells=cells)
    run("nothing_to_spare", ["-mat_mumps_icntl_14", "-90"], "-mat_mumps_icntl_14")


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


CASES = {"killed": killed, "rank_dies": rank_dies, "full_disk": full_disk, "memory": memory, "unwritable": unwritable, "checkpoints": checkpoints, "decks": decks}


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
