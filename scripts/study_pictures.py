"""Pictures of a study: error against time with the Pareto front, and errors, time and iterations over every knob."""

import math

from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from figure_style import BLUE, INK, ORANGE, plt
from study_analysis import median
from study_file import number, setting_text, short_name, short_value
from study_words import comparable, front_of, groups, is_absolute, main_knob

COLOURS = [BLUE, ORANGE, "#3a8f6b", "#8a4fa3", "#b03a48", "#6b7480", "#a0792c", "#2c8fa0"]
MARKERS = "osD^v<>P"
LINES = ["-", "--", ":", "-."]
MAX_PANELS, MAX_SWEEPS = 6, 8
DECADES = 6  # shown of an error; what lies farther below is round-off and would press the rest together


def points(panel, outcomes, quantity, colour, marker, label):
    """Error against CPU time with the range of repetitions; hollow where the certificate has failed."""
    for certified in (True, False):
        chosen = [outcome for outcome in outcomes if (outcome.word == "certified") == certified
                  and outcome.solved and outcome.cpu and outcome.errors.get(quantity.name, 0.0) > 0.0]
        if not chosen:
            continue
        x = [median(outcome.cpu) for outcome in chosen]
        ranges = [[value - min(outcome.cpu) for value, outcome in zip(x, chosen)],
                  [max(outcome.cpu) - value for value, outcome in zip(x, chosen)]]
        panel.errorbar(x, [outcome.errors[quantity.name] for outcome in chosen], xerr=ranges, fmt=marker, ms=5,
                       color=colour, mfc=colour if certified else "white", elinewidth=0.8, lw=0,
                       label=label if certified else f"{label}, not certified")


def plain_seconds(axis):
    """Times on a logarithmic axis as 0.5, 1, 2, 5, ..."""
    axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axis.set_major_formatter(FuncFormatter(lambda seconds, _: f"{seconds:g}"))
    axis.set_minor_formatter(NullFormatter())


def cut_round_off(panel):
    low, high = panel.get_ylim()
    panel.set_ylim(max(low, high / 10.0**DECADES), high)


def draw_front(panel, front, quantity):
    front = [outcome for outcome in front if outcome.errors[quantity.name] > 0.0]
    if not front:
        return
    x, y = [median(outcome.cpu) for outcome in front], [outcome.errors[quantity.name] for outcome in front]
    panel.plot(x, y, drawstyle="steps-post", color=INK, lw=0.9, zorder=1, label="Pareto front")
    # Below and left of the front there is nothing, so there is room for words; a gain of less than a tenth gets none.
    named = float("inf")
    for cost, error, outcome in zip(x, y, front):
        if error > 0.9 * named:
            continue
        named = error
        panel.plot([cost], [error], "o", ms=10, mfc="none", mec=INK, mew=0.8)
        panel.annotate(setting_text(outcome.variant.knobs), (cost, error), (-7, -7), textcoords="offset points",
                       ha="right", va="top", fontsize=6.5)


def error_time_figure(study, outcomes):
    """One panel a quantity with a reference: error against CPU time. Errors of exactly zero cannot be shown."""
    quantities = [quantity for quantity in study.quantities if quantity.reference and comparable(outcomes, quantity)]
    quantities = quantities[:MAX_PANELS]
    if not quantities:
        return None
    wide = min(2, len(quantities))
    rows = math.ceil(len(quantities) / wide)
    figure, panels = plt.subplots(rows, wide, squeeze=False, layout="constrained",
                                  figsize=(5.6 * wide, 4.3 * rows + 0.4))
    for panel, quantity in zip(panels.flat, quantities):
        left = list(outcomes)
        for i, name in enumerate(study.sweeps):
            mine = [outcome for outcome in left if name in outcome.variant.sweeps]
            left = [outcome for outcome in left if name not in outcome.variant.sweeps]
            points(panel, mine, quantity, COLOURS[i % len(COLOURS)], MARKERS[i % len(MARKERS)], name)
        draw_front(panel, front_of(outcomes, quantity), quantity)
        panel.set_xscale("log")
        panel.set_yscale("log")
        low, high = panel.get_xlim()
        panel.set_xlim(low * (low / high)**0.35, high)
        plain_seconds(panel.xaxis)
        cut_round_off(panel)
        panel.set_xlabel("CPU time in s, all ranks (median and range)")
        panel.set_ylabel("absolute error" if is_absolute(outcomes, quantity) else "relative error")
        panel.set_title(quantity.label)
    for panel in panels.flat[len(quantities):]:
        panel.axis("off")
    panels.flat[0].legend(fontsize=7, loc="upper right")
    figure.suptitle(study.title)
    return figure


def error_cost_figure(study, outcomes):
    """A row a quantity with a reference: its error against unknowns and against CPU time, a line for each sweep."""
    quantities = [quantity for quantity in study.quantities if quantity.reference and comparable(outcomes, quantity)]
    quantities = quantities[:MAX_PANELS]
    if not quantities:
        return None
    costs = {"displacement and contact unknowns": lambda outcome: outcome.unknowns,
             "CPU time in s, all ranks": lambda outcome: median(outcome.cpu)}
    figure, panels = plt.subplots(len(quantities), 2, squeeze=False, layout="constrained",
                                  figsize=(11.2, 3.6 * len(quantities) + 0.4))
    for row, quantity in zip(panels, quantities):
        for panel, (label, cost) in zip(row, costs.items()):
            for i, name in enumerate(study.sweeps):
                mine = sorted((cost(outcome), outcome.errors[quantity.name]) for outcome in comparable(outcomes, quantity)
                              if name in outcome.variant.sweeps and outcome.errors[quantity.name] > 0.0)
                if mine:
                    panel.plot(*zip(*mine), LINES[i % len(LINES)], marker=MARKERS[i % len(MARKERS)], ms=5, lw=1.0,
                               color=COLOURS[i % len(COLOURS)], label=name)
            panel.set_xscale("log")
            panel.set_yscale("log")
            cut_round_off(panel)
            panel.set_xlabel(label)
            panel.set_ylabel("absolute error" if is_absolute(outcomes, quantity) else "relative error")
            panel.set_title(quantity.label)
            panel.grid(alpha=0.3)
    panels.flat[0].legend(fontsize=8)
    figure.suptitle(study.title)
    return figure


def knob_axis(panel, knob, values):
    """Numbers on a logarithmic axis when they are positive, words one after the other. Returns value -> abscissa."""
    numbers = [number(value) for value in values]
    panel.set_xlabel(short_name(knob))
    if None not in numbers:
        if min(numbers) > 0.0:
            panel.set_xscale("log")
        panel.set_xticks(numbers, [short_value(value) for value in values], fontsize=7.5)
        panel.minorticks_off()
        return dict(zip(map(repr, values), numbers))
    panel.set_xticks(range(len(values)), [short_value(value).replace("(", "\n(") for value in values], fontsize=7)
    panel.set_xlim(-0.5, len(values) - 0.5)
    return {repr(value): i for i, value in enumerate(values)}


def draw_lines(panel, places, found, curves):
    """Curves (colour, outcome -> value, outcome -> range or None) of every group; a group has its own kind of line."""
    for g, (_, members) in enumerate(found):
        for colour, value_of, range_of in curves:
            drawn = [(places[repr(value)], outcome) for value, outcome in members if (value_of(outcome) or 0.0) > 0.0]
            x = [place for place, _ in drawn]
            panel.plot(x, [value_of(outcome) for _, outcome in drawn], ls=LINES[g % len(LINES)],
                       marker=MARKERS[g % len(MARKERS)], ms=3.5, lw=1.2, color=colour)
            if range_of and drawn:
                panel.vlines(x, *zip(*(range_of(outcome) for _, outcome in drawn)), color=colour, lw=0.8)
    panel.set_yscale("log")


def mark_failures(panel, places, knob, name, outcomes):
    """A cross at the top for every variant of the sweep that has not come to its end."""
    failed = [places[repr(outcome.variant.sweeps[name][knob])] for outcome in outcomes
              if name in outcome.variant.sweeps and not outcome.solved]
    panel.plot(failed, [0.96] * len(failed), "x", ms=6, color="#b03a48", transform=panel.get_xaxis_transform())


def linear_iterations(outcome):
    """Iterations of the linear solver, where it has any to count: a direct one has as many as Newton."""
    counts = outcome.summary.get("linear_iterations"), outcome.summary.get("newton_iterations")
    return counts[0] if counts[0] != counts[1] else None


def key(panel, entries, **where):
    """A legend of lines that stand for (label, style)."""
    panel.legend(handles=[Line2D([], [], label=label, **style) for label, style in entries], fontsize=7, **where)


def knobs_figure(study, outcomes):
    """A column a sweep: errors, CPU time and iterations over its main knob."""
    names = [name for name in study.sweeps if groups(study, outcomes, name)][:MAX_SWEEPS]
    if not names:
        return None
    width = max(3.0 * len(names), 5.0)
    figure = plt.figure(figsize=(width, 8.4), layout="constrained")
    above, below = figure.subfigures(2, 1, height_ratios=[16, 1])
    panels = above.subplots(3, len(names), squeeze=False, sharey="row")
    with_error = [quantity for quantity in study.quantities if quantity.reference]
    errors = [(COLOURS[i % len(COLOURS)], lambda outcome, name=quantity.name: outcome.errors.get(name), None)
              for i, quantity in enumerate(with_error)]
    newton = "#3a8f6b", lambda outcome: outcome.summary.get("newton_iterations"), None
    rows = [("error", errors),
            ("CPU time in s (median, range)", [(INK, lambda outcome: median(outcome.cpu),
                                                lambda outcome: (min(outcome.cpu), max(outcome.cpu)))]),
            ("iterations of the run", [newton, (ORANGE, linear_iterations, None)])]
    for i, name in enumerate(names):
        knob, found = main_knob(study.sweeps[name]), groups(study, outcomes, name)
        for panel, (label, curves) in zip(panels[:, i], rows):
            places = knob_axis(panel, knob, study.sweeps[name][knob])
            draw_lines(panel, places, found, curves)
            mark_failures(panel, places, knob, name, outcomes)
            panel.set_ylabel("" if i else label)
        panels[0, i].set_title(f"sweep '{name}'")
        if len(found) > 1:
            key(panels[1, i], [(setting_text(others), {"color": INK, "ls": LINES[g % len(LINES)],
                                                       "marker": MARKERS[g % len(MARKERS)], "ms": 3.5})
                               for g, (others, _) in enumerate(found)], loc="best")
    plain_seconds(panels[1, 0].yaxis)
    cut_round_off(panels[0, 0])
    key(panels[2, 0], [("Newton", {"color": newton[0]}), ("linear", {"color": ORANGE})], loc="upper left")
    key(below, [(f"error of {quantity.label}", {"color": curve[0]}) for quantity, curve in zip(with_error, errors)]
        + [("failed", {"color": "#b03a48", "marker": "x", "ls": ""})], loc="center",
        ncols=max(2, min(5, int(width / 2.5))))
    figure.suptitle(study.title)
    return figure
