#!/usr/bin/python3
"""scripts/study, scripts/report and scripts/bench on small runs: tables, resume, failures, wrong files, effects, pages."""
import argparse
import csv
import html.parser
import json
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import yaml

TOP = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(TOP / "tests/scenes"), str(TOP / "tests/support"), str(TOP / "scripts")]
import browser  # noqa: E402
import hertz_cases  # noqa: E402
from harness import Results, load_deck  # noqa: E402
from score import Score  # noqa: E402
from bench_mesh import FACES, make_mesh  # noqa: E402
from bench_peers import write_fields  # noqa: E402
from study_results import profile  # noqa: E402

HERTZ_CONSTANTS = {"modulus": "1/((1 - 0.3^2)/210e3 + (1 - 0.3^2)/70e3)", "a": "sqrt(4*900*50/(pi*modulus))",
                   "p0": "2*900/(pi*a)"}


class Case(Score):
    """Studies and pages of one case in a folder of its own, and the score."""

    def __init__(self, program, folder):
        super().__init__()
        self.program, self.folder = Path(program).resolve(), Path(folder)

    def study_file(self, content, name="small"):
        path = self.folder / f"{name}.study.yaml"
        path.write_text(yaml.safe_dump(content, sort_keys=False), encoding="utf-8")
        return path

    def hertz(self, sweeps, **others):
        return {"deck": str(TOP / "inputs/hertz_2d/hertz_2d.yaml"), "repetitions": 2,
                "settings": {"mesh.parameters.h": 0.2, "steps[0].increments": 1}, "constants": HERTZ_CONSTANTS,
                "quantities": {
                    "pressure": {"profile": {"pair": "interface"},
                                 "reference": {"exact": "p0*sqrt(max(0, 1 - (x/a)^2))"}},
                    "peak_pressure": {"summary": "contact.interface.max_pressure", "reference": {"exact": "p0"}},
                    "penetration": {"history": "contact_interface_penetration", "reference": {"exact": 0}}},
                "sweeps": sweeps, **others}

    def start(self, script, *words):
        return subprocess.Popen([TOP / "scripts" / script, *map(str, words)], stdout=subprocess.PIPE,
                                stderr=subprocess.STDOUT, text=True, cwd=self.folder)

    def run(self, script, *words):
        process = self.start(script, *words)
        text, _ = process.communicate(timeout=250)
        return process.returncode, text

    def study(self, path, *words):
        return self.run("study", path, "--program", self.program, *words)


def table_of(folder):
    with open(folder / "table.csv", encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def study(case):
    """The table against an independent reading of the same runs; the failures that are recorded while the rest goes on."""
    path = case.study_file(case.hertz({"mesh": {"mesh.parameters.h": [0.2, 0.1]},
                                       "stubborn": {"petsc.snes_max_it": [1], "mesh.parameters.h": [0.2]}}))
    status, text = case.study(path)
    folder = case.folder / "results/small_study"
    case.expect("the study ends with 0", status == 0, text)
    rows = table_of(folder)
    case.expect("the table has a row a variant", len(rows) == 3, rows)
    for row in rows[:2]:
        h = row["mesh.parameters.h"]
        results, = folder.glob(f"variants/h_{h}-*/results")
        deck = yaml.safe_load((results.parent / "deck.yaml").read_text(encoding="utf-8"))
        hertz = hertz_cases.Hertz("hertz_2d", Results(deck, results))
        case.expect(f"h {h}: the cell size is in the deck", deck["mesh"]["parameters"]["h"] == float(h))
        for name, value in (("pressure_error", hertz.pressure_error()),
                            ("peak_pressure", hertz.results.summary["contact"]["interface"]["max_pressure"]),
                            ("peak_pressure_error", abs(hertz.results.summary["contact"]["interface"]["max_pressure"]
                                                        / hertz.p0 - 1.0)),
                            ("penetration_error", hertz.results.history["contact_interface_penetration"][-1])):
            case.expect(f"h {h}: {name}", abs(float(row[name]) - value) <= 1e-5 * abs(value), f"{row[name]} {value}")
        case.expect(f"h {h}: two runs with times and memory", row["runs"] == "2" and row["outcome"] == "certified"
                    and float(row["cpu_seconds_min"]) <= float(row["cpu_seconds"]) <= float(row["cpu_seconds_max"])
                    and 0.0 < float(row["cpu_seconds"]) and float(row["memory_mb"]) > 10.0, row)
    case.expect("the variant that fails is recorded, once", rows[2]["outcome"] == "not converged" and rows[2]["runs"] == "1"
                and "not reached" in rows[2]["message"], rows[2])
    words = (folder / "words.md").read_text(encoding="utf-8")
    case.expect("the words name it", "snes_max_it 1" in words.split("Not in the comparison")[-1], words)
    case.expect("and that the error of a zero reference is absolute", "the error is absolute" in words, words)
    for name in ("error_time.png", "error_cost.png", "knobs.png"):
        case.expect(f"{name} is a picture", (folder / name).read_bytes()[:8] == b"\x89PNG\r\n\x1a\n")

    for limit, word in (({"time_limit": 0.1}, "timed out"), ({"memory_limit": 40}, "out of memory")):
        path = case.study_file(case.hertz({"mesh": {"mesh.parameters.h": [0.2]}}, **limit), word.replace(" ", "_"))
        status, text = case.study(path, "--out", case.folder / word)
        case.expect(f"{word}: recorded", status == 0 and table_of(case.folder / word)[0]["outcome"] == word, text)


def memory(case):
    """One variant runs out of memory, as the system tells it: it is recorded as such, and the rest goes on."""
    short = case.folder / "short_of_memory"
    short.write_text(f"""#!/bin/bash
# The program, but for meshes with h = 0.15: as if it asked for more than there is.
deck=$1
if [ "$deck" != check ] && [ "$deck" != schema ] && grep -q 'h: 0.15' "$deck"; then
  echo "terminate called after throwing an instance of 'std::bad_alloc'" >&2
  exit 134
fi
exec {case.program} "$@"
""", encoding="utf-8")
    short.chmod(0o755)
    path = case.study_file(case.hertz({"mesh": {"mesh.parameters.h": [0.2, 0.15]}}))
    status, text = case.run("study", path, "--program", short)
    rows = {row["mesh.parameters.h"]: row for row in table_of(case.folder / "results/small_study")}
    case.expect("the study ends with 0", status == 0, text)
    case.expect("the variant is recorded, once, with what was said", rows["0.15"]["outcome"] == "out of memory"
                and rows["0.15"]["runs"] == "1" and "bad_alloc" in rows["0.15"]["message"], rows["0.15"])
    case.expect("the rest went on", rows["0.2"]["outcome"] == "certified" and rows["0.2"]["runs"] == "2", rows["0.2"])
    words = (case.folder / "results/small_study/words.md").read_text(encoding="utf-8")
    case.expect("the words name it", "h 0.15" in words.split("Not in the comparison")[-1], words)


def bench(case):
    """The smallest size without peers: a row a run, ratios that are ratios, shares that add up; then a wrong bench."""
    content = {"deck": str(TOP / "inputs/press_and_slide_3d/press_and_slide_3d.yaml"),
               "settings": {"steps[0].increments": 1, "steps[1].increments": 3},
               "quantities": {"shear": {"history": "reaction_base_bottom_x"}, "normal": {"history": "reaction_base_bottom_z"},
                              "friction": {"expression": "-shear/normal", "reference": {"exact": 0.3}}},
               "size": {"mesh.parameters.n": [5, 6]}, "solvers": {"semismooth": {}}, "ranks": [1, 2],
               "peers": {"calculix": {}}}
    path = case.folder / "small.bench.yaml"
    path.write_text(yaml.safe_dump(content, sort_keys=False), encoding="utf-8")
    status, text = case.run("bench", path, "--no-peers", "--program", case.program)
    case.expect("the bench ends with 0", status == 0, text)
    rows = table_of(case.folder / "results/small_bench")
    case.expect("a row a run: two of ours and two yardsticks a size", len(rows) == 8, rows)
    case.expect("all are certified", all(row["outcome"] == "certified" for row in rows), rows)
    ours, elastic, smooth = ([row for row in rows if row["program"] == name] for name in
                             ("amontons", "elastic", "frictionless"))
    case.expect("one linear solve", all(row["newton"] == row["increments"] == "1" for row in elastic), elastic)
    case.expect("without friction there are fewer unknowns", int(smooth[0]["unknowns"]) < int(ours[0]["unknowns"]))
    for row in ours:
        yardstick, = (other for other in elastic if other["size"] == row["size"])
        ratio = float(row["cpu_seconds"]) / float(yardstick["cpu_seconds"])
        case.expect("the ratio to the elastic solve", abs(float(row["cpu_to_elastic"]) / ratio - 1.0) < 1e-4, row)
        case.expect("and of an increment", abs(4 * float(row["increment_to_elastic"]) / ratio - 1.0) < 1e-4, row)
        case.expect("the error of what slides", float(row["error_friction"]) < 1e-3, row)
        total = sum(float(value) for name, value in row.items() if name.startswith("share_"))
        case.expect("shares add up to one", abs(total - 1.0) < 1e-4, row)
    picture = (case.folder / "results/small_bench/bench.png").read_bytes()
    case.expect("there is a picture", picture[:8] == b"\x89PNG\r\n\x1a\n")
    for change, message in (({"solver": {}}, "unknown key 'solver'"), ({"peers": {"abaqus": {}}}, "unknown key 'abaqus'"),
                            ({"size": {"mesh.cells": [4]}}, "unknown knob 'mesh.cells'")):
        path.write_text(yaml.safe_dump({**content, **change}, sort_keys=False), encoding="utf-8")
        status, text = case.run("bench", path, "--program", case.program)
        case.expect(f"refused: {message}", status == 2 and message in text, text)


def peers(case):
    """Meshes for other programs have the deck's areas and borders, plane and solid; what a peer found comes back as it was."""
    for scene, parameters, measures, border in (("hertz_2d", {"h": 0.4}, {"block": 50.0**2}, ("block_top", 50.0)),
                                                ("press_and_slide_3d", {"n": 4}, {"slider": 256.0, "base": 576.0},
                                                 ("slider_bottom", 64.0))):
        deck = load_deck(scene)
        deck["mesh"].update(file=str(TOP / f"inputs/{scene}/{scene}.geo"), parameters=parameters)
        mesh = make_mesh(deck, case.folder)
        for body, measure in measures.items():
            found = sum(cell_measures(mesh.nodes, cells, mesh.dimension).sum() for name, cells in mesh.blocks if name == body)
            case.expect(f"{scene}: the measure of {body}", abs(found / measure - 1.0) < 1e-9, found)
        name, size = border
        cells = [cell for _, block in mesh.blocks for cell in block]
        corners = {tuple(sorted(cells[cell][list(FACES[mesh.dimension, len(cells[cell])][face])]))
                   for cell, face in mesh.faces_of(name)}
        case.expect(f"{scene}: faces of {name}", corners == {tuple(sorted(facet)) for facet in mesh.surfaces[name]})

        used = np.unique(mesh.surfaces[name])
        found = {"pressure": 3.0 + mesh.nodes[used, 0], "shear": np.tile([1.0, -2.0, 0.0][:mesh.dimension], (len(used), 1))}
        write_fields(case.folder / "fields.h5", "pair", mesh, mesh.surfaces[name], found)
        places, values, weights = profile(case.folder, {"pair": "pair", "field": "pressure", "at": "nodes"}, False)
        case.expect(f"{scene}: pressure between nodes", np.abs(values - 3.0 - places[:, 0]).max() < 1e-9, values)
        case.expect(f"{scene}: size of the border", abs(weights.sum() / size - 1.0) < 1e-9, weights.sum())
        _, values, weights = profile(case.folder, {"pair": "pair", "field": "shear", "at": "points"}, False)
        case.expect(f"{scene}: shear at points", np.abs(values - 5.0**0.5).max() < 1e-9
                    and abs(weights.sum() / size - 1.0) < 1e-9, values)


def cell_measures(nodes, cells, dimension):
    """Signed areas of plane cells; volumes of hexahedra that are boxes."""
    corners = nodes[cells]
    if dimension == 3:
        return np.linalg.det(corners[:, [1, 3, 4]] - corners[:, :1])
    following = np.roll(corners, -1, axis=1)
    return 0.5 * (corners[..., 0] * following[..., 1] - corners[..., 1] * following[..., 0]).sum(axis=1)


def resume(case):
    """Stopped in the middle it goes on with what is missing, and leaves nothing of the broken run."""
    path = case.study_file(case.hertz({"mesh": {"mesh.parameters.h": [0.2, 0.15]}}))
    folder = case.folder / "results/small_study"
    process = case.start("study", path, "--program", case.program)
    deadline = time.monotonic() + 120
    # Some run is finished, and another one is on its way.
    while time.monotonic() < deadline and process.poll() is None and not (
            list(folder.glob("variants/*/run_*.json")) and list(folder.glob("variants/*/attempt_*/output.txt"))):
        time.sleep(0.01)
    process.send_signal(signal.SIGTERM)
    text, _ = process.communicate(timeout=60)
    case.expect("SIGTERM ends it with 5", process.returncode == 5, f"{process.returncode} {text}")
    kept = {record: record.stat().st_mtime_ns for record in folder.glob("variants/*/run_*.json")}
    case.expect("some runs were finished and some not", 0 < len(kept) < 4, kept)
    case.expect("nothing half-finished stays", not list(folder.glob("variants/*/attempt_*")))
    # What a study that was killed outright leaves behind: an attempt, and a record that was not written to its end.
    place = next(iter(kept)).parent
    (place / "attempt_1_1" / "results").mkdir(parents=True)
    missing = next(place / f"run_{k}.json" for k in (1, 2, 3) if not (place / f"run_{k}.json").exists())
    missing.write_text('{"outcome": "certi', encoding="utf-8")
    status, text = case.study(path)
    case.expect("called again it ends with 0", status == 0, text)
    case.expect("and says how much was there", f"{len(kept)} of 4 runs are there from before" in text, text)
    case.expect("kept runs were not run again", all(record.stat().st_mtime_ns == then for record, then in kept.items()))
    rows = table_of(folder)
    case.expect("all variants have both runs", [row["runs"] for row in rows] == ["2"] * 2, rows)
    status, text = case.study(path)
    case.expect("a third call runs nothing", status == 0 and "4 of 4 runs" in text and "[1/" not in text, text)


def wrong_study(case):
    """Studies that are refused, with status 2, a message, and nothing run."""
    for name, content, words in (
        ("unknown", case.hertz({"mesh": {"mesh.parametrs.h": [0.2]}}), "Did you mean 'parameters'"),
        ("parameter", case.hertz({"mesh": {"mesh.parameters.hh": [0.2]}}), "hh"),
        ("value", case.hertz({"mesh": {"mesh.order": [1, 3]}}), "mesh.order"),
        ("empty", case.hertz({"mesh": {"mesh.order": []}}), "has no values"),
        ("clash", case.hertz({"a": {"contact[0].enforce.penalty.alpha": [1], "contact[0].enforce": [{"uzawa": {}}]}}),
         "contradicts itself"),
        ("no_deck", {**case.hertz({"a": {"mesh.order": [1]}}), "deck": "none.yaml"}, "none.yaml cannot be read"),
    ):
        status, text = case.study(case.study_file(content, name))
        case.expect(f"{name}: status 2 and a message", status == 2 and words in text and "Traceback" not in text,
                    f"{status} {text}")
        case.expect(f"{name}: nothing was run", not list(case.folder.glob(f"results/{name}_study/variants/*/run_*.json")))


def effects(case):
    """Friction off: the tangential unknowns go, and so does what was dissipated."""
    deck = load_deck("patch_2d")
    deck["mesh"]["file"] = str(TOP / "inputs/patch_2d/patch_2d.geo")
    deck["contact"][0]["friction"] = {"coulomb": {"mu": 0.02}}
    (case.folder / "deck.yaml").write_text(yaml.safe_dump(deck, sort_keys=False), encoding="utf-8")
    path = case.study_file({"deck": "deck.yaml", "repetitions": 1, "sweeps": {"a": {"mesh.order": [1]}}, "quantities": {
        "dissipation": {"history": "energy_dissipated"}, "force": {"history": "contact_interface_force_y"}}})
    status, text = case.study(path, "--effects")
    case.expect("it ends with 0", status == 0, text)
    folder = case.folder / "results/small_effects"
    with open(folder / "effects.csv", encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    case.expect("as it is, and without friction", [row["variant"] for row in rows] ==
                ["as in the deck", "without friction of interface"], rows)
    nodes = 8  # of the slave surface: seven facets in a row; on each a tangential multiplier with two components
    case.expect("unknowns", int(rows[0]["unknowns"]) - int(rows[1]["unknowns"]) == 2 * nodes, rows)
    case.expect("dissipation", float(rows[0]["dissipation"]) > 0.0 == float(rows[1]["dissipation"]), rows)
    # On the base the whole load stands: pressure 1 on width 1, with and without friction.
    case.expect("force", all(abs(abs(float(row["force"])) - 1.0) < 1e-6 for row in rows), rows)
    case.expect("the words tell", "| friction of interface |" in (folder / "effects.md").read_text(encoding="utf-8"))


def with_growth(case):
    """The deck of hertz_2d with the growth of its cells in it, so that both can be scaled."""
    deck = load_deck("hertz_2d")
    deck["mesh"]["file"] = str(TOP / "inputs/hertz_2d/hertz_2d.geo")
    deck["mesh"]["parameters"]["growth"] = 0.25
    path = case.folder / "hertz.yaml"
    path.write_text(yaml.safe_dump(deck, sort_keys=False), encoding="utf-8")
    return path


def plan(case):
    """What is predicted against the run of the deck that is written: error, time and memory within a factor of two."""
    # The tube's mesh is small: the plan needs larger pilots than the deck's. The last one has increments to save.
    for deck, words, error in ((with_growth(case), ("--size", "h,growth"), 0.06),
                               (TOP / "inputs/inflated_cylinder/inflated_cylinder.yaml", ("--size", "n,m"), 3e-4),
                               (TOP / "inputs/cattaneo_mindlin_2d/cattaneo_mindlin_2d.yaml", (), 0.06)):
        new, out = case.folder / f"{deck.stem}_planned.yaml", case.folder / deck.stem
        done = subprocess.run([case.program, "plan", *map(str, (deck, *words, "--error", error, "--write", new, "--out", out))],
                              capture_output=True, text=True, check=False, timeout=250, cwd=case.folder)
        case.expect(f"{deck.stem}: planned", done.returncode == 0, done.stdout + done.stderr)
        planned = json.loads((out / "plan.json").read_text(encoding="utf-8"))
        summary = run_deck(case, new)
        found = {"error": summary["errors"]["discretization"]["relative"],
                 "unknowns": sum(summary["scene"]["unknowns"].values()),
                 "cpu_seconds": summary["resources"]["cpu_seconds"],
                 "memory_bytes": summary["resources"]["peak_memory_bytes"]}
        for name, value in found.items():
            print(f"     {name}: predicted {planned[name]:.4g}, found {value:.4g}")
            case.expect(f"{deck.stem}: {name} within a factor of 2", 0.5 <= value / planned[name] <= 2.0)
        case.expect(f"{deck.stem}: no more error than a tenth above what was asked for", found["error"] <= 1.1 * error)
        case.expect(f"{deck.stem}: certified", summary["status"] == 0)
    # Loading is monotone: the answer does not depend on increments, and the plan takes as few as there can be.
    steps = yaml.safe_load(new.read_text(encoding="utf-8"))["steps"]
    case.expect("one increment a step", [step["increments"] for step in steps] == [1] * 4, steps)
    case.expect("comments stay", "# moves as one; P and Q are exact" in new.read_text(encoding="utf-8"))


def run_deck(case, deck):
    out = case.folder / f"{deck.stem}_run"
    done = subprocess.run([case.program, str(deck), "--out", str(out)], capture_output=True, text=True, check=False,
                          cwd=case.folder)
    case.expect(f"{deck.stem}: the run ends with 0", done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:])
    return json.loads((out / "summary.json").read_text(encoding="utf-8"))


def wrong_plan(case):
    """Plans that are refused with status 2, a message, and no deck written."""
    deck, new = with_growth(case), case.folder / "new.yaml"
    adaptive = TOP / "inputs/hertz_2d_adaptive/hertz_2d_adaptive.yaml"
    for name, deck_path, words, expected in (
        ("contradictory targets", deck, ("--size", "h,growth", "--error", 0.03, "--time", "0.5s"), "Raise one of the two"),
        ("a size that does not rule the error", deck, ("--size", "h"), "Cells elsewhere rule it"),
        ("a parameter that there is not", deck, ("--size", "hh"), "has no number 'hh'. There are: h, overlap, growth"),
        ("a parameter that is no size", deck, ("--size", "overlap"), "does not give a finer mesh"),
        ("a quantity that there is not", deck, ("--size", "h,growth", "--quantity", "contact.joint.force"), "no such number"),
        ("a time in no unit", deck, ("--time", "10 days"), "write it as 90, 90s, 10min or 2h"),
        ("an error of zero", deck, ("--error", 0), "between 0 and 1"),
        ("an adaptive deck", adaptive, (), "finds the mesh itself"),
        ("no deck", case.folder / "none.yaml", (), "none.yaml cannot be read"),
    ):
        status, text = case.run("plan", deck_path, *words, "--write", new, "--out", case.folder / "pilots", "--program",
                                case.program)
        case.expect(f"{name}: status 2 and a message", status == 2 and expected in text and "Traceback" not in text,
                    f"{status} {text}")
        case.expect(f"{name}: no deck", not new.exists())
    done = subprocess.run(["mpirun", "--oversubscribe", "-n", "2", case.program, "plan", str(deck)], capture_output=True, text=True, check=False,
                          timeout=100)
    case.expect("under mpirun: refused", done.returncode == 2 and "Call it without mpirun" in done.stderr, done.stderr)


class Page(html.parser.HTMLParser):
    """What a page holds, and whether its elements close."""

    VOID = {"img", "meta", "br", "link", "hr"}

    def __init__(self, text):
        super().__init__()
        self.open, self.images, self.addresses, self.headings, self.words, self.faults = [], [], [], [], "", []
        self.feed(text)
        self.close()
        if self.open:
            self.faults.append(f"never closed: {self.open}")

    def handle_starttag(self, tag, attributes):
        found = dict(attributes)
        self.addresses += [found[key] for key in ("src", "href", "srcset", "data", "action") if key in found]
        if tag == "img":
            self.images.append(found["src"])
        if tag not in self.VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        if not self.open or self.open.pop() != tag:
            self.faults.append(f"</{tag}> closes nothing")

    def handle_data(self, data):
        if self.open and self.open[-1] == "h2":
            self.headings.append(data)
        self.words += data


def expect_page(case, what, path):
    """A page that is well formed and needs nothing but itself."""
    text = path.read_text(encoding="utf-8")
    page = Page(text)
    case.expect(f"{what}: elements close", not page.faults, page.faults)
    case.expect(f"{what}: all addresses are inline data", all(item.startswith("data:image/") for item in page.addresses))
    case.expect(f"{what}: no address of a network", not re.search(r"(https?:)?//\w|@import|url\(", re.sub(
        r"data:image/png;base64,[A-Za-z0-9+/=]+", "", re.sub(r"<pre>.*?</pre>", "", text, flags=re.DOTALL))))
    return page


def report(case):
    """Pages of a whole run, of a study, and of folders that are unfinished, damaged or empty."""
    path = case.study_file(case.hertz({"mesh": {"mesh.parameters.h": [0.2]}}, repetitions=1))
    status, text = case.study(path)
    case.expect("a study to report on", status == 0, text)
    whole, = (case.folder / "results/small_study/variants").glob("*/results")
    status, text = case.run("report", whole)
    case.expect("a whole run: status 0", status == 0, text)
    page = expect_page(case, "a whole run", whole / "report.html")
    for heading in ("The scene", "Pictures", "Certificate", "Error budget", "Time budget", "Options and versions", "The deck"):
        case.expect(f"it has '{heading}'", heading in page.headings, page.headings)
    case.expect("deformed mesh, contact, pressure and histories", len(page.images) == 4, len(page.images))
    peak = json.loads((whole / "summary.json").read_text(encoding="utf-8"))
    for words in ("solved and certified", "penetration", "linear solver", "MUMPS", "block_top", peak["version"]):
        case.expect(f"it says '{words}'", words in page.words)

    status, text = case.run("report", case.folder / "results/small_study", "--out", case.folder / "study.html")
    case.expect("a study: status 0", status == 0, text)
    page = expect_page(case, "a study", case.folder / "study.html")
    case.expect("with its two pictures and words", len(page.images) == 2 and "cost least" in page.words, page.words)

    for name, spoil, status_wanted, words in (
        ("unfinished", lambda folder: (folder / "summary.json").unlink(), 0, "unfinished"),
        ("half the fields", lambda folder: (folder / "fields.h5").write_bytes(b"\x89HDF\r\n"), 0, "fields.h5 cannot be read"),
        ("nothing readable", lambda folder: [(folder / name).write_bytes(b'{"status') for name in
                                             ("summary.json", "fields.h5", "history.csv")], 2, "summary.json is damaged"),
        ("empty", lambda folder: [item.unlink() for item in folder.iterdir()], 2, "nothing to report on"),
    ):
        folder = case.folder / name
        shutil.copytree(whole, folder, ignore=shutil.ignore_patterns("report.html"))
        spoil(folder)
        status, text = case.run("report", folder)
        case.expect(f"{name}: status {status_wanted} and a message",
                    status == status_wanted and words in text and "Traceback" not in text, f"{status} {text}")
        if status_wanted == 0:
            case.expect(f"{name}: the page says so", words in expect_page(case, name, folder / "report.html").words)
        else:
            case.expect(f"{name}: no page", not (folder / "report.html").exists())
    status, text = case.run("report", case.folder / "nowhere")
    case.expect("no folder: status 2 and a message", status == 2 and "there is no folder" in text, text)


def browsed(case):
    """The page of a small run, as a browser without a window sees and prints it."""
    deck = load_deck("hertz_2d")
    deck["mesh"].update(file=str(TOP / "inputs/hertz_2d/hertz_2d.geo"), parameters={"h": 0.2, "overlap": 0.001})
    path = case.folder / "hertz.yaml"
    path.write_text(yaml.safe_dump(deck, sort_keys=False), encoding="utf-8")
    run_deck(case, path)
    browser.check_pages(case, case.folder / "hertz_run")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    cases = {"study": study, "resume": resume, "wrong_study": wrong_study, "effects": effects, "report": report,
             "plan": plan, "wrong_plan": wrong_plan, "bench": bench, "peers": peers, "memory": memory, "browser": browsed}
    parser.add_argument("case", choices=cases)
    parser.add_argument("--program", required=True)
    arguments = parser.parse_args()
    folder = tempfile.mkdtemp(prefix="amontons_scripts_")
    try:
        case = Case(arguments.program, folder)
        cases[arguments.case](case)
    finally:
        shutil.rmtree(folder)
    return case.status()


if __name__ == "__main__":
    sys.exit(main())
