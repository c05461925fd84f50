#!/usr/bin/python3
"""An effect that is off is not there: instructions.py --program PATH [--valgrind valgrind]

Counts instructions of a frictionless run with valgrind's callgrind. No function of the tangential part of contact or of
a friction law may have executed; what else has friction in its name (declaring the deck's keys, asking whether there is
any) must be below a hundredth of the whole by far. The same deck with friction is the control that these functions can
be seen at all.
"""
import argparse
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import yaml

TOP = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(TOP / "scripts"))
from deck_edit import read_yaml  # noqa: E402

# What computes friction at points: the tangential part of pairs, and what the laws are asked.
KERNEL = re.compile(r"amontons::(TangentialPart::|ContactForm::evaluate_friction|"
                    r"\w+::(limit|steepest_weakening|initial_state)\(amontons::FrictionContext)")
NAMED = re.compile(r"amontons::.*(friction|tangential)", re.IGNORECASE)


def instructions(options, folder, friction):
    """Function -> instructions of its own, of one run of patch_2d."""
    deck = read_yaml(TOP / "inputs/patch_2d/patch_2d.yaml")
    deck["mesh"]["file"] = str(TOP / "inputs/patch_2d/patch_2d.geo")
    if friction:
        deck["contact"][0]["friction"] = {"coulomb": {"mu": 0.02}}
    path, counts = folder / "deck.yaml", folder / "callgrind.out"
    path.write_text(yaml.safe_dump(deck, sort_keys=False), encoding="utf-8")
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1"}
    done = subprocess.run([options.valgrind, "--tool=callgrind", f"--callgrind-out-file={counts}", options.program, str(path),
                           "--out", str(folder / "results")], capture_output=True, text=True, check=False, env=environment)
    if done.returncode != 0:
        sys.exit(f"the run under valgrind ended with {done.returncode}\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
    text = subprocess.run(["callgrind_annotate", "--threshold=100", str(counts)], capture_output=True, text=True,
                          check=True).stdout
    found = {}
    for count, name in re.findall(r"^\s*([\d,]+) \([^)]*\)\s+\S*?:(.*?)(?: \[|$)", text, re.MULTILINE):
        found[name] = found.get(name, 0) + int(count.replace(",", ""))
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", required=True)
    parser.add_argument("--valgrind", default="valgrind")
    options = parser.parse_args()
    faults = []
    with tempfile.TemporaryDirectory() as folder:
        plain = instructions(options, Path(folder), friction=False)
        rough = instructions(options, Path(folder), friction=True)
    total, kernel = sum(plain.values()), {name: count for name, count in plain.items() if KERNEL.search(name)}
    named = sum(count for name, count in plain.items() if NAMED.search(name))
    control = sum(count for name, count in rough.items() if KERNEL.search(name))
    print(f"{total} instructions without friction; {named} in functions with friction in their name; "
          f"with friction {sum(rough.values())}, {control} of them in the kernel of friction")
    if total < 1e8:
        faults.append("too few instructions were counted")
    if kernel:
        faults.append(f"friction was computed in a frictionless run: {kernel}")
    if named > 1e-4 * total:
        faults.append("more than a ten thousandth of the instructions have to do with friction")
    if control < 1000:
        faults.append("the control does not see friction where there is some")
    print("\n".join(faults) or "ok")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
