"""Runs variants of a scene's deck and reads what a run leaves behind."""
import copy
import csv
import json
import os
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
import yaml

TOP = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(TOP / "scripts"))
from deck_edit import DeckLoader  # noqa: E402

# XDMF cell code -> number of nodes in the file. Hexahedra of order 2 are written with 20 of their 27.
CELL_NODES = {4: 3, 5: 4, 6: 4, 9: 8, 36: 6, 35: 9, 38: 10, 48: 20}


def text_of(attribute):
    return attribute.decode() if isinstance(attribute, bytes) else str(attribute)


def load_deck(scene, scenes=TOP / "inputs"):
    text = (scenes / scene / f"{scene}.yaml").read_text(encoding="utf-8")
    return yaml.load(text, Loader=DeckLoader)


def set_key(deck, path, value):
    """Sets a deck's value at a dotted path; a number is an index into a list, '*' means every item of one."""
    head, _, rest = path.partition(".")
    if head == "*":
        keys = range(len(deck))
    else:
        keys = [int(head) if isinstance(deck, list) else head]
    for key in keys:
        if not rest:
            deck[key] = copy.deepcopy(value)
        else:
            if isinstance(deck, dict):
                deck.setdefault(key, {})
            set_key(deck[key], rest, value)


class Results:
    """A finished run: `deck`, `summary`, `history` (column -> array) and the fields of one step, the last or that at `time`."""

    def __init__(self, deck, folder, time=None):
        self.deck, self.folder = deck, Path(folder)
        self.summary = json.loads((self.folder / "summary.json").read_text(encoding="utf-8"))
        with open(self.folder / "history.csv", encoding="utf-8", newline="") as file:
            rows = list(csv.reader(file))
        self.history = {name: np.array([float(row[i]) for row in rows[1:]]) for i, name in enumerate(rows[0])}
        with h5py.File(self.folder / "fields.h5", "r") as file:
            run = file["run0"]
            steps = {float(run[name].attrs["time"]): run[name] for name in run if name.startswith("step_")}
            step = steps[max(steps) if time is None else min(steps, key=lambda other: abs(other - time))]
            self.time = float(step.attrs["time"])
            self.bodies = text_of(run.attrs["bodies"]).split("\n")
            self.tensor = text_of(step.attrs["tensor_components"]).split()
            self.places = run["mesh/coordinates"][:]
            self.node_body = self._node_bodies(run["mesh/topology"][:].ravel(), run["mesh/body"][:].ravel())
            self.nodal = {name: item[:] for name, item in step.items() if isinstance(item, h5py.Dataset)}
            self.surface = {
                pair: {"places": run["surfaces"][pair]["coordinates"][:], **{k: v[:] for k, v in group.items()}}
                for pair, group in step.get("surfaces", {}).items()
            }
            self.points = {
                pair: {k: v[:] if v.shape[1:] == (3,) else v[:].ravel() for k, v in group.items()}
                for pair, group in step.get("points", {}).items()
            }

    def _node_bodies(self, topology, bodies):
        result, at = np.full(len(self.places), -1), 0
        for body in bodies:
            count = CELL_NODES[topology[at]]
            result[topology[at + 1 : at + 1 + count]] = body
            at += 1 + count
        return result

    def at(self, time):
        """The same run with the fields of the step at `time`."""
        results = Results(self.deck, self.folder, time)
        if abs(results.time - time) > 1e-9 * max(1.0, abs(time)):
            raise SystemExit(f"{self.folder} has no fields at t = {time}; the nearest are at {results.time}")
        return results

    def stress(self, component):
        """Nodal stress, component by name: "xx", "xy" ..."""
        return self.nodal["stress"][:, self.tensor.index(component)]

    def in_body(self, name):
        return self.node_body == self.bodies.index(name)

    def force_vector(self, pair):
        """Contact force on the slave (of the part that is modelled): sum of pressure times area times normal."""
        points = self.points[pair]
        return np.sum((points["pressure"] * points["weight"])[..., None] * points["normal"], axis=0)

    def force(self, pair):
        return float(np.linalg.norm(self.force_vector(pair)))

    def peak_pressure(self, pair):
        return float(np.nanmax(self.surface[pair]["pressure"]))

    def nodal_sorted(self, field):
        """A nodal field with rows in an order that does not depend on ranks: by body, then place."""
        keys = np.round(self.places, 9)
        return self.nodal[field][np.lexsort((keys[:, 2], keys[:, 1], keys[:, 0], self.node_body))]

    def surface_sorted(self, pair, field):
        keys = np.round(self.surface[pair]["places"], 9)
        return self.surface[pair][field][np.lexsort((keys[:, 2], keys[:, 1], keys[:, 0]))]


class Bench:
    """Runs decks with one program and keeps the score."""

    def __init__(self, program, mpirun, ranks, folder):
        self.program, self.mpirun, self.ranks, self.folder = program, mpirun, ranks, Path(folder)
        self.num_runs = self.num_checks = self.num_failed = 0
        self.environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
        if os.geteuid() == 0:  # Open MPI refuses to run as root unless told that this is meant
            self.environment.update(OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")

    def run(self, scene, changes=None, ranks=None):
        """Runs the scene's deck with `changes` (dotted path -> value); the run must end with status 0."""
        deck = load_deck(scene)
        deck["mesh"]["file"] = str((TOP / "inputs" / scene / deck["mesh"]["file"]).resolve())
        for path, value in (changes or {}).items():
            set_key(deck, path, value)
        self.num_runs += 1
        out = self.folder / f"run_{self.num_runs}"
        out.mkdir(parents=True)
        path = out / f"{scene}.yaml"
        path.write_text(yaml.safe_dump(deck, sort_keys=False), encoding="utf-8")
        command = [*self.mpirun, "-n", str(ranks or self.ranks), self.program, str(path), "--out", str(out / "results")]
        done = subprocess.run(command, capture_output=True, text=True, check=False, env=self.environment)
        if done.returncode != 0:
            raise SystemExit(
                f"{scene} with {changes or 'no changes'} on {ranks or self.ranks} ranks ended with status "
                f"{done.returncode}\n{done.stdout[-3000:]}\n{done.stderr[-3000:]}"
            )
        results = Results(deck, out / "results")
        if results.summary["ranks"] != (ranks or self.ranks):
            raise SystemExit(f"{scene} ran on {results.summary['ranks']} ranks instead of {ranks or self.ranks}")
        return results

    def below(self, name, value, limit):
        """Checks value <= limit (a NaN fails)."""
        good = bool(value <= limit)
        self.num_checks += 1
        self.num_failed += not good
        print(f"{'ok  ' if good else 'FAIL'} {name}: {value:.4g} (at most {limit:.4g})", flush=True)

    def close(self, name, value, reference, tolerance):
        """Checks |value - reference| <= tolerance |reference|."""
        good = bool(abs(value - reference) <= tolerance * abs(reference))
        self.num_checks += 1
        self.num_failed += not good
        error = (value - reference) / reference
        print(
            f"{'ok  ' if good else 'FAIL'} {name}: {value:.6g}, reference {reference:.6g}, "
            f"off by {100 * error:+.3f} % (at most {100 * tolerance:g} %)",
            flush=True,
        )
