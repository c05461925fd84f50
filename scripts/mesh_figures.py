"""Pictures of the mesh: whole and deformed, or close to the contact at true scale."""

import math

import matplotlib
import numpy as np
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import Normalize
from matplotlib.tri import Triangulation

from figure_style import INK, MAX_LINED_CELLS, STRESS_MAP, plt
from run_results import PLANE, SOLID


def contact_zone(fields):
    """Centre and half-width of the region under pressure, over all pairs; None without contact."""
    places, weights = [], []
    for pair in fields.pairs:
        for source in (fields.points(pair), None if fields.surface(pair) is None else
                       (fields.surface(pair)[0], fields.surface(pair)[3])):
            if source is None or source[1] is None:
                continue
            pressure = np.nan_to_num(source[1])
            touching = pressure > 1e-3 * max(pressure.max(initial=0.0), 1e-300)
            if touching.any():
                places.append(source[0][touching])
                weights.append(pressure[touching])
                break
    if not places:
        return None
    places, weights = np.concatenate(places), np.concatenate(weights)
    centre = (weights[:, None] * places).sum(0) / weights.sum()
    return centre, np.abs(places - centre).max()


def nice(value):
    """The largest of 1, 2, 5 x 10^n that is not above `value`."""
    power = 10.0**math.floor(math.log10(value))
    return next(m * power for m in (5, 2, 1) if m * power <= value * (1 + 1e-12))


def overlap_scale(fields, allowed):
    """The scale up to which bodies in contact seem to overlap by less than `allowed`. A point of the slave surface that
    has closed its initial gap by c to the gap g is drawn at the gap g + c - scale * c. What the master does there is
    taken from the node nearest to the foot of the point."""
    if fields.displacement is None:
        return math.inf
    limit, moved = math.inf, fields.moved(1.0)
    for pair in fields.pairs:
        surface, points = fields.surface(pair), fields.points(pair)
        if surface is None or surface[1] is None or points is None or points[3] is None or points[4] is None:
            continue
        slave_places, slave_displacement = surface[:2]
        others = ~np.isin(fields.places.view([("", fields.places.dtype)] * 3).ravel(),
                          np.ascontiguousarray(slave_places).view([("", slave_places.dtype)] * 3).ravel())
        places, _, _, gaps, normals = points
        for q in range(0, len(places), max(1, len(places) // 300)):
            if not np.isfinite(gaps[q]):
                continue
            u = slave_displacement[np.argmin(((slave_places - places[q])**2).sum(1))]
            foot = places[q] + u - gaps[q] * normals[q]
            distance = ((moved - foot)**2).sum(1)
            distance[~others] = np.inf
            closed = -normals[q] @ (u - fields.displacement[np.argmin(distance)])
            if closed > 0.0:
                limit = min(limit, (max(gaps[q], 0.0) + closed + allowed) / closed)
    return limit


def display_scale(fields):
    """1 when the largest displacement can be seen (2 % of the model's diagonal), otherwise what makes it 3 % or less
    without bodies that seem to go through each other."""
    if fields.displacement is None:
        return 1.0
    size = np.linalg.norm(np.ptp(fields.places, axis=0))
    largest = np.linalg.norm(fields.displacement, axis=1).max(initial=0.0)
    if largest <= 1e-12 * size or largest >= 0.02 * size:
        return 1.0
    return max(1.0, nice(min(0.03 * size / largest, overlap_scale(fields, 0.002 * size))))


def scale_text(fields, scale):
    if fields.displacement is None:
        return "undeformed (no displacement in the file)"
    if scale == 1.0:
        return "displacement at true scale"
    return f"displacement × {scale:g}"


def stress_range(values):
    """Colour range that a few peaks (corners, punch edges) do not spoil, and whether it cuts any."""
    top = np.percentile(values, 99.8)
    largest = values.max()
    if top <= 0.0 or largest < 1.5 * top:
        return Normalize(0.0, largest if largest > 0.0 else 1.0), False
    return Normalize(0.0, top), True


def colour_bar(figure, axes, mappable, values, cut):
    bar = figure.colorbar(mappable, ax=axes, fraction=0.035, pad=0.02, extend="max" if cut else "neither")
    bar.set_label("von Mises stress" + (f" (largest {values.max():.4g})" if cut else ""))
    bar.outline.set_linewidth(0.4)


def cell_edges(cells):
    """Every edge of plane cells once, as chains of nodes."""
    chains = {}
    for code, elements in cells.items():
        for edge in PLANE[code][2]:
            for chain in elements[:, edge]:
                chains.setdefault((min(chain[0], chain[-1]), max(chain[0], chain[-1])), []).append(chain)
    inner = [found[0] for found in chains.values() if len(found) > 1]
    outer = [found[0] for found in chains.values() if len(found) == 1]
    return inner, outer


def draw_plane_mesh(figure, axes, fields, scale, window=None):
    places = fields.moved(scale)[:, :2]
    triangles = np.concatenate([elements[:, tile] for code, elements in fields.cells.items()
                                for tile in PLANE[code][1]])
    shown = np.ones(len(fields.places), bool)
    if window is not None:
        centre, half = window
        shown = (np.abs(places - centre[:2]) <= 1.2 * half).all(axis=1)
        inside = shown[triangles].any(axis=1)
        triangles = triangles[inside]
        shown = np.unique(triangles)
    if fields.mises is not None and len(triangles):
        values = fields.mises
        norm, cut = stress_range(values[shown])
        mesh = axes.tripcolor(Triangulation(*places.T, triangles), values, shading="gouraud", cmap=STRESS_MAP,
                              norm=norm, rasterized=True)
        colour_bar(figure, axes, mesh, values[shown], cut)
    inner, outer = cell_edges(fields.cells)
    visible = len(triangles) / 2 if window is not None else sum(map(len, fields.cells.values()))
    if visible <= MAX_LINED_CELLS:
        width = float(np.clip(18.0 / math.sqrt(max(visible, 1)), 0.08, 0.5))
        axes.add_collection(LineCollection([places[chain] for chain in inner], colors="white", linewidths=width,
                                           alpha=0.55))
    axes.add_collection(LineCollection([places[chain] for chain in outer], colors=INK, linewidths=0.7))
    axes.set_aspect("equal")
    axes.grid(False)
    if window is None:
        axes.autoscale_view()
    else:
        low, high = places.min(axis=0) - 0.05 * half, places.max(axis=0) + 0.05 * half
        axes.set_xlim(max(centre[0] - half, low[0]), min(centre[0] + half, high[0]))
        axes.set_ylim(max(centre[1] - 0.75 * half, low[1]), min(centre[1] + 0.75 * half, high[1]))
    axes.set_xlabel("x")
    axes.set_ylabel("y")


def exterior_faces(cells):
    """Corner nodes of the faces that belong to one cell only: quadrilaterals, triangles with the last node twice."""
    faces = []
    for code, elements in cells.items():
        for face in SOLID[code][1]:
            nodes = elements[:, face]
            faces.append(nodes if nodes.shape[1] == 4 else np.hstack([nodes, nodes[:, 2:]]))
    faces = np.concatenate(faces)
    _, first, count = np.unique(np.sort(faces, axis=1), axis=0, return_index=True, return_counts=True)
    return faces[first[count == 1]]


def camera():
    """Right, up and towards-the-viewer directions. The view is from negative x and y, so that quarter models (which by
    custom keep the positive quadrant) show their inside."""
    towards = np.array([-1.0, -1.5, 0.75])
    towards /= np.linalg.norm(towards)
    right = np.cross([0.0, 0.0, 1.0], towards)
    right /= np.linalg.norm(right)
    return right, np.cross(towards, right), towards


def draw_axes_cross(axes, right, up):
    """The directions of x, y, z in a corner."""
    inset = axes.inset_axes([0.0, 0.0, 0.13, 0.13])
    inset.set_xlim(-1.5, 1.5)
    inset.set_ylim(-1.5, 1.5)
    inset.set_aspect("equal")
    inset.axis("off")
    for i, name in enumerate("xyz"):
        end = np.array([right[i], up[i]])
        inset.annotate("", end, (0, 0),
                       arrowprops={"arrowstyle": "-|>", "color": INK, "lw": 0.8, "shrinkA": 0, "shrinkB": 0})
        inset.text(*(1.3 * end), name, ha="center", va="center", fontsize=8)


def draw_solid_mesh(figure, axes, fields, scale, window=None):
    """The outside of the bodies by the painter's algorithm: far faces first, those that look away left out."""
    places = fields.moved(scale)
    faces = exterior_faces(fields.cells)
    right, up, towards = camera()
    if window is not None:
        centre, half = window
        faces = faces[(np.abs(places[faces].mean(axis=1) - centre) <= 1.5 * half).all(axis=1)]
    corners = places[faces]
    normals = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    flat = np.linalg.norm(normals, axis=1) < 1e-300
    normals[flat] = towards
    triangles = faces[:, 2] == faces[:, 3]
    first = corners[triangles, 0]
    normals[triangles] = np.cross(corners[triangles, 1] - first, corners[triangles, 2] - first)
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    facing = normals @ towards > 1e-6
    faces, corners, normals = faces[facing], corners[facing], normals[facing]
    order = np.argsort(corners.mean(axis=1) @ towards)
    faces, corners, normals = faces[order], corners[order], normals[order]
    light = (right * -0.35 + up * 0.75 + towards * 0.9)
    shade = 0.72 + 0.28 * np.clip(normals @ (light / np.linalg.norm(light)), 0.0, 1.0)
    polygons = np.stack([corners @ right, corners @ up], axis=-1)
    colours = np.tile([0.75, 0.78, 0.82, 1.0], (len(faces), 1))
    if fields.mises is not None and len(faces):
        values = fields.mises[faces].mean(axis=1)
        norm, cut = stress_range(values)
        colours = plt.get_cmap(STRESS_MAP)(norm(values))
        colour_bar(figure, axes, matplotlib.cm.ScalarMappable(norm, STRESS_MAP), values, cut)
    colours[:, :3] *= shade[:, None]
    lined = len(faces) <= MAX_LINED_CELLS
    edges = np.append(colours[:, :3] * 0.72, np.ones((len(faces), 1)), axis=1) if lined else colours
    width = float(np.clip(25.0 / math.sqrt(max(len(faces), 1)), 0.15, 0.5))
    axes.add_collection(PolyCollection(polygons, facecolors=colours, edgecolors=edges, linewidths=width,
                                       rasterized=True))
    axes.set_aspect("equal")
    axes.axis("off")
    if window is None:
        axes.autoscale_view()
    else:
        axes.set_xlim(centre @ right - half, centre @ right + half)
        axes.set_ylim(centre @ up - 0.75 * half, centre @ up + 0.75 * half)
    draw_axes_cross(axes, right, up)


def mesh_figure(fields, title, window=None):
    scale = display_scale(fields) if window is None else 1.0
    extent = np.ptp(fields.places, axis=0)
    ratio = 0.75 if window is not None or fields.dim == 3 else extent[1] / max(extent[0], 1e-300)
    height = float(np.clip(7.6 * ratio + 1.1, 3.2, 9.0))
    figure, axes = plt.subplots(figsize=(8.6, height), layout="constrained")
    (draw_plane_mesh if fields.dim == 2 else draw_solid_mesh)(figure, axes, fields, scale, window)
    where = "near the contact, " if window is not None else ""
    axes.set_title(title, loc="left", pad=20, fontsize=11.5)
    axes.annotate(f"{where}t = {fields.time:.6g}, {scale_text(fields, scale)}", (0, 1), (0, 6),
                  xycoords="axes fraction", textcoords="offset points", fontsize=9, color="#5b6570")
    return figure


def zoom_window(fields):
    """Around the zone under pressure, where it is, and not larger than the model."""
    zone = contact_zone(fields)
    if zone is None:
        return None
    centre, half = zone
    if fields.displacement is not None:
        near = np.argsort(np.linalg.norm(fields.places - centre, axis=1))[:8]
        centre = centre + fields.displacement[near].mean(axis=0)
    return centre, min(max(2.5 * half, 1e-12), 0.5 * np.linalg.norm(np.ptp(fields.places, axis=0)))
