"""How a run's increments converge and what its history keeps: orders of convergence, balance of work, two runs apart."""

import re

import numpy as np

# Residuals below this many times the smallest of a run are near rounding, and say nothing of convergence.
ROUNDING = 100.0
# Columns of a history that count work instead of describing the state.
COUNTS = ("time", "newton", "linear", "outer", "remedy", "residual", "certified")


def accepted_residuals(terminal):
    """Residual norms of the solve that each accepted increment ended with."""
    found, norms = [], []
    for line in terminal.read_text(encoding="utf-8").splitlines():
        norm = re.match(r"\s*(\d+) SNES Function norm (\S+)", line)
        if norm:
            norms = [*norms, float(norm[2])] if int(norm[1]) else [float(norm[2])]
        elif re.match(r"\s+\S+\s+t = \S+\s+newton", line):
            found.append(norms)
    return found


def tail(norms, floor):
    """Order and last reduction, or None where fewer than three residuals are above rounding."""
    above = [norm for norm in norms if norm > floor]
    if len(above) < 3 or not above[-1] < above[-2] < above[-3]:
        return None
    first, second = np.log(above[-2] / above[-3]), np.log(above[-1] / above[-2])
    return second / first, above[-1] / above[-2]


def tails(solves):
    """Medians of both over all increments; NaN where there are none."""
    floor = ROUNDING * min(norms[-1] for norms in solves)
    found = [pair for pair in (tail(norms, floor) for norms in solves) if pair]
    return np.median(found, axis=0) if found else (np.nan, np.nan)


def apart(one, other):
    """How far two histories are apart; where increments differ, at the times of the first, the second's interpolated."""
    forces = [name for name in one if name.startswith("reaction") or "_force_" in name or "_shear_" in name]
    largest_force = max(np.abs(one[name]).max() for name in forces)
    worst = 0.0
    for name in one:
        scale = largest_force if name in forces else np.abs(one[name]).max()
        if name not in COUNTS and scale > 0:
            worst = max(worst, np.abs(one[name] - np.interp(one["time"], other["time"], other[name])).max() / scale)
    return worst


def unbalanced(history):
    """Largest difference of the work put in and what is stored and dissipated, of the largest work."""
    work = history["energy_external_work"]
    return np.abs(work - history["energy_stored"] - history["energy_dissipated"]).max() / np.abs(work).max()
