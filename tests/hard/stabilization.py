#!/usr/bin/python3
"""Artificial viscosity by closed form: stabilization.py --program PATH.

A free block under a body force f that nothing else holds creeps as a rigid body. Its resistance is c = ratio E V T / L^2 (E V
over the square of its diagonal, T the end of the run; lib/form/viscous.hpp), so u(t) = f V t / c in every increment, and all
the work of the load is artificial: the balance of energies holds, and the certificate refuses the run for that item alone.
"""
import argparse
import sys
import tempfile
from pathlib import Path

import numpy as np
import yaml
from meshes import Mesh
from run import Results, start
from scenes import E, deck

RATIO, END, PUSH, INCREMENTS = 1e-2, 2.0, 2e-4, 4


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", required=True, help="the amontons executable")
    parser.add_argument("--mpirun", default="mpirun --oversubscribe --bind-to none", help="how ranks are started")
    options = parser.parse_args()
    options.program = str(Path(options.program).resolve())
    failed = 0

    def expect(what, good, detail=""):
        nonlocal failed
        failed += not good
        print(f"{'ok  ' if good else 'FAIL'} {what} {detail}")

    with tempfile.TemporaryDirectory() as root:
        folder = Path(root)
        mesh = Mesh(0)
        mesh.box("block", (0, 0), (2, 1), (4, 2))
        mesh.write(folder / "mesh.msh")
        whole = deck({"block": (E, 0.3)}, [], [], ((END, INCREMENTS),), body_force={"block": {"x": str(PUSH * E)}})
        whole["stabilization"] = {"viscous": {"ratio": RATIO}}
        (folder / "deck.yaml").write_text(yaml.safe_dump(whole, sort_keys=False), encoding="utf-8")
        done = start(options, 1, [folder / "deck.yaml", "--out", folder / "results"])
        expect("status 4", done.returncode == 4, done.stdout[-500:] + done.stderr[-500:] if done.returncode != 4 else "")
        if done.returncode != 4:
            return 1
        run = Results(whole, folder / "results")
        volume, size_squared = 2.0, 5.0
        rate = PUSH * E * size_squared / (RATIO * E * END)  # f V / c
        moved = run.nodal["displacement"]
        error = np.max(np.abs(moved - [rate * END, 0, 0][: moved.shape[1]])) / (rate * END)
        expect("displacement f V t / c", error < 1e-9, f"off by {error:.1e}")
        # The load is there from the start; the trapezoidal rule takes the mean of nothing and the load for the first increment.
        work = PUSH * E * volume * rate * (run.history["time"] - 0.5 * END / INCREMENTS)
        for column in ("energy_artificial", "energy_external_work"):
            error = np.max(np.abs(run.history[column] - work) / work)
            expect(column, error < 1e-9, f"off by {error:.1e}")
        items = run.summary["certificate"]["items"]
        refused = [name for name, item in items.items() if not item["passed"]]
        expect("only `artificial` is refused", refused == ["artificial"], {name: items[name]["worst"] for name in refused})
        expect("and is 1", abs(items["artificial"]["worst"] - 1.0) < 1e-9, items["artificial"]["worst"])
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
