#!/usr/bin/python3
"""Runs decks that must be refused and checks how they are refused.

    run.py PROGRAM MPIRUN RANKS [DECK_NAME...]

Every deck of decks/ begins with lines `# expect: TEXT`. For each the program must exit with status 2, print every
expected text to stderr, print nothing of a crash, print no message twice, be quick, and leave an existing output
directory as it was.
"""

import concurrent.futures
import functools
import os
import pathlib
import resource
import subprocess
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent
EXIT_STATUS = 2
# Of processor time beyond that of starting and ending the program, on 1 rank: the wall clock of a busy machine says
# nothing, and more ranks spin while they wait for the first.
SECONDS_ALLOWED = 1.0
SECONDS_HANGING = 60.0
CRASHES = ["PETSC ERROR", "Traceback", "MPI_ABORT", "Segmentation", "Caught signal", "terminate called", "Sanitizer"]


def expected_texts(deck):
    texts = []
    for line in deck.read_text().splitlines():
        if not line.startswith("# expect: "):
            break
        texts.append(line.removeprefix("# expect: "))
    return texts


def run_timed(command):
    """The finished process, its processor seconds (with all ranks), its wall seconds."""
    start, before = time.monotonic(), resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=SECONDS_HANGING)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    processor = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return done, processor, time.monotonic() - start


def faults_of(deck, command, limit):
    """What is wrong with the way the deck is refused, in words, and the processor and wall seconds it took."""
    expected = expected_texts(deck)
    if not expected:
        return [f"{deck.name} has no line '# expect: TEXT' at its top"], 0.0, 0.0
    with tempfile.TemporaryDirectory() as folder:
        sentinel = pathlib.Path(folder) / "fields.h5"
        sentinel.write_text("of an earlier run")
        done, processor, wall = run_timed([*command, str(deck), "--out", folder])
        faults = []
        if [path.name for path in pathlib.Path(folder).iterdir()] != ["fields.h5"]:
            faults.append("the output directory was written to")
        elif sentinel.read_text() != "of an earlier run":
            faults.append("an earlier result was overwritten")
    if done.returncode != EXIT_STATUS:
        faults.append(f"exit status {done.returncode}, not {EXIT_STATUS}")
    faults += [f"stderr lacks {text!r}" for text in expected if text not in done.stderr]
    faults += [f"the output has {crash!r}" for crash in CRASHES if crash in done.stderr + done.stdout]
    errors = [line for line in done.stderr.splitlines() if line.startswith("error: ")]
    if len(set(errors)) != len(errors):
        faults.append("a message is printed twice")
    if processor > limit:  # once more: on a machine that is overrun a single time says little
        with tempfile.TemporaryDirectory() as folder:
            processor = min(processor, run_timed([*command, str(deck), "--out", folder])[1])
    if processor > limit:
        faults.append(f"it took {processor:.1f} s of processor time, allowed are {limit:.1f} s")
    if faults:
        faults.append("stderr was:\n" + done.stderr.rstrip())
    return faults, processor, wall


def main():
    program, mpirun, ranks, names = sys.argv[1], sys.argv[2], int(sys.argv[3]), sys.argv[4:]
    decks = sorted((HERE / "decks").glob("*.yaml"))
    if names:
        decks = [deck for deck in decks if deck.stem in names]
    if not decks:
        sys.exit("no decks to run")
    # One rank needs no mpirun, and most of a refusal is waiting: more at a time than there are cores.
    command = [mpirun, "--oversubscribe", "--bind-to", "none", "-n", str(ranks), program] if ranks > 1 else [program]
    at_a_time = (os.cpu_count() or 1) * 2 // ranks
    starts = [run_timed([*command, "--version"]) for _ in range(2)]
    if any(done.returncode != 0 for done, _, _ in starts):
        sys.exit("the program does not start:\n" + starts[0][0].stderr)
    start = min(processor for _, processor, _ in starts)
    limit = start + SECONDS_ALLOWED if ranks == 1 else float("inf")
    failed = 0
    slowest = (0.0, 0.0, "")
    # Processes, because each counts its children's time.
    with concurrent.futures.ProcessPoolExecutor(at_a_time) as pool:
        results = pool.map(functools.partial(faults_of, command=command, limit=limit), decks)
        for deck, (faults, processor, wall) in zip(decks, results):
            slowest = max(slowest, (processor - start, wall, deck.name))
            if faults:
                failed += 1
                print(f"FAILED {deck.name}: " + "\n  ".join(faults))
    print(f"{len(decks) - failed} of {len(decks)} decks are refused as they must be on {ranks} rank(s); slowest "
          f"{slowest[2]}: {slowest[0]:.2f} s of processor time beyond the {start:.2f} s of starting, {slowest[1]:.2f} s "
          "by the clock")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
