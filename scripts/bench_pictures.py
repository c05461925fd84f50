"""Pictures of a bench: time and memory against unknowns, error against time, ranks, shares of the phases."""

from bench_file import OURS
from bench_table import PHASES
from figure_style import plt
from study_pictures import COLOURS, MARKERS


def label_of(row):
    return f"{row['solver'] or row['program']}" + (f", {row['ranks']} ranks" if row["ranks"] > 1 else "")


def curves(rows):
    """(label, rows with unknowns and a time) of everything that was run, by size."""
    found = {}
    for row in rows:
        if row.get("unknowns") and "cpu_seconds" in row:
            found.setdefault(label_of(row), []).append(row)
    return [(label, sorted(group, key=lambda row: row["unknowns"])) for label, group in found.items()]


def style(i):
    return {"marker": MARKERS[i % len(MARKERS)], "ms": 4, "color": COLOURS[i % len(COLOURS)], "lw": 1.2}


def growth(panel, rows, key, factor):
    for i, (label, group) in enumerate(curves(rows)):
        panel.loglog([row["unknowns"] for row in group], [factor * row[key] for row in group], label=label, **style(i))
    panel.set_xlabel("unknowns")


def error_panel(panel, rows):
    names = list(dict.fromkeys(key for row in rows for key in row if key.startswith("error_")))
    for i, (label, group) in enumerate(curves(rows)):
        good = [row for row in group if names and row.get(names[0], 0.0) > 0.0]
        if good:
            panel.loglog([row["cpu_seconds"] for row in good], [row[names[0]] for row in good], label=label, **style(i))
    panel.set_xlabel("CPU seconds")
    panel.set_ylabel(f"error of {names[0][6:].replace('_', ' ')}" if names else "error")


def shares_panel(panel, rows):
    """One bar for each size of the first solver on one rank."""
    ours = [row for row in rows if row["program"] == OURS and row["ranks"] == 1 and "share_output" in row]
    ours = sorted((row for row in ours if row["solver"] == ours[0]["solver"]), key=lambda row: row["unknowns"])
    bottom = [0.0] * len(ours)
    for i, name in enumerate(PHASES):
        parts = [100 * row[f"share_{name}"] for row in ours]
        panel.bar([f"{row['unknowns']:,}" for row in ours], parts, bottom=bottom, label=name, width=0.6,
                  color=COLOURS[i % len(COLOURS)])
        bottom = [low + part for low, part in zip(bottom, parts)]
    panel.set_ylabel("share of wall time, %")
    panel.set_xlabel(f"unknowns, {ours[0]['solver']}" if ours else "unknowns")
    panel.legend(fontsize=7, loc="center left", bbox_to_anchor=(1.0, 0.5))


def bench_figure(title, rows):
    figure, panels = plt.subplots(2, 2, figsize=(10.5, 7.5), layout="constrained")
    growth(panels[0][0], rows, "cpu_seconds", 1.0)
    panels[0][0].set_ylabel("CPU seconds")
    panels[0][0].legend(fontsize=7)
    growth(panels[0][1], rows, "memory_bytes", 1e-6)
    panels[0][1].set_ylabel("peak memory, MB")
    error_panel(panels[1][0], rows)
    shares_panel(panels[1][1], rows)
    figure.suptitle(title)
    return figure
