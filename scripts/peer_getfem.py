"""GetFEM on the mesh of a deck: writes model.npz and job.json for peer_getfem_run.py, reads found.json."""

import json
import sys
from pathlib import Path

import numpy as np

PACKAGE = "python3-getfem"


def write_input(place, deck, mesh, motion, groups):
    """Writes the mesh and the steps as plain data and returns the command that solves them."""
    arrays = {"nodes": mesh.nodes[:, :mesh.dimension],
              **{f"cells_{i}": cells for i, (_, cells) in enumerate(mesh.blocks)},
              **{f"surface_{name}": facets for name, facets in mesh.surfaces.items()}}
    np.savez(place / "model.npz", **arrays)
    pair = deck["contact"][0]
    job = {"blocks": [body for body, _ in mesh.blocks],
           "bodies": {body: {key: float(value) for key, value in deck["materials"][material]["elastic"].items()}
                      for body, material in deck["bodies"].items()},
           "slave": pair["slave"], "master": pair["master"], "size": mesh.facet_size(pair["slave"]),
           "mu": pair["friction"]["coulomb"]["mu"] if "friction" in pair else None, "groups": groups,
           "increments": [step["increments"] for step in deck["steps"]], "motion": motion}
    (place / "job.json").write_text(json.dumps(job), encoding="utf-8")
    (place / "found.json").unlink(missing_ok=True)
    return [sys.executable, str(Path(__file__).with_name("peer_getfem_run.py"))]


def read_results(place, deck, mesh):
    try:
        return json.loads((place / "found.json").read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
