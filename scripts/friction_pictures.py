"""Pictures of friction: shear traction along an interface with its bound, stick and slip, hysteresis loops."""

import numpy as np

from figure_style import INK, plt

COLOURS = ["#1f5fa8", "#d9722c", "#3a8f6b", "#8a4fa3", "#b03a48", "#6b7480"]
STICK, SLIP = 1, 2


def frictional_pairs(fields):
    return [pair for pair in fields.pairs if fields.friction(pair) is not None]


def main_direction(points):
    """Unit vector of the resultant shear; where that vanishes (no pull from outside), of the largest shear."""
    shear = points["shear"]
    resultant = np.sum(points["weight"][:, None] * shear, axis=0)
    size = np.linalg.norm(shear, axis=1)
    if np.linalg.norm(resultant) < 1e-6 * np.sum(points["weight"] * size):
        resultant = shear[np.argmax(size)]
    length = np.linalg.norm(resultant)
    return resultant / length if length > 0.0 else np.eye(3)[0]


def along(points, dim):
    """Abscissa, its name and the points drawn in order: in 3D those within a strip through the middle of the pressure,
    along the shear, narrower than the distance of two rows of points."""
    places, pressed = points["places"], points["pressure"] > 0.0
    if dim == 2:
        axis = int(np.argmax(np.ptp(places[pressed], axis=0)))
        chosen, abscissa, name = np.arange(len(places)), places[:, axis], "xyz"[axis]
    else:
        share = points["pressure"] * points["weight"]
        centre = np.sum(share[:, None] * places, axis=0) / np.sum(share)
        direction = main_direction(points)
        abscissa = (places - centre) @ direction
        off = np.linalg.norm(places - centre - abscissa[:, None] * direction, axis=1)
        chosen = np.flatnonzero(off <= off[pressed].min() + 0.5 * np.sqrt(np.median(points["weight"][pressed])))
        axis = int(np.argmax(np.abs(direction)))
        if abs(direction[axis]) > 1.0 - 1e-6:
            abscissa, name = places[:, axis], "xyz"[axis]
        else:
            name = "distance along the shear"
    chosen = chosen[np.argsort(abscissa[chosen])]
    window = abscissa[pressed].min(), abscissa[pressed].max()
    return abscissa[chosen], name, chosen, window


def draw_shear(axes, points, dim, colour, label, marks):
    """Shear traction along its main direction, between the bounds; `marks`: every point by its status instead of a
    line."""
    if not (points["pressure"] > 0.0).any():
        axes.text(0.5, 0.5, "no contact", transform=axes.transAxes, ha="center")
        return
    at, name, chosen, window = along(points, dim)
    shear = (points["shear"] @ main_direction(points))[chosen]
    bound, status = points["tau_c"][chosen], points["status"][chosen]
    if marks:
        axes.fill_between(at, -bound, bound, color="#e9edf2", lw=0)
        axes.plot(at, points["pressure"][chosen], lw=1.0, color="#9aa4af", label="pressure")
        axes.plot(at, bound, "--", lw=0.9, color=INK, label="bound ± τ_c")
        axes.plot(at, -bound, "--", lw=0.9, color=INK)
        for state, text, mark in ((STICK, "shear, stick", COLOURS[0]), (SLIP, "shear, slip", COLOURS[1])):
            which = status == state
            if which.any():
                axes.plot(at[which], shear[which], ".", ms=3.5, color=mark, label=text)
    else:
        axes.plot(at, bound, "--", lw=0.8, color=colour)
        axes.plot(at, -bound, "--", lw=0.8, color=colour)
        axes.plot(at, shear, lw=1.3, color=colour, label=label)
    reach = 0.08 * (window[1] - window[0])
    axes.set_xlim(window[0] - reach, window[1] + reach)
    axes.set_xlabel(name)
    axes.set_ylabel("traction")


def friction_figure(fields, title):
    pairs = frictional_pairs(fields)[:4]
    figure, axes = plt.subplots(len(pairs), 1, squeeze=False, layout="constrained", figsize=(7.4, 1.0 + 3.3 * len(pairs)))
    for panel, pair in zip(axes.flat, pairs):
        draw_shear(panel, fields.friction(pair), fields.dim, None, None, marks=True)
        panel.set_title(pair)
    axes.flat[0].legend(fontsize=8, loc="best", markerscale=2)
    figure.suptitle(f"{title}\nfriction at t = {fields.time:.6g}", fontsize=11)
    return figure


def overlay_figure(runs, title):
    """Shear of the first frictional pair of several runs, as (label, Fields), over each other."""
    figure, axes = plt.subplots(figsize=(7.4, 4.6), layout="constrained")
    pair = frictional_pairs(runs[0][1])[0]
    for (label, fields), colour in zip(runs, COLOURS):
        points = fields.friction(pair)
        if points is None:
            raise ValueError(f"the run '{label}' has no friction in a pair '{pair}'")
        draw_shear(axes, points, fields.dim, colour, f"{label}, t = {fields.time:.6g}", marks=False)
    axes.legend(fontsize=8, loc="upper center", bbox_to_anchor=(0.5, -0.13), ncol=2)
    axes.set_title(f"{title}\nshear traction of {pair}; dashed: the bound ± τ_c", fontsize=10)
    return figure


def loops(columns):
    """(label, displacement, force) of every frictional pair along every direction, other than its main force's, in which
    history.csv has a displacement."""
    found = []
    for name in columns:
        if not name.endswith("_dissipation"):
            continue
        prefix = name.removesuffix("dissipation")
        force = {c: columns[f"{prefix}force_{c}"] for c in "xyz" if f"{prefix}force_{c}" in columns}
        normal = max(force, key=lambda c: np.mean(np.abs(force[c])))
        largest = max(np.abs(values).max() for values in force.values())
        for moved in columns:
            c = moved[-1]
            if (moved.startswith("displacement_") and c in force and c != normal and np.ptp(columns[moved]) > 0.0
                    and np.abs(force[c]).max() > 1e-6 * largest):
                label = f"{prefix.removeprefix('contact_').strip('_')} against {moved.removeprefix('displacement_')}"
                found.append((label.replace("_", " "), columns[moved], force[c]))
    return found


def hysteresis_figure(columns, title):
    figure, axes = plt.subplots(figsize=(6.4, 4.6), layout="constrained")
    for (label, moved, force), colour in zip(loops(columns), COLOURS):
        axes.plot(moved, force, lw=1.2, marker=".", ms=4, color=colour, label=label)
    axes.set_xlabel("displacement")
    axes.set_ylabel("tangential force")
    axes.legend(fontsize=8, loc="best")
    figure.suptitle(title, fontsize=11)
    return figure
