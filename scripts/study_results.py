"""Quantities of a study read from what its runs left behind, and how far they are from their references."""

import json
from dataclasses import dataclass, field

import numpy as np

from deck_edit import StudyError, get_value
from expressions import evaluate, names_in
from run_results import Fields, read_history
from study_analysis import extrapolate
from study_file import number

# Corners of a slave facet by element code: lines, triangles, quadrilaterals of any order.
CORNERS = {2: 2, 34: 2, 4: 3, 36: 3, 5: 4, 35: 4}


@dataclass
class Outcome:
    """What is known of a variant. Lists have one figure a finished run; `values` and `errors` one per quantity, except
    those in `missing`, with the reason. Errors are relative, those in `absolute` (their reference is zero) are not."""
    variant: object
    word: str
    message: str = ""
    cpu: list = field(default_factory=list)
    wall: list = field(default_factory=list)
    memory: list = field(default_factory=list)
    load: list = field(default_factory=list)
    summary: dict = field(default_factory=dict)
    names: dict = field(default_factory=dict)
    values: dict = field(default_factory=dict)
    errors: dict = field(default_factory=dict)
    absolute: set = field(default_factory=set)
    missing: dict = field(default_factory=dict)

    @property
    def solved(self):
        return self.word in ("certified", "not certified")

    @property
    def unknowns(self):
        counts = self.summary.get("scene", {}).get("unknowns", {})
        return sum(counts.values()) if counts else None


def gauss(corners):
    """Shape functions (points x corners), their derivatives (points x directions x corners) and weights on a reference
    line, triangle or quadrilateral; 5 points a direction. The triangle is the quadrilateral with one edge collapsed
    (Duffy), exact to degree 8."""
    s, w = np.polynomial.legendre.leggauss(5)
    s, w = 0.5 * (s + 1.0), 0.5 * w
    if corners == 2:
        return np.stack([1 - s, s], 1), np.tile([[[-1.0, 1.0]]], (5, 1, 1)), w
    a, b = (grid.ravel() for grid in np.meshgrid(s, s, indexing="ij"))
    weight = np.outer(w, w).ravel()
    one = np.ones_like(a)
    if corners == 4:
        shape = np.stack([(1 - a) * (1 - b), a * (1 - b), a * b, (1 - a) * b], 1)
        slopes = np.stack([np.stack([b - 1, 1 - b, b, -b], 1), np.stack([a - 1, -a, a, 1 - a], 1)], 1)
        return shape, slopes, weight
    xi, eta, weight = a, b * (1 - a), weight * (1 - a)
    slopes = np.stack([np.stack([-one, one, 0 * one], 1), np.stack([-one, 0 * one, one], 1)], 1)
    return np.stack([1 - xi - eta, xi, eta], 1), slopes, weight


def on_facets(places, elements, values):
    """Gauss points of a surface: places, interpolated nodal values (linear between corners) and weights."""
    found = []
    for code, nodes in elements.items():
        nodes = nodes[:, :CORNERS[code]]
        shape, slopes, weight = gauss(CORNERS[code])
        edges = np.einsum("qdn,enc->eqdc", slopes, places[nodes])
        area = np.linalg.norm(edges[:, :, 0], axis=2) if edges.shape[2] == 1 else \
            np.linalg.norm(np.cross(edges[:, :, 0], edges[:, :, 1]), axis=2)
        spots = np.einsum("qn,enc->eqc", shape, places[nodes])
        found.append((spots.reshape(-1, 3), (values[nodes] @ shape.T).ravel(), (area * weight).ravel()))
    return tuple(np.concatenate(parts) for parts in zip(*found))


def profile(results, argument, axisymmetric):
    """Places, values and weights of a field on a contact surface, at its quadrature points or between its nodes."""
    fields, pair = Fields(results / "fields.h5"), argument["pair"]
    with fields.file:
        return profile_of(fields, pair, argument, axisymmetric)


def profile_of(fields, pair, argument, axisymmetric):
    if pair not in fields.pairs:
        raise StudyError(f"there is no contact pair '{pair}' in the fields")
    if argument["at"] == "points":
        group = fields.step[f"points/{pair}"]
        if argument["field"] not in group:
            raise StudyError(f"there is no field '{argument['field']}' at the points of '{pair}'; there are "
                             + ", ".join(sorted(group)))
        values = np.asarray(group[argument["field"]])
        if values.ndim > 1 and values.shape[1] == 3:
            values = values[:, "xyz".index(argument["component"])] if "component" in argument else \
                np.linalg.norm(values, axis=1)
        return np.asarray(group["places"]), values.ravel(), np.ravel(group["weight"])
    surface = fields.surface(pair)
    if surface is None or argument["field"] not in fields.step[f"surfaces/{pair}"]:
        raise StudyError(f"there is no field '{argument['field']}' at the nodes of '{pair}'; take `at: points`")
    values = np.ravel(fields.step[f"surfaces/{pair}/{argument['field']}"])
    places, values, weights = on_facets(surface[0], surface[2], values)
    return places, values, weights * (2.0 * np.pi * places[:, 0] if axisymmetric else 1.0)


def read_scalar(kind, argument, summary, history):
    if kind == "summary":
        found = get_value(summary, argument)
        found = float(found) if isinstance(found, bool) else number(found)
        if found is None:
            raise StudyError(f"summary.json has no number at '{argument}'")
        return found
    if argument not in history:
        raise StudyError(f"history.csv has no column '{argument}'")
    return float(history[argument][-1])


def named_values(study, outcome, results):
    """Constants and scalar quantities of a run by name; what cannot be had goes to outcome.missing."""
    names = {}
    history = read_history(results / "history.csv")
    for quantity in study.quantities:
        if quantity.source[0] in ("summary", "history"):
            try:
                names[quantity.name] = read_scalar(*quantity.source, outcome.summary, history)
            except StudyError as error:
                outcome.missing[quantity.name] = str(error)
    for name, text in study.constants.items():
        if names_in(text) <= set(names):
            names[name] = evaluate(text, names)
    return names


def set_error(outcome, quantity, error, reference):
    """Relative to the reference or to the quantity's scale; with a reference of zero and no scale absolute."""
    scale = abs(evaluate(quantity.scale, outcome.names) if quantity.scale else reference)
    if scale == 0.0:
        outcome.absolute.add(quantity.name)
        scale = 1.0
    outcome.errors[quantity.name] = float(error / scale)


def measure(study, outcome, results):
    """Fills values, and errors against closed forms, of a solved variant."""
    names = outcome.names = named_values(study, outcome, results)
    for quantity in study.quantities:
        kind, argument = quantity.source
        try:
            if kind == "profile":
                places, values, weights = profile(results, argument, study.deck.get("space") == "axisymmetric")
                exact = evaluate(quantity.reference[1], {**names, **dict(zip("xyz", places.T))})
                error = np.sqrt(np.sum(weights * (values - exact)**2))
                set_error(outcome, quantity, error, np.sqrt(np.sum(weights * np.broadcast_to(exact, values.shape)**2)))
                outcome.values[quantity.name] = outcome.errors[quantity.name]
                continue
            value = names[quantity.name] if kind != "expression" else float(evaluate(argument, names))
            outcome.values[quantity.name] = value
            if quantity.reference and quantity.reference[0] == "exact":
                exact = float(evaluate(quantity.reference[1], names))
                set_error(outcome, quantity, abs(value - exact), exact)
        except (StudyError, KeyError, OSError, ValueError) as error:
            outcome.missing.setdefault(quantity.name, str(error).strip("'\""))


def compare_with_finest(study, outcomes):
    """Errors against the finest run of a sweep with Richardson's extrapolation. Returns, for each such quantity, the
    reference {value, uncertainty, order or None, sweep, closing: do the last runs get closer?}; nothing when all runs
    of the sweep have failed."""
    references = {}
    for quantity in study.quantities:
        if not quantity.reference or quantity.reference[0] != "finest":
            continue
        sweep = quantity.reference[1]
        knob, values = next((path, values) for path, values in study.sweeps[sweep].items() if len(values) > 1)
        runs = {number(outcome.variant.sweeps[sweep][knob]): outcome.values[quantity.name] for outcome in outcomes
                if sweep in outcome.variant.sweeps and quantity.name in outcome.values}
        order = [value for value in map(number, values) if value in runs]
        if not order:
            continue
        falling = number(values[0]) > number(values[-1])
        value, uncertainty, power = extrapolate([key if falling else 1.0 / key for key in order],
                                                [runs[key] for key in order])
        last = [runs[key] for key in order[-3:]]
        closing = len(last) < 3 or abs(last[2] - last[1]) <= abs(last[1] - last[0])
        references[quantity.name] = {"value": value, "uncertainty": uncertainty, "order": power, "sweep": sweep,
                                     "closing": closing}
        for outcome in outcomes:
            if quantity.name in outcome.values:
                set_error(outcome, quantity, abs(outcome.values[quantity.name] - value), value)
    return references


def read_outcome(study, variant, place, records):
    """All that is known of a variant after its runs."""
    last = records[max(records)] if records else {"outcome": "not run", "message": ""}
    failed = [record for record in records.values() if record["outcome"] not in ("certified", "not certified")]
    worst = failed[0] if failed else last
    outcome = Outcome(variant, worst["outcome"], worst["message"])
    for record in records.values():
        outcome.wall.append(record["wall_seconds"])
        outcome.load.append(record["load_average"])
        if "cpu_seconds" in record:
            outcome.cpu.append(record["cpu_seconds"])
            outcome.memory.append(record["peak_memory_bytes"])
    if outcome.solved:
        try:
            outcome.summary = json.loads((place / "results" / "summary.json").read_text(encoding="utf-8"))
            measure(study, outcome, place / "results")
        except (OSError, ValueError) as error:
            outcome.word, outcome.message = "damaged", f"its results cannot be read ({error})"
    return outcome
