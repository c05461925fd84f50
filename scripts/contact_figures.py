"""Pictures of the contact surface, along it (2D) or as a map (3D)."""

import math

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.tri import Triangulation

from figure_style import BLUE, FAINT, INK, MAX_LINED_CELLS, ORANGE, PRESSURE_MAP, plt
from mesh_figures import cell_edges
from run_results import LINE, PLANE

MAX_PANELS = 12


def polylines(elements):
    """Chains of nodes made of line elements that share ends; a closed curve begins anywhere."""
    following = {}
    for code, lines in elements.items():
        for line in lines[:, LINE[code][1]]:
            following[line[0]] = line
    starts = set(following) - {line[-1] for line in following.values()}
    chains = []
    while following:
        start = starts.pop() if starts else next(iter(following))
        chain = [start]
        while chain[-1] in following:
            chain.extend(following.pop(chain[-1])[1:])
        chains.append(chain)
    return chains


def along_surface(places, chain, pressure):
    """Abscissa of the nodes of a chain: a coordinate where the part under pressure is a graph over it, or the
    arc length."""
    line = places[chain]
    touching = np.nan_to_num(pressure[chain]) > 1e-3 * max(np.nanmax(pressure, initial=0.0), 1e-300)
    part = line[touching] if touching.sum() > 1 else line
    axis = int(np.argmax(np.ptp(part[:, :2], axis=0)))
    steps = np.diff(part[:, axis])
    if (steps > 0).all() or (steps < 0).all():
        return line[:, axis], "xy"[axis], lambda spots: spots[:, axis]
    lengths = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1)))

    def project(spots):
        """Arc length of spots on the chain: each on the segment that it is nearest to."""
        found = []
        for spot in spots:
            begins, edges = line[:-1], np.diff(line, axis=0)
            share = np.clip(((spot - begins) * edges).sum(1) / np.maximum((edges**2).sum(1), 1e-300), 0.0, 1.0)
            distance = np.linalg.norm(begins + share[:, None] * edges - spot, axis=1)
            k = int(np.argmin(distance))
            found.append(lengths[k] + share[k] * (lengths[k + 1] - lengths[k]))
        return np.array(found)

    return lengths, "arc length along the surface", project


def draw_pressure_line(axes, fields, pair):
    surface, points = fields.surface(pair), fields.points(pair)
    axes.set_title(pair)
    axes.set_ylabel("contact pressure")
    if surface is None or surface[3] is None:
        axes.text(0.5, 0.5, "no nodal pressure", transform=axes.transAxes, ha="center")
        return
    places, _, elements, pressure = surface
    chains = polylines(elements)
    chain = max(chains, key=lambda nodes: (np.nansum(np.nan_to_num(pressure[nodes])), len(nodes)))
    abscissa, label, project = along_surface(places, chain, pressure)
    under = []
    if points is not None and points[1] is not None and len(points[0]):
        spots, at_points, status = points[:3]
        where = project(spots)
        open_ = (status == 0) if status is not None else at_points <= 0.0
        axes.plot(where[open_], at_points[open_], ".", ms=2.5, color=FAINT, label="quadrature points, open")
        axes.plot(where[~open_], at_points[~open_], ".", ms=3.5, color=ORANGE, label="quadrature points in contact")
        under = list(where[~open_])
    axes.plot(abscissa, pressure[chain], "-", lw=1.3, color=BLUE, label="nodes", zorder=3)
    under += list(abscissa[np.nan_to_num(pressure[chain]) > 1e-3 * np.nanmax(pressure, initial=0.0)])
    if under and max(under) > min(under):
        margin = 0.6 * (max(under) - min(under))
        axes.set_xlim(max(min(under) - margin, abscissa.min()), min(max(under) + margin, abscissa.max()))
    axes.set_xlabel(label)
    axes.set_ylim(bottom=min(0.0, 1.05 * np.nanmin(pressure[chain])))


def symmetric_centre(fields, places, pressure):
    """The pressure's centroid; in directions where the zone is cut by the end of the model (a quarter model's planes of
    symmetry) that end."""
    touching = pressure > 1e-3 * pressure.max()
    zone = places[touching]
    centre = (pressure[touching, None] * zone).sum(0) / pressure[touching].sum()
    low, high = fields.places.min(axis=0), fields.places.max(axis=0)
    reach = 0.02 * np.ptp(zone, axis=0).max() + 1e-12 * np.ptp(fields.places, axis=0).max()
    for i in range(3):
        at_low, at_high = zone[:, i].min() - low[i] <= reach, high[i] - zone[:, i].max() <= reach
        if at_low != at_high and np.ptp(zone[:, i]) > 5.0 * reach:
            centre[i] = low[i] if at_low else high[i]
    return centre


def draw_pressure_map(figure, axes, radial, fields, pair):
    axes.set_title(pair)
    surface, points = fields.surface(pair), fields.points(pair)
    if surface is None or surface[3] is None or not np.nan_to_num(surface[3]).max(initial=0.0) > 0.0:
        for panel in (axes, radial):
            panel.text(0.5, 0.5, "no contact", transform=panel.transAxes, ha="center")
        return
    places, _, elements, pressure = surface
    known = np.nan_to_num(pressure)
    centre = symmetric_centre(fields, places, known)
    touching = known > 1e-3 * known.max()
    # The map's plane: across the direction in which the zone under pressure is thinnest.
    _, _, directions = np.linalg.svd(places[touching] - places[touching].mean(axis=0), full_matrices=True)
    normal = int(np.argmax(np.abs(directions[2])))
    kept = [i for i in range(3) if i != normal]
    tiles = np.concatenate([nodes[:, tile] for code, nodes in elements.items() for tile in PLANE[code][1]])
    flat = places[:, kept]
    mesh = axes.tripcolor(Triangulation(*flat.T, tiles), known, shading="gouraud", cmap=PRESSURE_MAP, vmin=0.0,
                          rasterized=True)
    bar = figure.colorbar(mesh, ax=axes, fraction=0.045, pad=0.02)
    bar.set_label("contact pressure")
    bar.outline.set_linewidth(0.4)
    inner, outer = cell_edges(elements)
    if len(tiles) <= MAX_LINED_CELLS:
        axes.add_collection(LineCollection([flat[chain] for chain in inner], colors=INK, linewidths=0.2, alpha=0.3))
    axes.add_collection(LineCollection([flat[chain] for chain in outer], colors=INK, linewidths=0.5))
    half = 1.5 * np.abs(flat[touching] - centre[kept]).max()
    for limits, limit, i in ((axes.set_xlim, centre[kept[0]], 0), (axes.set_ylim, centre[kept[1]], 1)):
        limits(max(limit - half, flat[:, i].min()), min(limit + half, flat[:, i].max()))
    axes.set_aspect("equal")
    axes.grid(False)
    axes.set_xlabel("xyz"[kept[0]])
    axes.set_ylabel("xyz"[kept[1]])
    draw_pressure_radius(radial, centre[kept], half, (flat, pressure),
                         None if points is None or points[1] is None else (points[0][:, kept], points[1]))


def draw_pressure_radius(axes, centre, reach, nodes, points):
    if points is not None:
        axes.plot(np.linalg.norm(points[0] - centre, axis=1), points[1], ".", ms=2, color=ORANGE, alpha=0.6,
                  label="quadrature points")
    axes.plot(np.linalg.norm(nodes[0] - centre, axis=1), nodes[1], ".", ms=3.5, color=BLUE, label="nodes")
    axes.set_xlim(0.0, reach)
    axes.set_ylim(bottom=min(0.0, np.nanmin(nodes[1])))
    axes.set_xlabel("distance from the centre of pressure")
    axes.set_ylabel("contact pressure")
    axes.legend(loc="upper right", fontsize=8)


def pressure_figure(fields, title):
    pairs = fields.pairs[:MAX_PANELS]
    left_out = len(fields.pairs) - len(pairs)
    if fields.dim == 2:
        columns = min(3, math.ceil(math.sqrt(len(pairs))))
        rows = math.ceil(len(pairs) / columns)
        figure, panels = plt.subplots(rows, columns, squeeze=False, layout="constrained",
                                      figsize=(max(7.2, 4.1 * columns), max(4.2, 2.9 * rows)))
        for panel, pair in zip(panels.flat, pairs):
            draw_pressure_line(panel, fields, pair)
        for panel in panels.flat[len(pairs):]:
            panel.axis("off")
        panels.flat[0].legend(loc="best", fontsize=8, markerscale=2)
    else:
        pairs = pairs[:4]
        left_out = len(fields.pairs) - len(pairs)
        figure, panels = plt.subplots(len(pairs), 2, squeeze=False, layout="constrained",
                                      figsize=(10.4, 4.3 * len(pairs)))
        for (panel, radial), pair in zip(panels, pairs):
            draw_pressure_map(figure, panel, radial, fields, pair)
    more = f" ({left_out} further pairs not shown)" if left_out else ""
    figure.suptitle(f"{title}\ncontact pressure at t = {fields.time:.6g}{more}")
    return figure
