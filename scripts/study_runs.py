"""Runs the variants of a study, each as a process of its own, and keeps a record of every finished run.

Folder of a study: variants/ID/{deck.yaml, run_1.json, run_2.json, ..., results/}. A record is written, whole, only when
its run has come to an end, so an interrupted study goes on with what is missing; `results` are those of the first run.
"""

import copy
import hashlib
import json
import os
import random
import re
import shlex
import shutil
import signal
import subprocess
import time
from pathlib import Path

import yaml

from deck_edit import StudyError
from study_file import setting_text

POLL_SECONDS = 0.05
WORDS = {0: "certified", 2: "refused", 3: "not converged", 4: "not certified", 5: "interrupted"}


class Interrupted(Exception):
    """The study was asked to stop."""


def file_hash(path):
    digest = hashlib.sha256()
    with open(path, "rb") as file:
        while block := file.read(1 << 20):
            digest.update(block)
    return digest.hexdigest()[:16]


def mpi_environment():
    """The environment of runs: one thread a rank, and leave for root, which Open MPI wants to be given."""
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
    if os.geteuid() == 0:
        environment.update(OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
    return environment


def read_schema(program):
    """What the program says of its decks. Errors: StudyError when it cannot be run."""
    try:
        done = subprocess.run([program, "schema"], capture_output=True, text=True, env=mpi_environment(), check=False)
        return json.loads(done.stdout)
    except (OSError, ValueError) as error:
        raise StudyError(f"the program {program} cannot be run ({error}). Build it (scripts/demo does) or name another "
                         "one with --program.") from error


def descendants(pid):
    """`pid` and all processes below it that are alive."""
    found = [pid]
    for process in found:
        try:
            for task in os.listdir(f"/proc/{process}/task"):
                with open(f"/proc/{process}/task/{task}/children", encoding="ascii") as file:
                    found += [int(child) for child in file.read().split()]
        except OSError:
            continue  # it ended meanwhile
    return found


def resident_bytes(pids):
    """Resident memory of processes together, shared libraries counted for each, as runs count it in their summaries."""
    total = 0
    for pid in pids:
        try:
            with open(f"/proc/{pid}/statm", encoding="ascii") as file:
                total += int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")
        except OSError:
            continue
    return total


def available_bytes():
    with open("/proc/meminfo", encoding="ascii") as file:
        return next(1024 * int(line.split()[1]) for line in file if line.startswith("MemAvailable:"))


def stop(process):
    """Ends a run and everything that it has started."""
    pids = descendants(process.pid)
    for number, patience in ((signal.SIGTERM, 3.0), (signal.SIGKILL, 10.0)):
        for pid in pids:
            try:
                os.kill(pid, number)
            except ProcessLookupError:
                continue
        deadline = time.monotonic() + patience
        while time.monotonic() < deadline and process.poll() is None:
            time.sleep(POLL_SECONDS)
        if process.poll() is not None:
            return


def last_words(log):
    """What a run said when it failed: its errors, else the last increment that it did not reach, else its last line.
    What mpirun adds stands behind a line of dashes."""
    text = log.read_text(encoding="utf-8", errors="replace")
    own = re.split(r"^-{20,}$", text, maxsplit=1, flags=re.MULTILINE)[0]
    lines = [line.strip() for line in (own if own.strip() else text).splitlines() if line.strip(" -\n")]
    errors = [line for line in lines if line.startswith("error:")]
    missed = [line for line in lines if " not reached: " in line]
    return " ".join(errors[:3]) if errors else (missed or lines or [""])[-1]


class Runs:
    """The runs of one study: where they are kept, and how they are made."""

    def __init__(self, folder, program, mpirun, time_limit, memory_limit):
        """`memory_limit` in MB over all ranks; None: four fifths of what is free when a run begins."""
        self.folder, self.program, self.mpirun = Path(folder), str(program), shlex.split(mpirun)
        self.time_limit, self.memory_limit = time_limit, memory_limit
        if not self.mpirun or shutil.which(self.mpirun[0]) is None:
            raise StudyError(f"'{mpirun}' cannot be run: there is no such program. Name it with --mpirun.")
        self.program_hash = file_hash(program)
        self.wish_to_stop = False

    def deck_text(self, variant, deck_folder):
        """The deck of a variant as a file anywhere: its mesh is named by its full path."""
        deck = copy.deepcopy(variant.deck)
        mesh = deck.get("mesh")
        if isinstance(mesh, dict) and isinstance(mesh.get("file"), str):
            mesh["file"] = str((Path(deck_folder) / mesh["file"]).resolve())
        return yaml.safe_dump(deck, sort_keys=False, allow_unicode=True)

    def place(self, variant, deck_folder):
        """The folder of a variant: what distinguishes it in words, and a hash of all that its runs depend on."""
        text = self.deck_text(variant, deck_folder)
        mesh = yaml.safe_load(text).get("mesh")
        mesh_file = mesh.get("file") if isinstance(mesh, dict) else None
        content = file_hash(mesh_file) if mesh_file and os.path.isfile(mesh_file) else ""
        digest = hashlib.sha256(f"{text}|{variant.ranks}|{content}|{self.program_hash}".encode()).hexdigest()[:10]
        words = re.sub(r"[^A-Za-z0-9.]+", "_", setting_text(variant.knobs)).strip("_")[:50]
        return self.folder / "variants" / f"{words}-{digest}"

    def records(self, place):
        """Finished runs of a variant, repetition -> record. A damaged record counts as none."""
        found = {}
        for path in sorted(place.glob("run_*.json")):
            try:
                found[int(path.stem[4:])] = json.loads(path.read_text(encoding="utf-8"))
            except ValueError:
                continue
        return found

    def check(self, variant, deck_folder):
        """Asks `amontons check` whether the deck is right. Errors: StudyError with what it says."""
        place = self.place(variant, deck_folder)
        if (place / "checked").exists():
            return
        place.mkdir(parents=True, exist_ok=True)
        deck = place / "deck.yaml"
        deck.write_text(self.deck_text(variant, deck_folder), encoding="utf-8")
        done = subprocess.run([self.program, "check", str(deck)], capture_output=True, text=True, check=False,
                              env=mpi_environment())
        if done.returncode == 2:
            text = done.stderr.strip().replace(str(deck), "the deck")
            shutil.rmtree(place)
            raise StudyError(f"the deck with {setting_text(variant.knobs)} is wrong:\n{text}")
        (place / "checked").write_text(done.stdout, encoding="utf-8")

    def checked_unknowns(self, variant, deck_folder):
        """The unknowns that `amontons check` has counted for a variant; None when it was not asked."""
        try:
            text = (self.place(variant, deck_folder) / "checked").read_text(encoding="utf-8")
        except OSError:
            return None
        found = re.search(r"unknowns (\d+)", text)
        return int(found[1]) if found else None

    def attempt(self, variant, folder):
        """One run in `folder`; returns its exit status (None: ended by us), outcome, message and wall seconds."""
        limit = 1e6 * self.memory_limit if self.memory_limit else 0.8 * available_bytes()
        command = [*self.mpirun, "-n", str(variant.ranks), self.program, str(folder.parent / "deck.yaml"), "--out",
                   str(folder / "results")]
        started = time.monotonic()
        with open(folder / "output.txt", "w", encoding="utf-8") as output:
            process = subprocess.Popen(command, stdout=output, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL,
                                       env=mpi_environment(), start_new_session=True)
            try:
                while process.poll() is None:
                    time.sleep(POLL_SECONDS)
                    if self.wish_to_stop:
                        raise Interrupted
                    if time.monotonic() - started > self.time_limit:
                        stop(process)
                        return None, "timed out", f"after {self.time_limit:g} s", time.monotonic() - started
                    used = resident_bytes(descendants(process.pid))
                    if used > limit:
                        stop(process)
                        text = f"{used / 1e6:.0f} MB are more than the limit of {limit / 1e6:.0f} MB"
                        return None, "out of memory", text, time.monotonic() - started
            except BaseException:
                stop(process)
                raise
        wall = time.monotonic() - started
        status = process.returncode
        word = WORDS.get(status, "crashed")
        text = "" if status in (0, 4) else last_words(folder / "output.txt")
        said = (folder / "output.txt").read_text(encoding="utf-8", errors="replace")
        if word == "crashed" and re.search(r"out of memory|bad_alloc|signal 9", said, re.IGNORECASE):
            word = "out of memory"
        return status, word, text, wall

    def run(self, variant, repetition, deck_folder):
        """Runs a variant once and keeps the record; returns it. Errors: Interrupted, with nothing kept."""
        place = self.place(variant, deck_folder)
        place.mkdir(parents=True, exist_ok=True)
        (place / "deck.yaml").write_text(self.deck_text(variant, deck_folder), encoding="utf-8")
        # A folder of its own: what an earlier, broken attempt may still write goes elsewhere.
        for left in place.glob("attempt_*"):
            shutil.rmtree(left, ignore_errors=True)
        folder = place / f"attempt_{os.getpid()}_{repetition}"
        folder.mkdir()
        load = os.getloadavg()[0]
        try:
            status, word, text, wall = self.attempt(variant, folder)
            record = {"repetition": repetition, "exit_status": status, "outcome": word, "message": text,
                      "wall_seconds": wall, "load_average": load}
            try:
                summary = json.loads((folder / "results" / "summary.json").read_text(encoding="utf-8"))
                record["cpu_seconds"] = summary["resources"]["cpu_seconds"]
                record["peak_memory_bytes"] = summary["resources"]["peak_memory_bytes"]
            except (OSError, ValueError, KeyError):
                if word in ("certified", "not certified"):
                    record.update(outcome="crashed", message="it left no summary.json that can be read")
            if not (place / "results").exists() and (folder / "results").exists():
                (folder / "results").rename(place / "results")
            half = place / f"run_{repetition}.part"
            half.write_text(json.dumps(record, indent=1), encoding="utf-8")
            half.rename(place / f"run_{repetition}.json")
        finally:
            shutil.rmtree(folder, ignore_errors=True)
        return record

    def mention_others(self, variants, deck_folder, say):
        """Says when there are folders of runs that are none of these."""
        places = [self.place(variant, deck_folder) for variant in variants]
        others = {path for path in (self.folder / "variants").glob("*") if path not in places}
        if others:
            say(f"{len(others)} folders in {self.folder / 'variants'} are of other decks, meshes or builds of the "
                "program, and are left alone")

    def all(self, variants, repetitions, seed, deck_folder, say):
        """Runs what has not been run, in random order. A variant that fails is not repeated."""
        order = [(variant, repetition) for variant in variants for repetition in range(1, repetitions + 1)]
        random.Random(seed).shuffle(order)
        places = [self.place(variant, deck_folder) for variant in variants]
        kept = {id(variant): self.records(place) for variant, place in zip(variants, places)}
        missing = [(variant, repetition) for variant, repetition in order if repetition not in kept[id(variant)]]
        if len(missing) < len(order):
            say(f"{len(order) - len(missing)} of {len(order)} runs are there from before")
        for at, (variant, repetition) in enumerate(missing, 1):
            records = kept[id(variant)]
            if any(record["outcome"] not in ("certified", "not certified") for record in records.values()):
                continue
            record = self.run(variant, repetition, deck_folder)
            records[repetition] = record
            cpu = f"{record['cpu_seconds']:.2f} s CPU" if "cpu_seconds" in record else f"{record['wall_seconds']:.2f} s"
            say(f"[{at}/{len(missing)}] {setting_text(variant.knobs)}: {record['outcome']}, {cpu}"
                + (f" ({record['message'][:160]})" if record["message"] else ""))
        return places
