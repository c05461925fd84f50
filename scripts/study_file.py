"""A study file as data: what is varied, what is measured, what it is compared with. Reads and checks, runs nothing."""

import copy
import itertools
import math
import re
from dataclasses import dataclass, field
from pathlib import Path

from deck_edit import StudyError, check_path, expand, get_value, nearest, read_yaml, set_value, split_path
from expressions import names_in

PLACES = {"x", "y", "z"}  # names that the closed form of a profile may use besides constants and quantities


@dataclass
class Quantity:
    """Something read from each run. `source` is (kind, argument): ("summary", path), ("history", column),
    ("expression", text) or ("profile", {pair, field, component, at}). `reference` is None, ("exact", text) or
    ("finest", sweep). `scale`: errors are divided by this instead of by the reference."""
    name: str
    label: str
    source: tuple
    reference: tuple | None = None
    scale: str | None = None


@dataclass
class Variant:
    """One deck to run. `knobs` is what sweeps set in it, path -> value; `sweeps` the sweeps that it belongs to, each
    with the values of that sweep's knobs."""
    deck: dict
    ranks: int
    knobs: dict
    sweeps: dict = field(default_factory=dict)


@dataclass
class Study:
    path: Path
    title: str
    deck_path: Path
    deck: dict
    ranks: int
    repetitions: int
    seed: int
    time_limit: float
    memory_limit: float | None
    constants: dict
    quantities: list
    sweeps: dict


def number(value):
    """A knob's value as a number, or None for words and tagged alternatives (YAML reads 1e-3 as a word)."""
    if isinstance(value, bool) or isinstance(value, (dict, list)) or value is None:
        return None
    try:
        found = float(value)
    except ValueError:
        return None
    return found if math.isfinite(found) else None


def short_value(value):
    """A value in few words: {penalty: {alpha: 10}} is penalty(alpha 10)."""
    if isinstance(value, dict):
        inside = ", ".join(f"{key} {short_value(item)}" if not isinstance(item, dict) else
                           key + (f"({short_value(item)})" if item else "") for key, item in value.items())
        return inside
    if isinstance(value, list):
        return "[" + ", ".join(map(short_value, value)) + "]"
    return f"{value:g}" if isinstance(value, float) else str(value)


def short_name(path):
    """The last key of a path; with the one before it where things of that name are many."""
    keys = [key for key in split_path(path.replace("[*]", "")) if isinstance(key, str)]
    if keys[-1] in ("alpha", "order", "tolerance") and keys[-2:-1] != ["mesh"]:
        return " ".join(keys[-2:])
    return keys[-1]


def setting_text(knobs):
    """Knobs and values in few words."""
    return ", ".join(short_value(value) if isinstance(value, dict) else f"{short_name(path)} {short_value(value)}"
                     for path, value in knobs.items()) or "the deck as it is"


class Reader:
    """Takes keys out of the maps of a study file; what is left over is unknown."""

    def __init__(self, path):
        self.path = path

    def fail(self, text):
        return StudyError(f"{self.path}: {text}")

    def only(self, where, content, known):
        if not isinstance(content, dict):
            raise self.fail(f"'{where}' must be a map of keys and values.")
        for key in content:
            if key not in known:
                place = f" in '{where}'" if where else ""
                raise self.fail(f"unknown key '{key}'{place}.{nearest(key, known)} Known: {', '.join(known)}.")

    def at_least(self, content, key, default, smallest, whole):
        value = number(content.get(key, default))
        if value is None or value < smallest or (whole and value != int(value)):
            raise self.fail(f"'{key}' must be a{' whole' if whole else ''} number of at least {smallest}, "
                            f"not {content[key]!r}.")
        return int(value) if whole else value


def read_quantity(reader, name, content, sweeps):
    where = f"quantities.{name}"
    if not re.fullmatch(r"[A-Za-z_]\w*", name) or name in PLACES | {"pi"}:
        raise reader.fail(f"'{where}': names of quantities are words of letters, digits and _ that expressions can "
                          "use, and not x, y, z or pi.")
    sources = ("summary", "history", "expression", "profile")
    reader.only(where, content, (*sources, "label", "reference", "scale"))
    given = [kind for kind in sources if kind in content]
    if len(given) != 1:
        raise reader.fail(f"'{where}' needs exactly one of {', '.join(sources)}; it has "
                          f"{' and '.join(given) if given else 'none'}.")
    kind, argument = given[0], content[given[0]]
    if kind == "profile":
        reader.only(where + ".profile", argument, ("pair", "field", "component", "at"))
        argument = {"field": "pressure", "at": "nodes", **argument}
        if "pair" not in argument or argument["at"] not in ("nodes", "points"):
            raise reader.fail(f"'{where}.profile' needs `pair`, and `at` is nodes or points.")
        if argument.get("component", "x") not in ("x", "y", "z"):
            raise reader.fail(f"'{where}.profile.component' is x, y or z.")
    elif not isinstance(argument, str):
        raise reader.fail(f"'{where}.{kind}' must be text.")
    reference = read_reference(reader, where, kind, content.get("reference"), sweeps)
    scale = content.get("scale")
    if scale is not None and reference is None:
        raise reader.fail(f"'{where}' has a scale but no reference to be off from.")
    return Quantity(name, str(content.get("label", name.replace("_", " "))), (kind, argument), reference,
                    None if scale is None else str(scale))


def read_reference(reader, where, kind, content, sweeps):
    if content is None:
        if kind == "profile":
            raise reader.fail(f"'{where}' is a profile, whose value is the L2 error: it needs `reference: "
                              "{exact: EXPRESSION}`.")
        return None
    reader.only(where + ".reference", content, ("exact", "finest"))
    if len(content) != 1:
        raise reader.fail(f"'{where}.reference' is either {{exact: EXPRESSION}} or {{finest: SWEEP}}.")
    (tag, argument), = content.items()
    if tag == "exact":
        return "exact", str(argument)
    if kind == "profile":
        raise reader.fail(f"'{where}': a profile can be compared with {{exact: ...}} only.")
    if argument not in sweeps:
        raise reader.fail(f"'{where}.reference.finest' names the sweep '{argument}', which is not there."
                          f"{nearest(argument, sweeps)}")
    varied = [path for path, values in sweeps[argument].items() if len(values) > 1]
    values = [number(value) for value in sweeps[argument][varied[0]]] if len(varied) == 1 else []
    if len(values) < 3 or None in values or min(values) <= 0 or \
            not (sorted(values) == values or sorted(values, reverse=True) == values):
        raise reader.fail(f"'{where}.reference.finest': the sweep '{argument}' must vary one knob only, with three or "
                          "more positive numbers from coarse to fine.")
    return "finest", argument


def read_sweeps(reader, content, deck, schema):
    """Sweeps as name -> {path: values}, every path known and every value set without undoing another."""
    if not isinstance(content, dict) or not content:
        raise reader.fail("'sweeps' must name at least one sweep: `sweeps: {mesh: {mesh.parameters.h: [0.2, 0.1]}}`.")
    for name, knobs in content.items():
        if not isinstance(knobs, dict) or not knobs:
            raise reader.fail(f"the sweep '{name}' has no knobs. Give it some, as in `{{mesh.order: [1, 2]}}`.")
        for path, values in knobs.items():
            if path != "ranks":
                check_path(deck, schema, path)
            if not isinstance(values, list) or not values:
                raise reader.fail(f"the knob '{path}' of the sweep '{name}' has no values. Give a list: [1, 2].")
            if any(values.count(value) > 1 for value in values):
                raise reader.fail(f"the knob '{path}' of the sweep '{name}' has the same value twice.")
            if path == "ranks" and any(number(value) not in range(1, 1025) for value in values):
                raise reader.fail(f"'ranks' of the sweep '{name}' must be whole numbers from 1 on.")
    return content


def vary(reader, deck, schema, sweep, knobs):
    """The deck with these knobs set. Errors: StudyError when one undoes another."""
    varied = copy.deepcopy(deck)
    places = [(path, whole, value) for path, value in knobs.items() if path != "ranks" for whole in expand(deck, path)]
    for _, whole, value in places:
        set_value(varied, schema, whole, value)
    for path, whole, value in places:
        if get_value(varied, whole) != value:
            others = setting_text({other: item for other, item in knobs.items() if other != path})
            raise reader.fail(f"the sweep '{sweep}' contradicts itself: '{path}' cannot be {short_value(value)} "
                              f"together with {others}.")
    return varied


def variants_of(study, schema):
    """All combinations of every sweep; what two sweeps share is one variant."""
    reader, found = Reader(study.path), []
    for name, sweep in study.sweeps.items():
        for values in itertools.product(*sweep.values()):
            knobs = dict(zip(sweep, values))
            deck, ranks = vary(reader, study.deck, schema, name, knobs), int(knobs.get("ranks", study.ranks))
            same = next((other for other in found if other.deck == deck and other.ranks == ranks), None)
            if same is None:
                same = Variant(deck, ranks, knobs)
                found.append(same)
            same.sweeps[name] = knobs
    return found


def check_names(reader, constants, quantities):
    """Expressions may use constants above them and quantities; an exact profile also x, y, z. (Order of evaluation:
    summary and history, constants, expressions, references.)"""
    measured = {quantity.name for quantity in quantities if quantity.source[0] in ("summary", "history")}
    both = measured & set(constants)
    if both:
        raise reader.fail(f"'{sorted(both)[0]}' is both a constant and a quantity. Rename one of them.")

    def check(where, text, known):
        for name in names_in(text):
            if name not in known:
                raise reader.fail(f"'{where}' uses the unknown name '{name}'.{nearest(name, known)}")

    known = set(measured)
    for name, text in constants.items():
        check(f"constants.{name}", text, known)
        known.add(name)
    for quantity in quantities:
        where = f"quantities.{quantity.name}"
        if quantity.source[0] == "expression":
            check(where, quantity.source[1], known)
        if quantity.reference and quantity.reference[0] == "exact":
            check(where + ".reference", quantity.reference[1],
                  known | (PLACES if quantity.source[0] == "profile" else set()))
        if quantity.scale:
            check(where + ".scale", quantity.scale, known)


def read_study(path, schema):
    """The study in a file, checked against the schema of decks. Errors: StudyError."""
    return study_of(path, read_yaml(path), schema)


def study_of(path, content, schema):
    """The study with this content; `path` is where its deck is found from and what messages name."""
    path, reader = Path(path), Reader(path)
    reader.only("", content, ("title", "deck", "ranks", "repetitions", "seed", "time_limit", "memory_limit", "settings",
                              "constants", "quantities", "sweeps"))
    for key in ("deck", "quantities", "sweeps"):
        if key not in content:
            raise reader.fail(f"the key '{key}' is missing.")
    deck_path = path.parent / str(content["deck"])
    deck = read_yaml(deck_path)
    settings = content.get("settings") or {}
    if not isinstance(settings, dict):
        raise reader.fail("'settings' must be a map of paths and values.")
    for knob in settings:
        check_path(deck, schema, knob)
    deck = vary(reader, deck, schema, "settings", settings)
    if not isinstance(content["quantities"], dict) or not content["quantities"]:
        raise reader.fail("'quantities' must name at least one quantity.")
    sweeps = read_sweeps(reader, content["sweeps"], deck, schema)
    quantities = [read_quantity(reader, str(name), item, sweeps) for name, item in content["quantities"].items()]
    constants = content.get("constants") or {}
    reader.only("constants", constants, tuple(constants) if isinstance(constants, dict) else ())
    check_names(reader, constants, quantities)
    limit = content.get("memory_limit")
    title = str(content.get("title", f"Study of {deck_path.name}"))
    return Study(path=path, title=title, deck_path=deck_path, deck=deck,
                 ranks=reader.at_least(content, "ranks", 1, 1, True),
                 repetitions=reader.at_least(content, "repetitions", 3, 1, True),
                 seed=reader.at_least(content, "seed", 1, 0, True),
                 time_limit=reader.at_least(content, "time_limit", 600, 0.01, False),
                 memory_limit=None if limit is None else reader.at_least(content, "memory_limit", 0, 1, False),
                 constants=constants, quantities=quantities, sweeps=sweeps)
