"""Other programs on the mesh, material, steps and motion of a deck: what is common to them.

A peer's folder is made to look like the results of a run (history.csv with the reactions, summary.json, fields.h5 with the
tractions on the slave surface), so that quantities and errors are read by the same code.
"""

import csv
import hashlib
import importlib.util
import json
import os
import shutil
import subprocess
import time

import h5py
import numpy as np

import peer_calculix
import peer_getfem
from bench_mesh import DIMENSION, make_mesh
from bench_table import row_of
from deck_edit import StudyError
from expressions import evaluate
from study_results import on_facets, read_outcome
from study_runs import POLL_SECONDS, Interrupted, mpi_environment, resident_bytes

SURFACE_CODE = {2: 2, 3: 4, 4: 5}  # corners of a facet -> its code in a Mixed topology
PEER_MODULES = {"calculix": peer_calculix, "getfem": peer_getfem}


def is_installed(peer):
    return shutil.which("ccx") is not None if peer == "calculix" else importlib.util.find_spec("getfem") is not None


def displacements(deck, time_now):
    """(group, component 0..2, value) of all that the deck prescribes at a time. Errors: StudyError where values differ
    from place to place or a load is no displacement."""
    found = []
    for condition in deck["boundary"]:
        if set(condition) != {"on", "displacement"}:
            raise StudyError(f"peers know prescribed displacements only, not what is on '{condition['on']}'")
        for axis, text in condition["displacement"].items():
            names = {**(deck.get("constants") or {}), "t": time_now}
            found.append((condition["on"], "xyz".index(axis), float(evaluate(str(text), names))))
    return found


def reaction_groups(deck):
    return list(dict.fromkeys(condition["on"] for condition in deck["boundary"]))


def check_deck(deck):
    """Errors: StudyError for what the exporters do not write."""
    if deck["space"] not in DIMENSION or len(deck["contact"]) != 1 or deck["mesh"].get("refine", 0):
        raise StudyError("peers are given solids and plane strain with one contact pair and no refinement")
    if any(set(material) != {"elastic"} for material in deck["materials"].values()):
        raise StudyError("peers are given linear elastic materials only")


def run_limited(command, folder, runs):
    """Runs a command in a folder; (exit status or None when it was ended, word, CPU seconds, wall seconds, peak bytes)."""
    started, peak = time.monotonic(), 0
    with open(folder / "output.txt", "w", encoding="utf-8") as output:
        process = subprocess.Popen(command, cwd=folder, stdout=output, stderr=subprocess.STDOUT,
                                   env={**mpi_environment(), "OMP_NUM_THREADS": "1"})
        word = None
        while True:
            pid, status, usage = os.wait4(process.pid, os.WNOHANG)
            if pid:
                break
            peak = max(peak, resident_bytes([process.pid]))
            over = time.monotonic() - started > runs.time_limit
            if over or runs.wish_to_stop:
                word = "timed out" if over else "interrupted"
                process.kill()
                _, status, usage = os.wait4(process.pid, 0)
                break
            time.sleep(POLL_SECONDS)
        process.returncode = os.waitstatus_to_exitcode(status)
    if word == "interrupted":
        raise Interrupted
    return (process.returncode, word, usage.ru_utime + usage.ru_stime, time.monotonic() - started,
            max(peak, 1024 * usage.ru_maxrss))


def write_fields(path, pair, mesh, facets, found):
    """fields.h5 of one step with the slave surface: pressure at its nodes, shear traction at Gauss points of its facets."""
    used = np.unique(facets)
    local, code = np.searchsorted(used, facets), SURFACE_CODE[facets.shape[1]]
    head = [code, 2] if code == 2 else [code]  # a polyline says how long it is
    topology = np.column_stack([np.tile(head, (len(local), 1)), local]).ravel()
    shear = np.asarray(found["shear"])
    sampled = [on_facets(mesh.nodes[used], {code: local}, part) for part in shear.T]
    vectors = np.zeros((len(sampled[0][0]), 3))
    vectors[:, :shear.shape[1]] = np.column_stack([values for _, values, _ in sampled])
    with h5py.File(path, "w") as file:
        run = file.create_group("run0")
        run.attrs["dim"] = mesh.dimension
        for name in ("mesh", f"surfaces/{pair}"):
            run[f"{name}/coordinates"], run[f"{name}/topology"] = mesh.nodes[used], topology
        step = run.create_group("step_0")
        step.attrs["time"] = 0.0
        step[f"surfaces/{pair}/pressure"] = found["pressure"]
        for name, values in (("places", sampled[0][0]), ("weight", sampled[0][2]), ("shear", vectors)):
            step[f"points/{pair}/{name}"] = values


def write_results(place, deck, mesh, found):
    """history.csv, summary.json and fields.h5 of what a peer found: reactions by group, tractions, counts."""
    (place / "results").mkdir(exist_ok=True)
    names = {f"reaction_{group}_{axis}": part for group, force in found["reactions"].items() for axis, part in zip("xyz", force)}
    with open(place / "results" / "history.csv", "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerows([list(names), list(names.values())])
    pair = deck["contact"][0]
    summary = {"scene": {"unknowns": {"all": found["unknowns"]}}, "increments": found["increments"],
               "newton_iterations": found["newton"],
               "contact": {pair["name"]: {"max_pressure": float(np.max(found["pressure"]))}}}
    (place / "results" / "summary.json").write_text(json.dumps(summary), encoding="utf-8")
    write_fields(place / "results" / "fields.h5", pair["name"], mesh, mesh.surfaces[pair["slave"]], found)


def solve(task, deck, place, runs):
    """Writes the peer's input, runs it, and returns the record of the run."""
    module = PEER_MODULES[task.program]
    load = os.getloadavg()[0]
    check_deck(deck)
    mesh = make_mesh(deck, place)
    times = [0.0] + [step["to"] for step in deck["steps"]]
    motion = [displacements(deck, time_now) for time_now in times]
    command = module.write_input(place, deck, mesh, motion, reaction_groups(deck))
    status, word, cpu, wall, peak = run_limited(command, place, runs)
    record = {"outcome": word or "certified", "message": "", "wall_seconds": wall, "load_average": load}
    said = (place / "output.txt").read_text(encoding="utf-8", errors="replace").strip()
    if word:
        record["message"] = f"after {cpu:.0f} s of CPU, {peak / 1e6:.0f} MB: {said.rpartition(chr(10))[2]}"
    else:
        found = module.read_results(place, deck, mesh)
        record.update(cpu_seconds=cpu, peak_memory_bytes=peak)
        if status or found is None:
            return {**record, "outcome": "crashed" if status else "not converged",
                    "message": said[-200:]}
        write_results(place, deck, mesh, found)
    return record


def run_peer(task, study, runs, say):
    """The row of a peer; an earlier run of the same deck and mesh file is taken again."""
    deck, name = task.variant.deck, task.program
    if not is_installed(name):
        say(f"{name} is not installed: apt-get install {PEER_MODULES[name].PACKAGE}")
        return {"program": name, "solver": "", "size": task.size, "ranks": 1, "outcome": "not installed"}
    text = runs.deck_text(task.variant, study.deck_path.parent)
    mesh_text = (study.deck_path.parent / deck["mesh"]["file"]).read_text(encoding="utf-8")
    place = runs.folder / "peers" / f"{name}-{hashlib.sha256((text + mesh_text).encode()).hexdigest()[:10]}"
    place.mkdir(parents=True, exist_ok=True)
    kept = place / "run_1.json"
    if not kept.exists():
        full = {**deck, "mesh": {**deck["mesh"], "file": str((study.deck_path.parent / deck["mesh"]["file"]).resolve())}}
        try:
            record = solve(task, full, place, runs)
        except StudyError as error:
            record = {"outcome": "not run", "message": str(error), "wall_seconds": 0.0, "load_average": 0.0}
        kept.write_text(json.dumps(record), encoding="utf-8")
        say(f"{name}, {task.size}: {record['outcome']}, {record.get('cpu_seconds', 0.0):.2f} s CPU {record['message'][:160]}")
    record = json.loads(kept.read_text(encoding="utf-8"))
    row = row_of(task, read_outcome(study, task.variant, place, {1: record}))
    row["outcome"] = "solved" if row["outcome"] == "certified" else row["outcome"]
    return row
