"""The bench file: which sizes, solvers and ranks of a deck are run, and against which yardsticks."""

import copy
from dataclasses import dataclass
from pathlib import Path

from deck_edit import get_value, read_yaml, remove_value, set_value, split_path
from study_effects import friction_of_pairs
from study_file import Reader, Variant, number, study_of

PEERS = ("calculix", "getfem")
OURS, ELASTIC, FRICTIONLESS = "amontons", "elastic", "frictionless"


@dataclass
class Task:
    """One line of the table. `variant` is a deck to run; a peer solves that deck by its own means."""
    program: str  # OURS, ELASTIC, FRICTIONLESS or one of PEERS
    solver: str
    size: float
    variant: Variant


@dataclass
class Bench:
    study: object  # title, deck, constants, quantities, limits, as of a study
    knob: str      # path of the size
    tasks: list


def elastic_deck(deck, schema, settings):
    """The deck without contact, one increment to where the last step ends: one linear solve on the same mesh."""
    deck = copy.deepcopy(deck)
    remove_value(deck, "contact")
    deck["steps"] = [{"name": "solve", "to": deck["steps"][-1]["to"], "increments": 1}]
    for path, value in settings.items():
        set_value(deck, schema, path, value)
    return deck


def frictionless_deck(deck):
    """The deck without friction, or None where there is none."""
    deck = copy.deepcopy(deck)
    paths = [path for _, paths in friction_of_pairs(deck) for path in paths]
    for path in paths:
        if get_value(deck, path) is not None:
            remove_value(deck, path)
    return deck if paths else None


def read_settings(reader, where, content):
    if content is None:
        return {}
    reader.only(where, content, tuple(content) if isinstance(content, dict) else ())
    for path in content:
        split_path(path)
    return content


def read_sizes(reader, content):
    """The knob, and its numbers."""
    if not isinstance(content, dict) or len(content) != 1:
        raise reader.fail("'size' names one key of the deck and its values: `size: {mesh.parameters.n: [4, 6, 9]}`.")
    (knob, values), = content.items()
    if not isinstance(values, list) or not values or None in [number(value) for value in values]:
        raise reader.fail(f"'size.{knob}' must be a list of numbers.")
    return knob, values


def tasks_of_size(content, reader, schema, deck, knob, size):
    """What is run for one size: all solvers on all ranks, yardsticks and peers on one."""
    deck = copy.deepcopy(deck)
    set_value(deck, schema, knob, size)
    tasks = []
    for name, settings in content["solvers"].items():
        varied = copy.deepcopy(deck)
        for path, value in read_settings(reader, f"solvers.{name}", settings).items():
            set_value(varied, schema, path, value)
        for ranks in content.get("ranks", [1]):
            tasks.append(Task(OURS, name, size, Variant(varied, int(ranks), {knob: size, "solver": name, "ranks": ranks})))
    elastic = elastic_deck(deck, schema, read_settings(reader, "elastic", content.get("elastic")))
    tasks.append(Task(ELASTIC, "", size, Variant(elastic, 1, {knob: size, "yardstick": ELASTIC})))
    smooth = frictionless_deck(deck)
    if smooth is not None:
        tasks.append(Task(FRICTIONLESS, "", size, Variant(smooth, 1, {knob: size, "yardstick": FRICTIONLESS})))
    for peer, settings in (content.get("peers") or {}).items():
        if size in (settings or {}).get("sizes", [size]):
            tasks.append(Task(peer, "", size, Variant(deck, 1, {knob: size, "peer": peer})))
    return tasks


def read_bench(path, schema):
    """The bench in a file, checked against the schema of decks. Errors: StudyError."""
    path = Path(path)
    content, reader = read_yaml(path), Reader(path)
    own = ("size", "solvers", "ranks", "elastic", "peers")
    for key in ("deck", "quantities", "size", "solvers"):
        if key not in content:
            raise reader.fail(f"the key '{key}' is missing.")
    knob, sizes = read_sizes(reader, content["size"])
    reader.only("solvers", content["solvers"], tuple(content["solvers"]))
    peers = content.get("peers") or {}
    reader.only("peers", peers, PEERS)
    for name, settings in peers.items():
        reader.only(f"peers.{name}", settings or {}, ("sizes",))
    shared = {key: value for key, value in content.items() if key not in own}
    study = study_of(path, {"repetitions": 1, **shared, "sweeps": {"size": {knob: sizes}}}, schema)
    tasks = [task for size in sizes for task in tasks_of_size(content, reader, schema, study.deck, knob, size)]
    return Bench(study, knob, tasks)
