"""The hard scenes: each a mesh of a few blocks, a deck, why it is hard, and what must come out.

A scene is a function of the seed of its mesh; `@scene(...)` puts it in the table. It returns the mesh, the deck without
`enforce`, and the check: a function of the finished run that yields (what, error, tolerance).
"""
from dataclasses import dataclass

import numpy as np
from meshes import Mesh

E, NU = 100.0, 0.3
SCENES = {}
FRICTIONAL, FRICTIONLESS = ("semismooth", "dual", "uzawa", "penalty"), ("semismooth", "dual", "uzawa", "penalty", "vi")


@dataclass
class Scene:
    """`status`: the exit status that it must end with, and if not 0 `diagnosis`: words that must be in the log."""

    why: str
    make: object
    formulations: tuple
    status: int = 0
    diagnosis: str = ""


def scene(why, formulations=FRICTIONLESS, name=None, status=0, diagnosis="", **arguments):
    def register(make):
        SCENES[name or make.__name__] = Scene(why, lambda seed: make(seed, **arguments), formulations, status, diagnosis)
        return make

    return register


# --- decks


def deck(materials, boundary, contact, steps=((1, 1),), space="plane_strain", body_force=None):
    """materials: body -> (E, nu) ; steps: (to, increments)."""
    whole = {
        "title": "hard",
        "mesh": {"file": "mesh.msh"},
        "space": space,
        "materials": {body: {"elastic": {"E": law[0], "nu": law[1]}} for body, law in materials.items()},
        "bodies": {body: body for body in materials},
        "boundary": boundary,
        "contact": contact,
        "steps": [{"name": f"step{i}", "to": to, "increments": n} for i, (to, n) in enumerate(steps)],
        "output": {"directory": "results"},
    }
    if body_force:
        whole["body_force"] = body_force
    return whole


def pair(slave, master, name="pair", mu=None, segment=True):
    found = {"name": name, "slave": slave, "master": master}
    if segment:
        found["integration"] = {"segment": {}}
    if mu is not None:
        found["friction"] = {"coulomb": {"mu": mu}}
    return found


def plane(point, normal, **displacement):
    found = {"point": list(map(float, point)), "normal": list(map(float, normal))}
    return {"plane": {**found, **({"displacement": displacement} if displacement else {})}}


def hold(group, **components):
    return {"on": group, "displacement": components}


def push(group, value):
    return {"on": group, "pressure": value}


# --- checks


def pressure_is(run, value, tolerance=1e-6, name="pair"):
    pressures = run.points[name]["pressure"]
    return f"{name}: uniform pressure {value:.6g}", np.max(np.abs(pressures - value)) / value, tolerance


def force_is(run, name, vector, tolerance=1e-6):
    force = np.array(run.summary["contact"][name]["force"])[: len(vector)]
    return f"{name}: force {vector}", np.linalg.norm(force - vector) / np.linalg.norm(vector), tolerance


def confined(young, poisson):
    """Stress over strain of a block that cannot move sideways."""
    return young * (1 - poisson) / ((1 + poisson) * (1 - 2 * poisson))


# --- two blocks, one on the other, sides held: uniform pressure whatever the meshes (patch test), springs in series


@scene("the whole load in one increment", name="press_at_once")
@scene("starts from an overlap of 2 %", name="initial_overlap", gap=-0.02, top="0")
@scene("starts open: nothing holds the iterate until it has closed", name="initial_gap", gap=0.05)
@scene("the first iterate lies deeper than the upper body is thick", name="thinner_than_the_motion", thick=0.02, gap=0.05, cells=((3, 2), (4, 1)))
@scene("slave a million times stiffer", name="stiff_slave", upper=(1e6 * E, NU))
@scene("slave a million times softer", name="soft_slave", upper=(1e-6 * E, NU))
@scene("50 slave cells on one master cell", name="fine_slave", cells=((1, 1), (50, 1)))
@scene("one slave cell on 50 master cells", name="coarse_slave", cells=((50, 1), (1, 1)))
@scene("nearly incompressible", name="nu_0.4999", lower=(E, 0.4999), upper=(E, 0.4999))
@scene("auxetic", name="nu_-0.5", lower=(E, -0.5), upper=(E, -0.5))
@scene("cells fifty times longer than thick", name="flat_cells", cells=((1, 25), (2, 30)))
@scene("every body is one cell", name="one_cell_bodies", cells=((1, 1), (1, 1)))
@scene("the same meshes on both sides, free edges in line", name="conforming", cells=((4, 2), (4, 2)))
@scene("triangles, interfaces that do not match", name="triangles", triangles=True)
@scene("a load near the rounding of the places", name="tiny_load", top="-1e-9*t", tolerance=1e-5)
def confined_stack(seed, lower=(E, NU), upper=(E, NU), gap=0.0, top="-0.1*t", thick=0.5, cells=((3, 2), (4, 2)), triangles=False, tolerance=1e-6):
    mesh = Mesh(seed)
    mesh.box("lower", (0, 0), (1, 0.5), cells[0], triangles=triangles)
    mesh.box("upper", (0, 0.5 + gap), (1, 0.5 + gap + thick), cells[1], triangles=triangles)
    sides = [hold(f"{body}_{side}", x=0) for body in ("lower", "upper") for side in ("left", "right")]
    boundary = [hold("lower_bottom", y=0), hold("upper_top", y=top), *sides]
    closing = {"0": 0.0, "-0.1*t": 0.1, "-1e-9*t": 1e-9}[top] - gap
    pressure = closing / (0.5 / confined(*lower) + thick / confined(*upper))
    return mesh, deck({"lower": lower, "upper": upper}, boundary, [pair("upper_bottom", "lower_top")]), lambda run: [
        pressure_is(run, pressure, tolerance)
    ]


@scene("complete unloading and the same load again", name="unload_reload", top="-0.05*cos(pi*(t-1))", steps=((3, 3),))
@scene("all points change status at every increment", name="all_points_change", top="-0.05*cos(pi*(t-1))", steps=((7, 7),))
@scene("touching without any load: every scale of forces is zero", name="no_load", top="0", steps=((2, 2),))
def reloaded_stack(seed, top, steps):
    mesh, whole, _ = confined_stack(seed)
    whole["boundary"][1] = hold("upper_top", y=top)
    whole["steps"] = [{"name": "cycle", "to": steps[0][0], "increments": steps[0][1]}]
    amplitude = 0.0 if top == "0" else 0.05 * confined(E, NU)

    def check(run):
        closed = np.where(np.round(run.history["time"]).astype(int) % 2 == 1, amplitude, 0.0)
        error = np.max(np.abs(run.history["contact_pair_force_y"] - closed))
        yield "force at each increment", error / (amplitude or E), 1e-6

    return mesh, whole, check


# --- the same without lateral contraction and held as a whole: any place, direction and unit


@scene("rotated by 30 degrees", name="tilted_30", turn=30)
@scene("rotated by 135 degrees, with friction", FRICTIONAL, name="tilted_135_friction", turn=135, mu=0.5)
@scene("ten thousand widths away from the origin", name="far_away", shift=1e4, tolerance=1e-4)
@scene("micrometre and newton", name="micrometre_newton", length=1e3, stress=1e-6)
@scene("metre and meganewton", name="metre_meganewton", length=1e-3)
@scene("lengths of the size of a continent, stresses of a soap film", name="huge_and_soft", length=1e7, stress=1e-9)
def free_stack(seed, turn=0.0, shift=0.0, length=1.0, stress=1.0, mu=None, tolerance=1e-6):
    mesh = Mesh(seed)
    mesh.box("lower", (0, 0), (1, 0.5), (3, 2))
    mesh.box("upper", (0, 0.5), (1, 1), (4, 2))
    mesh.scale(length)
    mesh.rotate(turn)
    mesh.move((shift, shift, 0))
    down = 0.1 * length * np.array([np.sin(np.radians(turn)), -np.cos(np.radians(turn))])
    boundary = [hold("lower_bottom", x=0, y=0), hold("upper_top", x=f"{down[0]:.17g}*t", y=f"{down[1]:.17g}*t")]
    law = (E * stress, 0.0)
    whole = deck({"lower": law, "upper": law}, boundary, [pair("upper_bottom", "lower_top", mu=mu)])
    return mesh, whole, lambda run: [pressure_is(run, 0.1 * E * stress, tolerance)]


@scene("3D, meshes that do not match", name="solid_stack", cells=((2, 2, 3), (3, 2, 2)))
@scene("3D, every body is one cell", name="solid_one_cell", cells=((1, 1, 1), (1, 1, 1)))
def solid_stack(seed, cells):
    mesh = Mesh(seed)
    mesh.box("lower", (0, 0, 0), (1, 0.5, 1), cells[0])
    mesh.box("upper", (0, 0.5, 0), (1, 1, 1), cells[1])
    boundary = [hold("lower_bottom", x=0, y=0, z=0), hold("upper_top", x=0, y="-0.1*t", z=0)]
    laws = {"lower": (E, 0.0), "upper": (E, 0.0)}
    whole = deck(laws, boundary, [pair("upper_bottom", "lower_top")], space="solid")
    # The inverse of a bilinear map is no polynomial: on quadrangles that are no parallelograms integrals are not exact.
    return mesh, whole, lambda run: [pressure_is(run, 0.1 * E, 1e-3 if seed else 1e-6)]


# --- sliding as a whole: the shear force is mu times the normal force whatever the pressure looks like


@scene("friction without a coefficient", FRICTIONAL, name="slide_mu_0", mu=0.0)
@scene("all points slip", FRICTIONAL, name="slide_mu_0.1", mu=0.1)
@scene("all points slip, the edge in front digs in", FRICTIONAL, name="slide_mu_0.5", mu=0.5)
@scene("as much shear as pressure", FRICTIONAL, name="slide_mu_1", mu=1.0)
# Not with penalty and the dual basis, where a point at the edge still sticks at this shear.
@scene("friction beyond the uniqueness bounds", ("semismooth", "uzawa"), name="slide_mu_2", mu=2.0)
@scene("press and slide in one increment", FRICTIONAL, name="press_and_slide_at_once", mu=0.5, press="t", slide="t", to=1)
@scene("slip reverses at every increment", FRICTIONAL, name="reversals", mu=0.3, slide="cos(pi*t)", to=6)
def slide(seed, mu, press="min(t,1)", slide="max(t-1,0)", to=2):
    mesh = Mesh(seed)
    mesh.box("lower", (-0.5, 0), (1.5, 0.5), (10, 3))
    mesh.box("upper", (0, 0.5), (1, 0.7), (8, 2))
    boundary = [hold("lower_bottom", x=0, y=0), hold("upper_top", x=f"0.03*{slide}", y=f"-0.002*{press}")]
    increments = 1 if press == "t" else to
    whole = deck({"lower": (E, NU), "upper": (E, NU)}, boundary, [pair("upper_bottom", "lower_top", mu=mu)], ((to, increments),))

    def check(run):
        shear, normal = run.history["reaction_upper_top_x"], run.history["reaction_upper_top_y"]
        rows = range(len(shear)) if to == 6 else [-1]
        error = max(abs(abs(shear[i]) - mu * abs(normal[i])) / abs(normal[i]) for i in rows)
        yield f"shear force / normal force = {mu}", error, 1e-6

    return mesh, whole, check


@scene("3D, slips along a diagonal", FRICTIONAL)
def solid_slide(seed):
    mesh = Mesh(seed)
    mesh.box("lower", (-0.5, 0, -0.5), (1.5, 0.5, 1.5), (3, 1, 3))
    mesh.box("upper", (0, 0.5, 0), (1, 0.7, 1), (2, 1, 2))
    boundary = [hold("lower_bottom", x=0, y=0, z=0), hold("upper_top", x="0.02*max(t-1,0)", y="-0.002*min(t,1)", z="0.02*max(t-1,0)")]
    whole = deck({"lower": (E, 0.0), "upper": (E, 0.0)}, boundary, [pair("upper_bottom", "lower_top", mu=0.4)], ((2, 2),), "solid")

    def check(run):
        x, y, z = (run.history[f"reaction_upper_top_{c}"][-1] for c in "xyz")
        # Points do not slip all in exactly the same direction: of the vector sum that takes a second-order part.
        yield "shear force / normal force = 0.4", abs(np.hypot(x, z) / abs(y) / 0.4 - 1), 0.02
        yield "along the diagonal", abs(x - z) / np.hypot(x, z), 0.05

    return mesh, whole, check


# --- bodies held by contact alone


@scene("a body between two others, free to slide: singular without contact")
def frictionless_between(seed):
    mesh = Mesh(seed)
    for i, name in enumerate(("lower", "middle", "upper")):
        mesh.box(name, (0, 0.4 * i), (1, 0.4 * (i + 1)), (3 + i, 2))
    boundary = [hold("lower_bottom", x=0, y=0), push("upper_top", "t"), hold("upper_left", x=0)]
    contact = [pair("middle_bottom", "lower_top", "first"), pair("upper_bottom", "middle_top", "second")]
    whole = deck({name: (E, 0.0) for name in ("lower", "middle", "upper")}, boundary, contact)
    return mesh, whole, lambda run: [pressure_is(run, 1.0, 1e-5, "first"), pressure_is(run, 1.0, 1e-5, "second")]


@scene("fifty bodies on each other, 49 of them held by contact alone")
def chain_of_50(seed):
    mesh, count = Mesh(seed), 50
    for i in range(count):
        mesh.box(f"b{i}", (0, 0.2 * i), (1, 0.2 * (i + 1)), (1, 1))
    boundary = [hold("b0_bottom", y=0), push(f"b{count - 1}_top", "t"), *[hold(f"b{i}_left", x=0) for i in range(count)]]
    contact = [pair(f"b{i + 1}_bottom", f"b{i}_top", f"pair{i}") for i in range(count - 1)]
    whole = deck({f"b{i}": (E, 0.0) for i in range(count)}, boundary, contact)
    return mesh, whole, lambda run: [pressure_is(run, 1.0, 1e-4, f"pair{i}") for i in (0, 24, 48)]


@scene("a body that friction alone holds up between two walls", FRICTIONAL)
def squeezed_between_walls(seed):
    mesh, weight = Mesh(seed), 0.5
    mesh.box("block", (0, 0), (1, 1), (4, 4))
    contact = [
        pair("block_left", plane((0, 0), (1, 0), x="0.02*t"), "west", 0.5, False),
        pair("block_right", plane((1, 0), (-1, 0), x="-0.02*t"), "east", 0.5, False),
    ]
    whole = deck({"block": (E, NU)}, [], contact, body_force={"block": {"y": f"-{weight}*max(t-1,0)"}}, steps=((2, 2),))

    def check(run):
        places = run.points["west"], run.points["east"]
        up = sum(np.sum(p["shear"][:, 1] * p["weight"]) for p in places)
        yield "shear carries the weight", abs(abs(up) - weight) / weight, 1e-6

    return mesh, whole, check


@scene("a body is pushed along by another one, at a distance at first, which then leaves it to friction alone", FRICTIONAL)
def pushed_and_left(seed):
    mesh, mu, mu_side, load = Mesh(seed), 0.3, 0.1, 1e-3 * E
    mesh.box("pusher", (-1, 0.3), (-0.01, 0.9), (6, 6))
    mesh.box("block", (0, 0), (1, 1), (8, 8))
    contact = [pair("block_bottom", plane((0, 0), (0, 1)), "ground", mu, False), pair("pusher_right", "block_left", "side", mu_side)]
    boundary = [hold("pusher_left", x="0.02*(max(t-1,0)-2*max(t-2,0))", y=0), push("block_top", f"{load}*min(t,1)")]
    whole = deck({"pusher": (E, NU), "block": (E, NU)}, boundary, contact, steps=((1, 1), (2, 10), (3, 10)))

    def check(run):
        # Pushed: the block slides on the ground and down on the pusher, N = load + mu_side F, F = mu N.
        force = mu * load / (1 - mu * mu_side)
        pushed = int(np.argmin(np.abs(run.history["time"] - 2)))
        yield "force of the push", abs(run.history["reaction_pusher_left_x"][pushed] / force - 1), 1e-6
        yield "weight on the ground", abs(run.history["contact_ground_force_y"][-1] / load - 1), 1e-6
        yield "nothing left along the ground", abs(run.history["contact_ground_force_x"][-1]) / load, 1e-6

    return mesh, whole, check


@scene("a diamond in a groove: two slopes hold it, and they share its corner", FRICTIONAL)
def corner_in_groove(seed):
    mesh = Mesh(seed)
    mesh.box("block", (0, 0), (1, 1), (4, 4))
    mesh.rotate(45)
    contact = [
        pair("block_bottom", plane((0, 0), (-1, 1)), "east", segment=False),
        pair("block_left", plane((0, 0), (1, 1)), "west", segment=False),
    ]
    whole = deck({"block": (E, NU)}, [], contact, body_force={"block": {"y": "-0.1*t"}})
    half = 0.05  # of the weight, and what each slope pushes sideways
    return mesh, whole, lambda run: [force_is(run, "east", [-half, half], 1e-5), force_is(run, "west", [half, half], 1e-5)]


@scene("a plank on two supports, free to slide")
def plank_on_supports(seed):
    mesh = Mesh(seed)
    mesh.box("west", (0, 0), (0.2, 0.2), (2, 2))
    mesh.box("east", (0.8, 0), (1, 0.2), (2, 2))
    mesh.box("plank", (0, 0.2), (1, 0.4), (10, 2))
    contact = [pair("plank_bottom", "west_top", "on_west"), pair("plank_bottom", "east_top", "on_east")]
    boundary = [hold("west_bottom", x=0, y=0), hold("east_bottom", x=0, y=0)]
    laws = {"west": (10 * E, NU), "east": (10 * E, NU), "plank": (E, NU)}
    whole = deck(laws, boundary, contact, body_force={"plank": {"y": "-0.1*t"}})
    weight = 0.1 * 0.2  # body force x area

    def check(run):
        west, east = (run.summary["contact"][name]["force"][1] for name in ("on_west", "on_east"))
        yield "both carry the weight", abs(west + east - weight) / weight, 1e-6
        # Halves up to where the pressure's centre lies on each support, which is a matter of the mesh.
        yield "each half of it", abs(west - east) / weight, 0.02

    return mesh, whole, check


def wedge_in_slot(seed, mu):
    mesh, slope = Mesh(seed), 0.1  # half-angle 5.7 degrees: locks itself from mu = 0.1 on
    mesh.box("block", (-0.5, 0), (0.5, 1), (12, 12), bend=lambda x: np.array([x[0] * (1 + 2 * slope * x[1]), x[1], 0]))
    contact = [
        pair("block_left", plane((-0.5, 0), (1, slope)), "west", mu, False),
        pair("block_right", plane((0.5, 0), (-1, slope)), "east", mu, False),
    ]
    return mesh, deck({"block": (E, NU)}, [push("block_top", "5*min(t,2-t)")], contact, ((1, 2), (2, 2)))


@scene("a wedge that stays in its slot when let go", FRICTIONAL)
def wedge(seed):
    mesh, whole = wedge_in_slot(seed, 0.5)

    def check(run):
        west, east = (np.array(run.summary["contact"][name]["force"]) for name in ("west", "east"))
        yield "still held: force along x away from zero", float(west[0] < 1e-3), 0.5
        yield "both walls push alike", abs(west[0] + east[0]) / abs(west[0]), 0.02

    return mesh, whole, check


# Without load the block also fits the slot unstrained, without any force: a wedge that locks has two solutions at the
# end, one that does not lock has this one only. On the way the load is there, and one solution.
HOLDING = ("semismooth", "uzawa", "penalty")


@scene("let go, a wedge that locks has two solutions: the program must say so", HOLDING, name="wedge_two_solutions", mu=0.5, several=1)
@scene("a wedge below the critical friction: the program must not see two solutions", HOLDING, name="wedge_one_solution", mu=0.05, several=0)
def wedge_counted(seed, mu, several):
    mesh, whole = wedge_in_slot(seed, mu)
    whole["look_for_other_solutions"] = True

    def check(run):
        found = run.summary["other_solutions"]
        yield "all increments looked at", abs(found["increments_looked_at"] - 4), 0
        yield f"{several} of them with several solutions", abs(found["increments_with_several_solutions"] - several), 0
        yield "solutions of the last", abs(found["most_solutions_found"] - 1 - several), 0
        if several:
            yield "it is the last", abs(found.get("first_time", 0) - 2), 1e-12
            yield "the other lets go", float(found.get("largest_difference", {}).get("pressure", 0) < 0.3), 0

    return mesh, whole, check


# --- shapes


def bent_pair(seed, rise, press, mu=None, cells=((4, 2), (6, 2)), column=lambda x: x):
    """Lower block with the top at 0.5 + rise(x), upper one with the bottom there, too; pressed by `press` along y.
    `column` puts the nodes of a column at another x."""
    mesh = Mesh(seed)
    mesh.box("lower", (0, 0), (1, 0.5), cells[0], bend=lambda x: np.array([column(x[0]), x[1] + rise[0](column(x[0])) * x[1] / 0.5, 0]))
    mesh.box("upper", (0, 0.5), (1, 1), cells[1], bend=lambda x: np.array([column(x[0]), x[1] + rise[1](column(x[0])) * (1 - x[1]) / 0.5, 0]))
    boundary = [hold("lower_bottom", x=0, y=0), hold("upper_top", x=0, y=f"-{press}*t")]
    return mesh, deck({"lower": (E, NU), "upper": (E, NU)}, boundary, [pair("upper_bottom", "lower_top", mu=mu)])


def push_and_answer(run):
    up, down = run.history["reaction_lower_bottom_y"][-1], run.history["reaction_upper_top_y"][-1]
    yield "reactions of both bodies are opposite", abs(up + down) / abs(up), 1e-8
    yield "bodies are pressed together", float(up <= 0), 0.5


@scene("a slave node in the valley between two master segments (the lecture's endless loop)", name="node_in_valley", kink=0.2)
@scene("a slave node on the ridge between two master segments", name="node_on_ridge", kink=-0.2)
@scene("valley with friction", FRICTIONAL, name="node_in_valley_friction", kink=0.2, mu=0.3)
@scene("ridge with friction", FRICTIONAL, name="node_on_ridge_friction", kink=-0.2, mu=0.3)
@scene("ridge with friction, pressed deep in one increment", FRICTIONAL, name="deep_ridge_friction", kink=-0.2, mu=0.3, press=0.06)
def kinked(seed, kink, mu=None, press=0.02):
    rise = lambda x: kink * abs(x - 0.5)  # noqa: E731
    mesh, whole = bent_pair(0, (rise, rise), press, mu, ((2, 1), (4, 1)))
    if seed:  # the node beside the kink instead of on it
        mesh.nodes[:, 0] += np.where(np.isclose(mesh.nodes[:, 0], 0.5) & (mesh.nodes[:, 1] > 0.4), 1e-9 * seed, 0.0)
    return mesh, whole, push_and_answer


@scene("bodies that touch at one point", name="touch_at_a_point")
@scene("bodies that touch at one point, with friction", FRICTIONAL, name="touch_at_a_point_friction", mu=0.3)
@scene("zig-zag on zig-zag: normals that jump from facet to facet", name="zigzag", teeth=8)
def bulges(seed, mu=None, teeth=None):
    if teeth:  # with nodes of both sides at every kink, so that the surfaces are the same on any mesh
        rise = lambda x: 0.03 - 0.06 * abs((teeth * x + 1) % 2 - 1)  # noqa: E731
        kink = lambda x: round(teeth * x) / teeth  # noqa: E731
        column = lambda x: kink(x) if abs(x - kink(x)) < 0.25 / teeth else x  # noqa: E731
        mesh, whole = bent_pair(seed, (rise, rise), 0.02, mu, ((teeth, 2), (2 * teeth, 2)), column)
    else:
        mesh, whole = bent_pair(seed, (lambda x: -0.4 * (x - 0.5) ** 2, lambda x: 0.4 * (x - 0.5) ** 2), 0.05, mu, ((15, 4), (20, 4)))
    return mesh, whole, push_and_answer


@scene("the slave sticks out over the edge of the master", name="overhanging_slave", where=(-0.3, 1.3))
@scene("the slave's edge stands on the master: singular pressure", name="edge_on_face", where=(0.3, 0.7))
@scene("half of the slave is beside the master", name="corner_over_corner", where=(0.5, 1.5))
def edges(seed, where):
    mesh = Mesh(seed)
    mesh.box("lower", (0, 0), (1, 0.5), (10, 5))
    mesh.box("upper", (where[0], 0.5), (where[1], 0.8), (16, 3))
    boundary = [hold("lower_bottom", x=0, y=0), {"on": "upper_top", "displacement": {"x": 0}, "resultant": {"y": "-2*t"}}]
    whole = deck({"lower": (E, NU), "upper": (E, NU)}, boundary, [pair("upper_bottom", "lower_top")])
    return mesh, whole, lambda run: [force_is(run, "pair", [0, 2.0])]


@scene("a tall block pushed at its top: it rocks on its edge, part opens, part sticks", FRICTIONAL)
def rocking(seed):
    mesh = Mesh(seed)
    mesh.box("block", (0, 0), (0.5, 1), (12, 8))
    contact = [pair("block_bottom", plane((0, 0), (0, 1)), mu=1.0, segment=False)]
    # The line of action of 1 down at 0.25 and 0.2 sideways at height 1 meets the floor at x = 0.45, inside the base.
    boundary = [{"on": "block_top", "traction": {"x": "0.4*max(t-1,0)", "y": "-2*min(t,1)"}}]
    whole = deck({"block": (E, 0.0)}, boundary, contact, ((1, 1), (2, 2)))

    def check(run):
        points = run.points["pair"]
        normal = points["pressure"] * points["weight"]
        yield "normal force 1", abs(np.sum(normal) - 1.0), 1e-6
        yield "shear force 0.2", abs(abs(np.sum(points["shear"][:, 0] * points["weight"])) - 0.2) / 0.2, 1e-6

    return mesh, whole, check


# --- no solution: refusing is the right answer


@scene("a free body is pulled off: nothing can hold it", status=3, diagnosis="not reached")
def pulled_off(seed):
    mesh = Mesh(seed)
    mesh.box("block", (0, 0), (1, 1), (3, 3))
    contact = [pair("block_bottom", plane((0, 0), (0, 1)), segment=False)]
    boundary = [push("block_top", "1-2*t"), hold("block_left", x=0)]
    return mesh, deck({"block": (E, NU)}, boundary, contact, ((1, 2),)), lambda run: []


@scene("a free body is pushed sideways by more than friction can bear", FRICTIONAL, status=3, diagnosis="not reached")
def pushed_away(seed):
    mesh = Mesh(seed)
    mesh.box("block", (0, 0), (1, 0.5), (4, 2))
    contact = [pair("block_bottom", plane((0, 0), (0, 1)), mu=0.3, segment=False)]
    boundary = [{"on": "block_top", "traction": {"x": "0.5*t", "y": "-1"}}]
    return mesh, deck({"block": (E, NU)}, boundary, contact, ((1, 1),)), lambda run: []
