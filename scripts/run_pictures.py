"""Pictures of a run's history, and the list of all pictures that a folder of results has something for."""

import json
import math
import os

import numpy as np

from contact_figures import pressure_figure
from figure_style import BLUE, ORANGE, plt
from friction_pictures import friction_figure, frictional_pairs, hysteresis_figure, loops, overlay_figure
from mesh_figures import mesh_figure, zoom_window
from run_results import Fields, read_history, read_label


def history_panels(columns):
    """Panels as (title, [(label, values)]): columns that speak of the same thing, those that stay zero left out."""
    def chosen(test, label):
        found = [(label(name), values) for name, values in columns.items() if name != "time" and test(name)]
        return [(text, values) for text, values in found if np.nanmax(np.abs(values), initial=0.0) > 0.0]

    def contact(quantity):
        return chosen(lambda name: name.startswith("contact_") and name.endswith("_" + quantity),
                      lambda name: name[len("contact_"):-len(quantity) - 1])

    forces = chosen(lambda name: name.startswith("contact_") and "_force_" in name,
                    lambda name: name[len("contact_"):].replace("_force_", " "))
    largest = max((np.nanmax(np.abs(values)) for _, values in forces), default=0.0)
    panels = [
        ("contact force", [(label, values) for label, values in forces
                           if np.nanmax(np.abs(values)) > 1e-6 * largest]),
        ("largest contact pressure", contact("max_pressure")),
        ("contact area", contact("area")),
        ("largest penetration", contact("penetration")),
        ("reactions", chosen(lambda name: name.startswith("reaction_"), lambda name: name[len("reaction_"):])),
        ("energies", chosen(lambda name: name.startswith("energy_") or name == "dissipation",
                            lambda name: name.removeprefix("energy_").replace("_", " "))),
        ("iterations", chosen(lambda name: name.split("_")[0] in ("newton", "linear", "outer"),
                              lambda name: name.replace("_", " "))),
        ("displacement of tied groups and rigid masters", chosen(lambda name: name.startswith("displacement_"),
                                               lambda name: name[len("displacement_"):])),
    ]
    return [(name, lines) for name, lines in panels if lines]


def history_figure(columns, title):
    panels = history_panels(columns)
    if not panels:
        raise ValueError("it has no column that can be drawn")
    wide = min(3, len(panels))
    rows = math.ceil(len(panels) / wide)
    figure, axes = plt.subplots(rows, wide, squeeze=False, layout="constrained", figsize=(3.9 * wide, 2.7 * rows + 0.5))
    colours = [BLUE, ORANGE, "#3a8f6b", "#8a4fa3", "#b03a48", "#6b7480"]
    for panel, (name, lines) in zip(axes.flat, panels):
        for i, (label, values) in enumerate(lines[:len(colours)]):
            marker = "." if len(values) <= 60 else ""
            panel.plot(columns["time"], values, lw=1.2, marker=marker, ms=4, color=colours[i], label=label)
        panel.set_title(name + (f" (6 of {len(lines)})" if len(lines) > len(colours) else ""))
        panel.set_xlabel("t")
        if name == "iterations":
            panel.set_ylim(bottom=0.0)
            panel.yaxis.get_major_locator().set_params(integer=True)
        panel.legend(fontsize=7.5, loc="best")
    for panel in axes.flat[len(panels):]:
        panel.axis("off")
    figure.suptitle(title)
    return figure


def read_title(results, say):
    """What the run is called, and whether it came to a good end, for the head of every picture."""
    try:
        with open(os.path.join(results, "summary.json"), encoding="utf-8") as file:
            summary = json.load(file)
        if not isinstance(summary, dict):
            raise ValueError("it does not hold keys and values")
    except (OSError, ValueError) as error:
        say(f"no summary.json to read ({error}); pictures are titled by the directory")
        return os.path.basename(os.path.abspath(results))
    title = summary.get("title") or os.path.basename(os.path.abspath(results))
    outcome = summary.get("outcome") or f"status {summary.get('status')}"
    return title if summary.get("status") in (None, 0) else f"{title} [{outcome}]"


def pictures(results, title, say, others=()):
    """(file name, function that makes the figure) of what can be drawn; `say` is told what is missing. `others`: folders
    of further runs to lay over this one."""
    path = os.path.join(results, "fields.h5")
    try:
        fields = Fields(path)
    except (OSError, ValueError, KeyError) as error:
        say(f"no fields: {path} cannot be read ({error}); no mesh and no pressure is drawn")
    else:
        if fields.mises is None:
            say("no von Mises stress in the fields (deck: `output: {fields: [stress, ...]}`)")
        yield "deformed.png", lambda: mesh_figure(fields, title)
        window = zoom_window(fields)
        if window is None:
            say("nothing is in contact at the last step; no picture near the contact")
        else:
            yield "contact.png", lambda: mesh_figure(fields, title, window)
        if fields.pairs:
            yield "pressure.png", lambda: pressure_figure(fields, title)
        else:
            say("no contact pair in the fields; no pressure is drawn")
        if frictional_pairs(fields):
            yield "friction.png", lambda: friction_figure(fields, title)
            if others:
                runs = [(read_label(run), Fields(os.path.join(run, "fields.h5"))) for run in (results, *others)]
                yield "overlay.png", lambda: overlay_figure(runs, title)
    path = os.path.join(results, "history.csv")
    try:
        columns = read_history(path)
    except (OSError, ValueError) as error:
        say(f"no history: {path} cannot be read ({error})")
    else:
        yield "history.png", lambda: history_figure(columns, title)
        if loops(columns):
            yield "hysteresis.png", lambda: hysteresis_figure(columns, title)
