#!/usr/bin/python3
"""What a refusal says can be acted upon: advice.py --program PATH [CASE...].

Each run of the table that is refused though its scene has a solution. It must end with the status and the words below;
the deck is changed as the words say, and must then be certified and meet the scene's own figures.
"""
from pathlib import Path

import finite_scenes  # noqa: F401 (adds to the table)
import yaml
from cases import run_cases
from run import ENFORCE, PENALTY_TOLERANCE, Results, start
from scenes import SCENES


def enforce(words):
    def change(deck):
        for contact in deck["contact"]:
            contact["enforce"] = words

    return change


def closest_point(deck):
    for contact in deck["contact"]:
        contact["projection"] = {"closest_point": {}}


# Case: scene, formulation, seed, status, words of the refusal, what is changed. 30 is the default of a penalty's alpha.
CASES = {
    "stiffer_penalty": ("nu_0.4999", "penalty", 0, 4, "make alpha larger", enforce({"penalty": {"alpha": 30 * 1000}})),
    "penalty_to_uzawa": ("nu_0.4999", "penalty", 1, 4, "`{uzawa: {}}`", enforce({"uzawa": {}})),
    "couple_of_vi": ("touch_at_a_point", "vi", 1, 4, "take `enforce: {semismooth: {}}`", enforce({"semismooth": {}})),
    "couple_of_the_dual_basis": ("touch_at_a_point_friction", "dual", 1, 4, "take `enforce: {semismooth: {}}`", enforce({"semismooth": {}})),
    "slave_normal": ("edge_back_and_forth", "penalty", 1, 4, "take `projection: {closest_point: {}}`", closest_point),
    "rubber_by_uzawa": ("rubber_at_half", "uzawa", 1, 3, "smaller increments or `enforce: {semismooth: {}}` may help", enforce({"semismooth": {}})),
    "rubber_by_penalty": ("rubber_at_half", "penalty", 0, 4, "take `enforce: {semismooth: {}}`", enforce({"semismooth": {}})),
}


def run(options, seed, deck, mesh, folder):
    folder.mkdir()
    mesh.write(folder / "mesh.msh")
    path = folder / "deck.yaml"
    path.write_text(yaml.safe_dump(deck, sort_keys=False), encoding="utf-8")
    return start(options, 1 + seed % 2, [path, "--out", folder / "results"])


def examine(options, case, root):
    """What is wrong with the case, as a list of words."""
    name, formulation, seed, status, words, change = CASES[case]
    mesh, deck, check = SCENES[name].make(seed)
    enforce(ENFORCE[formulation])(deck)
    refused = run(options, seed, deck, mesh, Path(root) / f"{case}_refused")
    if refused.returncode != status or words not in refused.stdout:
        return [f"ends with {refused.returncode}, and not with {status} and '{words}'\n{refused.stdout[-1500:]}"]
    change(deck)
    folder = Path(root) / f"{case}_changed"
    done = run(options, seed, deck, mesh, folder)
    if done.returncode != 0:
        return [f"acted upon, ends with {done.returncode}\n{done.stdout[-1500:]}"]
    is_penalty = any("penalty" in contact["enforce"] for contact in deck["contact"])
    faults = []
    for what, error, tolerance in check(Results(deck, folder / "results")):
        if not error <= (max(tolerance, PENALTY_TOLERANCE) if is_penalty else tolerance):
            faults.append(f"{what}: off by {error:.3g}")
    return faults


if __name__ == "__main__":
    run_cases(__doc__, CASES, examine)
