#!/usr/bin/python3
"""What a run does besides solving: restart on another number of ranks, interruption, exit statuses, earlier results."""
import argparse
import csv
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import yaml

TESTS = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(TESTS / "scenes"), str(TESTS / "support")]
from friction_runs import path_control, restart_of_friction  # noqa: E402
from harness import TOP, load_deck, set_key  # noqa: E402
from plastic_runs import restart_of_plasticity  # noqa: E402
from score import Score  # noqa: E402

HERTZ = "hertz_2d"
CHEAP = {"mesh.parameters.h": 0.1, "steps.0.increments": 4}


class Case(Score):
    """Decks and results of one case in a folder of its own."""

    def __init__(self, program, mpirun, folder):
        super().__init__()
        self.program, self.mpirun, self.folder = program, mpirun, Path(folder)
        self.environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1"}
        if os.geteuid() == 0:
            self.environment.update(OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")

    def deck(self, changes=None, name="deck"):
        deck = load_deck(HERTZ)
        deck["mesh"]["file"] = str((TOP / "inputs" / HERTZ / deck["mesh"]["file"]).resolve())
        for path, value in {**CHEAP, **(changes or {})}.items():
            set_key(deck, path, value)
        return self.write(deck, name)

    def write(self, deck, name):
        path = self.folder / f"{name}.yaml"
        path.write_text(yaml.safe_dump(deck, sort_keys=False), encoding="utf-8")
        return path

    def start(self, ranks, *words):
        command = [*self.mpirun, "-n", str(ranks), self.program, *map(str, words)]
        return subprocess.Popen(
            command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, env=self.environment
        )

    def run(self, ranks, *words):
        process = self.start(ranks, *words)
        text, _ = process.communicate(timeout=300)
        return process.returncode, text


def last_row(folder):
    with open(Path(folder) / "history.csv", encoding="utf-8", newline="") as file:
        return {key: float(value) for key, value in list(csv.DictReader(file))[-1].items()}


def same(a, b, tolerance=1e-8):
    keys = [key for key in a if key.startswith(("contact_", "reaction_")) and "penetration" not in key]
    scale = max(abs(a[key]) for key in keys)
    return all(abs(a[key] - b[key]) <= tolerance * max(abs(a[key]), 1e-3 * scale) for key in keys)


def restart(case):
    """Half of a run on one rank, the other half on two, equals the whole; for held and unknown multipliers."""
    for enforce in ({"semismooth": {}}, {"uzawa": {}}, {"vi": {}}):
        name = next(iter(enforce))
        whole, parts = case.folder / f"whole_{name}", case.folder / f"parts_{name}"
        deck = case.deck({"contact.0.enforce": enforce}, name)
        status, text = case.run(2, deck, "--out", whole)
        case.expect(f"{name}: the whole run ends with 0", status == 0, text)
        half = case.deck({"contact.0.enforce": enforce, "steps.0.to": 0.5, "steps.0.increments": 2}, f"{name}_half")
        status, text = case.run(1, half, "--out", parts)
        case.expect(f"{name}: the first half ends with 0", status == 0, text)
        # The second half belongs to the whole deck: its step is the one in progress.
        status, text = case.run(2, deck, "--out", parts, "--restart", parts / "checkpoint.h5")
        case.expect(f"{name}: the restart ends with 0", status == 0, text)
        case.expect(f"{name}: same forces and pressures", same(last_row(whole), last_row(parts)))
        with open(parts / "history.csv", encoding="utf-8") as file:
            case.expect(f"{name}: the history goes on where it was", len(file.readlines()) == 5)
        summaries = [json.loads((folder / "summary.json").read_text()) for folder in (whole, parts)]
        works = [summary["energy"]["external_work"] for summary in summaries]
        case.expect(f"{name}: the books go on", abs(works[0] - works[1]) <= 1e-8 * abs(works[0]), works)


def ranks_of(process):
    """Process numbers of the ranks that mpirun started."""
    children = Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text(encoding="utf-8").split()
    return [int(child) for child in children]


def interrupt(case):
    """SIGTERM or SIGINT: status 5 and a checkpoint; a restart from it ends like the uninterrupted run."""
    changes = {"steps.0.increments": 100, "mesh.parameters.h": 0.05}
    deck, whole = case.deck(changes), case.folder / "whole"
    status, text = case.run(2, deck, "--out", whole)
    case.expect("the whole run ends with 0", status == 0, text)
    for number in (signal.SIGTERM, signal.SIGINT):
        name, out = number.name, case.folder / number.name
        process = case.start(2, deck, "--out", out)
        deadline = time.time() + 120
        while time.time() < deadline and not (out / "checkpoint.h5").exists():
            time.sleep(0.005)
        # To the ranks themselves, as a batch system does: mpirun would answer by killing them soon after.
        for rank in ranks_of(process):
            os.kill(rank, number)
        text, _ = process.communicate(timeout=120)
        case.expect(f"{name}: the run ends with 5", process.returncode == 5, f"{process.returncode}\n{text}")
        summary = json.loads((out / "summary.json").read_text())
        case.expect(f"{name}: so says the summary", summary["status"] == 5, summary)
        case.expect(f"{name}: it stopped before the end", summary["time"] < 1.0, summary["time"])
        status, text = case.run(1, deck, "--out", out, "--restart", out / "checkpoint.h5")
        case.expect(f"{name}: the restart ends with 0", status == 0, text)
        case.expect(f"{name}: same forces and pressures", same(last_row(whole), last_row(out)))
        with open(out / "history.csv", encoding="utf-8") as file:
            case.expect(f"{name}: no increment is missing or doubled", len(file.readlines()) == 101)


def statuses(case):
    """3: not converged; 4: converged but not certified; results of an earlier run move away whole, foreign files stay."""
    out = case.folder / "out"
    status, text = case.run(2, case.deck(), "--out", out)
    case.expect("a good run ends with 0", status == 0, text)
    (out / "notes.txt").write_text("mine", encoding="utf-8")
    first = (out / "summary.json").read_text(encoding="utf-8")

    status, text = case.run(2, case.deck({"contact.0.enforce": "nonsense"}, "wrong"), "--out", out)
    case.expect("a wrong deck ends with 2", status == 2, text)
    case.expect("and leaves earlier results alone", (out / "summary.json").read_text(encoding="utf-8") == first)

    status, text = case.run(2, case.deck({"contact.0.enforce": {"penalty": {}}, "certificate.penetration": 1e-7}), "--out", out)
    case.expect("a certificate that fails ends with 4", status == 4, text)
    case.expect("and names the item", "penetration is" in text, text)
    case.expect("earlier results moved as a whole", (out / "previous" / "summary.json").read_text(encoding="utf-8") == first)
    names = {"fields.h5", "fields.xdmf", "history.csv", "summary.json", "checkpoint.h5", "log.txt"}
    case.expect("all of them", names <= {path.name for path in (out / "previous").iterdir()})
    case.expect("foreign files stay", (out / "notes.txt").read_text(encoding="utf-8") == "mine")

    status, text = case.run(2, case.deck({"steps.0.increments": 1}), "--out", out, "-snes_max_it", "1")
    case.expect("no convergence ends with 3", status == 3, text)
    case.expect("and says why", "used all its iterations" in text, text)
    case.expect("with a summary", json.loads((out / "summary.json").read_text())["status"] == 3)
    case.expect("without a PETSc trace", "PETSC ERROR" not in text, text)


def cutback(case):
    """A first increment that fails is halved, and the answer at the end is that of the plain run."""
    plain, cut = case.folder / "plain", case.folder / "cut"
    status, text = case.run(2, case.deck({"steps.0.increments": 1}), "--out", plain)
    case.expect("one increment ends with 0", status == 0, text)
    needed = json.loads((plain / "summary.json").read_text())["newton_iterations"]
    # One iteration too few for the whole load; a part of it needs fewer. Remedies, which would get there, are off.
    limits = ("-snes_max_it", str(needed - 1), "-remedies", "none")
    status, text = case.run(2, case.deck({"steps.0.increments": 1}), "--out", cut, *limits)
    summary = json.loads((cut / "summary.json").read_text())
    case.expect("cutbacks happened", summary["cutbacks"] > 0, summary)
    if status == 0:
        case.expect("same forces and pressures", same(last_row(plain), last_row(cut), 1e-6))
    else:
        case.expect("or the program gives up with 3", status == 3, text)


def accuracy(case):
    """The summary says how large each error is, and that of the mesh is of first order."""
    found = {}
    for refine in (0, 1):
        out = case.folder / f"refine_{refine}"
        deck = case.deck({"mesh.refine": refine, "steps.0.increments": 2, "estimate_path_error": refine == 0})
        status, text = case.run(2, deck, "--out", out)
        case.expect(f"refine {refine}: the run ends with 0", status == 0, text)
        case.expect(f"refine {refine}: the log has the errors in a line", text.count("errors: mesh about") == 1, text)
        summary = found[refine] = json.loads((out / "summary.json").read_text())
        errors = summary["errors"]
        case.expect(f"refine {refine}: all kinds of errors", list(errors) == ["discretization", "figures", "path", "constraint", "algebra"])
        mesh = errors["discretization"]
        case.expect(f"refine {refine}: a part of the mesh's error", 0 < mesh["share_near_contact_edge"] < 1, mesh)
        case.expect(f"refine {refine}: its cost is timed", 0 < mesh["cost"]["seconds"] < summary["resources"]["wall_seconds"])
        shares = {name: error["cost"]["share_of_time"] for name, error in errors.items() if "cost" in error}
        measured = set(errors) - ({"path"} if refine else set())
        case.expect(f"refine {refine}: what each estimate took of the time", set(shares) == measured
                    and all(0 < share < 0.5 for share in shares.values()), shares)
        case.expect(f"refine {refine}: the error near the edge of contact", mesh["relative_near_contact_edge"] > 0, mesh)
        items = summary["certificate"]["items"]
        case.expect(f"refine {refine}: the certificate's penetration",
                    errors["constraint"]["penetration"] == items["penetration"]["worst"], errors)
        case.expect(f"refine {refine}: small residuals", 0 < errors["algebra"]["relative"] < 1e-6, errors["algebra"])
        case.expect(f"refine {refine}: next to nothing left unsolved", 0 <= errors["algebra"]["energy_norm"] < 1e-6, errors["algebra"])
        case.expect(f"refine {refine}: the effects off", not summary["effects"]["finite_kinematics"]["on"])
    case.expect("path error where asked for",
                found[0]["errors"]["path"]["relative"] == found[0]["path"]["estimated_error"])
    case.expect("and null where not", found[1]["errors"]["path"]["relative"] is None)
    coarse, fine = (found[refine]["errors"]["discretization"]["relative"] for refine in (0, 1))
    for load, warned in (("-450*t", False), ("-60000*t", True)):  # N/mm: mild, and as if the bodies did not yield
        _, text = case.run(2, case.deck({"boundary.3.resultant.y": load}), "--out", case.folder / "load")
        case.expect(f"load {load}: warned of small kinematics: {warned}",
                    ("finite_kinematics is off, but" in text) == warned, text)
    case.expect("half the cell size, half the error", 0.4 < fine / coarse < 0.6 and coarse < 0.5, (coarse, fine))


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    cases = {
        "restart": restart,
        "restart_of_friction": restart_of_friction,
        "restart_of_plasticity": restart_of_plasticity,
        "path_control": path_control,
        "interrupt": interrupt,
        "statuses": statuses,
        "cutback": cutback,
        "accuracy": accuracy,
    }
    parser.add_argument("case", choices=cases)
    parser.add_argument("--program", required=True)
    parser.add_argument("--mpirun", nargs="+", default=["mpirun", "--oversubscribe", "--bind-to", "none"])
    arguments = parser.parse_args()
    folder = tempfile.mkdtemp(prefix="amontons_runs_")
    try:
        case = Case(arguments.program, arguments.mpirun, folder)
        cases[arguments.case](case)
    finally:
        shutil.rmtree(folder)
    return case.status()


if __name__ == "__main__":
    sys.exit(main())
