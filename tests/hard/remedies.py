#!/usr/bin/python3
"""Each remedy alone: remedies.py --program PATH.

A tall block pushed at its top, which rocks on its edge, a ridge under a ridge, or a wedge that locks (`rocking`,
`deep_ridge_friction` and `wedge` of scenes.py), in one increment a step that may not be cut (but for the case of cutbacks), with augmentations, friction and
steps that plain iterations do not get through. Each case is run with no remedy, must end with status 3 and a diagnosis,
and with one, must be certified, meet the scene's own figures, and say in the summary that the remedy has helped. A run that gives up must leave a checkpoint and its last iterate.
"""
import json
from pathlib import Path

import yaml
from cases import run_cases
from run import PENALTY_TOLERANCE, Results, start
from scenes import SCENES

# Case: scene, seed of the mesh, enforcement, friction coefficient (None: the scene's own), PETSc options. The remedy is
# the case's name up to a blank.
CASES = {
    "merit_search": ("rocking", 0, {"semismooth": {"alpha": 100}}, None, []),
    "held_points": ("rocking", 0, {"penalty": {"alpha": 1e4}}, 2.0, []),
    "held_points of the dual basis": ("wedge", 0, {"semismooth": {"basis": "dual", "alpha": 1e4}}, 3.0, []),
    "lagged_friction": ("deep_ridge_friction", 0, {"penalty": {"alpha": 1000}}, None, []),
    "softer_augmentation": ("rocking", 0, {"penalty": {"alpha": 1e4}}, None, []),
    "uzawa_loop": ("rocking", 0, {"semismooth": {"alpha": 1000}}, None, []),
    "vanishing_support": ("rocking", 0, {"penalty": {"alpha": 1e4}}, 2.0, ["-snes_linesearch_type", "basic"]),
    "cutbacks": ("rocking", 0, {"semismooth": {"alpha": 100}}, None, []),
}


def examine(options, case, root):
    """What is wrong with the case, as a list of words."""
    name, seed, enforce, mu, words = CASES[case]
    remedy = case.split()[0]
    folder = Path(root) / case.replace(" ", "_")
    folder.mkdir()
    mesh, deck, check = SCENES[name].make(seed)
    mesh.write(folder / "mesh.msh")
    for contact in deck["contact"]:
        contact["enforce"] = enforce
        if mu:
            contact["friction"] = {"coulomb": {"mu": mu}}
    deck.pop("output", None)
    path = folder / "deck.yaml"
    faults = []

    def run(chosen):
        cuts = chosen == "cutbacks"  # the rung above those of -remedies
        for step in deck["steps"]:
            step["increments"] = {"auto": {"first": 1.0, "smallest": 1 / 64 if cuts else 1.0}}
        path.write_text(yaml.safe_dump(deck, sort_keys=False), encoding="utf-8")
        done = start(options, 1, [path, "--out", folder / chosen, *words, "-remedies", "none" if cuts else chosen])
        summary = json.loads((folder / chosen / "summary.json").read_text(encoding="utf-8"))
        return done.returncode, summary, done.stdout

    status, summary, said = run("none")
    if status != 3:
        faults.append(f"ends with {status} without a remedy")
    else:
        if "reason" not in summary.get("diagnosis", {}) or "giving up" not in said:
            faults.append("no diagnosis without a remedy")
        for left in ("checkpoint.h5", "failed.h5", "failed.xdmf"):
            if not (folder / "none" / left).exists():
                faults.append(f"{left} is missing without a remedy")
    status, summary, said = run(remedy)
    if status != 0:
        return [*faults, f"ends with {status} with the remedy\n{said[-1500:]}"]
    used = summary["remedies"].get(remedy, {})
    if not (used if remedy == "cutbacks" else used.get("helped")):
        faults.append(f"the remedy was not what helped: {summary['remedies']}")
    for what, error, tolerance in check(Results(deck, folder / remedy)):
        if not error <= (max(tolerance, PENALTY_TOLERANCE) if "penalty" in enforce else tolerance):
            faults.append(f"{what}: off by {error:.3g}")
    return faults


if __name__ == "__main__":
    run_cases(__doc__, CASES, examine)
