#!/usr/bin/python3
"""A run made twice has the same bits: repeated.py --program PATH [CASE...].

The whole history and every array of fields.h5 and checkpoint.h5 of two runs of the same deck on the same number of ranks:
with friction, in each formulation, with factorizations, kept ones and multigrid, with remedies at work. (On several ranks
scenes of this size are factorized on each rank, for MUMPS adds contributions in the order of their arrival: README.md.)
"""
from pathlib import Path

import h5py
import yaml
from cases import run_cases
from run import ENFORCE, start
from scenes import SCENES

MULTIGRID = ["-ksp_type", "gmres", "-pc_type", "gamg"]
# Case: scene, `enforce`, ranks, PETSc options.
CASES = {
    "friction": ("wedge_two_solutions", ENFORCE["semismooth"], 2, []),
    "friction_one_rank": ("wedge_two_solutions", ENFORCE["semismooth"], 1, []),
    "dual_basis": ("slide_mu_0.5", ENFORCE["dual"], 2, []),
    "uzawa_by_multigrid": ("solid_slide", ENFORCE["uzawa"], 2, MULTIGRID),
    "kept_factorizations": ("solid_slide", ENFORCE["semismooth"], 1, ["-pc_type", "shell"]),
    "bounds_by_multigrid": ("solid_stack", ENFORCE["vi"], 2, ["-ksp_type", "cg", "-pc_type", "gamg"]),
    "remedies": ("rocking", {"semismooth": {"alpha": 100}}, 1, []),
}


def arrays(folder):
    """Name and bytes of the history and of every array in the files of results."""
    found = {"history.csv": (folder / "history.csv").read_bytes()}
    for name in ("fields.h5", "checkpoint.h5"):
        with h5py.File(folder / name, "r") as file:
            file.visititems(lambda path, item, name=name: found.update({f"{name}:{path}": item[()].tobytes()})
                            if isinstance(item, h5py.Dataset) and item.dtype != object else None)
    return found


def examine(options, case, root):
    """What is wrong with the case, as a list of words."""
    name, enforce, ranks, words = CASES[case]
    folder = Path(root) / case
    folder.mkdir()
    mesh, deck, _ = SCENES[name].make(1)
    mesh.write(folder / "mesh.msh")
    for contact in deck["contact"]:
        contact["enforce"] = enforce
    path = folder / "deck.yaml"
    path.write_text(yaml.safe_dump(deck, sort_keys=False), encoding="utf-8")
    runs = []
    for run in ("one", "other"):
        done = start(options, ranks, [path, "--out", folder / run, *words])
        if done.returncode != 0:
            return [f"ends with {done.returncode}\n{done.stdout[-1500:]}"]
        runs.append(arrays(folder / run))
    one, other = runs
    if len(one) < 10 or one.keys() != other.keys():
        return [f"{len(one)} and {len(other)} arrays"]
    return [f"{key}: other bits" for key in one if one[key] != other[key]]


if __name__ == "__main__":
    run_cases(__doc__, CASES, examine)
