"""The table of a bench: what every run cost, as such and as a ratio to the yardsticks of the same size."""

import csv

from bench_file import ELASTIC, FRICTIONLESS, OURS
from study_analysis import median

# Phases of a run, put together to what a reader asks for.
PHASES = {
    "linear algebra": ("factorization", "linear solver"),
    "bulk assembly": ("bulk", "loads", "support", "pattern", "matrix"),
    "search and contact assembly": ("search", "contact"),
    "certificate": ("certificate", "error estimate"),
    "output": ("output",),
    "start": ("mesh", "set up", "rest"),
}


def shares(summary):
    """Share of the wall time of each group of PHASES."""
    seconds = summary.get("resources", {}).get("phase_seconds", {})
    total = sum(seconds.values())
    return {name: sum(seconds.get(phase, 0.0) for phase in phases) / total for name, phases in PHASES.items()} \
        if total > 0.0 else {}


def row_of(task, outcome):
    """Figures of one run; what is not known is absent."""
    summary = outcome.summary
    row = {"program": task.program, "solver": task.solver, "size": task.size, "ranks": task.variant.ranks,
           "outcome": outcome.word, "unknowns": outcome.unknowns}
    if outcome.cpu:
        row.update(cpu_seconds=median(outcome.cpu), wall_seconds=median(outcome.wall),
                   memory_bytes=median(outcome.memory), load=max(outcome.load))
        if outcome.unknowns:
            row["bytes_per_unknown"] = row["memory_bytes"] / outcome.unknowns
    for key, name in (("increments", "increments"), ("newton_iterations", "newton"), ("linear_iterations", "linear"),
                      ("outer_iterations", "outer"), ("factorizations", "factorizations")):
        if key in summary:
            row[name] = summary[key]
    for name, error in outcome.errors.items() if task.program not in (ELASTIC, FRICTIONLESS) else ():
        row[f"error_{name}"] = error
    for name, share in shares(summary).items():
        row[f"share_{name}"] = share
    return row


def add_ratios(rows):
    """CPU time against the yardsticks of the same size; wall time on one rank against that on several."""
    def first(size, **wanted):
        return next((row for row in rows if row["size"] == size and "cpu_seconds" in row
                     and all(row[key] == value for key, value in wanted.items())), None)

    for row in rows:
        if "cpu_seconds" not in row:
            continue
        for name in (ELASTIC, FRICTIONLESS, "calculix", "getfem"):
            other = first(row["size"], program=name)
            if other and row["program"] == OURS:
                row[f"cpu_to_{name}"] = row["cpu_seconds"] / other["cpu_seconds"]
        elastic = first(row["size"], program=ELASTIC)
        if elastic and row.get("increments") and row["program"] in (OURS, FRICTIONLESS):
            row["increment_to_elastic"] = row["cpu_seconds"] / row["increments"] / elastic["cpu_seconds"]
        alone = first(row["size"], program=row["program"], solver=row["solver"], ranks=1)
        if alone and row["ranks"] > 1:
            row["speed_up"] = alone["wall_seconds"] / row["wall_seconds"]


def write_table(path, rows):
    columns = list(dict.fromkeys(key for row in rows for key in row))
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, columns)
        writer.writeheader()
        for row in rows:
            writer.writerow({key: f"{value:.6g}" if isinstance(value, float) else value for key, value in row.items()})


def words(rows):
    """The table in lines for a terminal."""
    def cell(row, key, form):
        return format(row[key], form) if row.get(key) is not None else "–"

    lines = [f"{'program':<13}{'solver':<24}{'ranks':>5}{'unknowns':>10}{'CPU s':>9}{'MB':>7}{'newton':>7}{'linear':>8}"
             f"{'x elastic':>11}{'per incr.':>10}  outcome"]
    for row in rows:
        memory = f"{row['memory_bytes'] / 1e6:.0f}" if "memory_bytes" in row else "–"
        lines.append(f"{row['program']:<13}{row['solver']:<24}{row['ranks']:>5}{cell(row, 'unknowns', 'd'):>10}"
                     f"{cell(row, 'cpu_seconds', '.2f'):>9}{memory:>7}{cell(row, 'newton', 'd'):>7}"
                     f"{cell(row, 'linear', 'd'):>8}{cell(row, 'cpu_to_elastic', '.1f'):>11}"
                     f"{cell(row, 'increment_to_elastic', '.1f'):>10}  {row['outcome']}")
    return "\n".join(lines) + "\n"
