"""The hard scenes of large sliding. Without friction they are elastic: what the slider feels depends on where it is and
not on how it got there, so that coming back to a place must bring back the forces felt there before."""
import numpy as np
from meshes import Mesh
from scenes import E, NU, deck, hold, pair, plane, scene

FRICTIONAL = ("semismooth", "uzawa", "penalty")
SLAVE_NORMAL = {"slave_normal": {}}


def slider(seed, x, y, mu=None, rise=None, base=(2.0, 5), block=(0.6, 3), increments=20, to=2, projection=SLAVE_NORMAL):
    """A block 0.4 high and `block` wide (cells) on a base 0.5 high and `base` long, its left side at x = 0.4; its top
    moves by x and y. `rise`: what the base's top has more height."""
    mesh = Mesh(seed)
    bend = None if rise is None else lambda p: p + np.array([0, rise(p[0]) * p[1] / 0.5, 0])
    mesh.box("base", (0, 0), (base[0], 0.5), (base[1], 2), bend=bend)
    mesh.box("block", (0.4, 0.5), (0.4 + block[0], 0.9), (block[1], 2))
    boundary = [hold("base_bottom", x=0, y=0), hold("block_top", x=x, y=y)]
    contact = pair("block_bottom", "base_top", mu=mu, segment=False)
    contact["projection"] = projection
    contact["search_distance"] = 0.2
    whole = deck({"base": (E, NU), "block": (E, NU)}, boundary, [contact], ((to, increments),))
    whole["kinematics"] = "finite"
    # Cells as large as the bodies: their corners are pressed into faces, and what one cell spans cannot fit the other.
    whole["certificate"] = {"penetration": 0.3, "complementarity": 0.2, "slip": 0.3}
    return mesh, whole


def forces(run, time):
    row = int(np.argmin(np.abs(run.history["time"] - time)))
    return np.array([run.history[f"reaction_block_top_{c}"][row] for c in "xy"])


def felt_again(run, first, second, tolerance=1e-6):
    one, other = forces(run, first), forces(run, second)
    yield f"force at t = {first} and {second}", np.linalg.norm(one - other) / np.linalg.norm(one), tolerance
    yield "the block is pressed", float(one[1] >= 0), 0.5


@scene("slave nodes pass an edge of the master back and forth (the lecture's endless loop)", FRICTIONAL, name="edge_back_and_forth", rise=lambda x: -0.1 * abs(x - 0.8))
@scene("the same with projections to the closest point", FRICTIONAL, name="edge_closest_point", rise=lambda x: -0.1 * abs(x - 0.8), projection={"closest_point": {}})
@scene("the same on a smoothed master, where forces have a potential", FRICTIONAL, name="edge_smoothed", rise=lambda x: -0.1 * abs(x - 0.8), projection={"closest_point": {}}, smooth=True)
@scene("back and forth over a valley of the master", FRICTIONAL, name="valley_back_and_forth", rise=lambda x: 0.1 * abs(x - 0.8))
def back_and_forth(seed, rise, projection=SLAVE_NORMAL, smooth=False):
    mesh, whole = slider(seed, "0.07*sin(pi*(t-1))*(t>1)", "-0.02*min(t,1)", rise=rise, to=5, increments=50, projection=projection)
    if smooth:
        whole["contact"][0]["smoothing"] = {"cubic": {}}

    def check(run):
        yield from felt_again(run, 1, 3)
        yield from felt_again(run, 1.5, 3.5)
        yield from felt_again(run, 2.5, 4.5)
        if smooth:
            stored = run.history["energy_stored"]
            yield "energy stored less work / stored", np.abs(stored - run.history["energy_external_work"]).max() / stored.max(), 0.01

    return mesh, whole, check


@scene("the corner of the slider passes over facets of the master, and comes back", FRICTIONAL, name="corner_over_facets")
@scene("a slider that is one cell", FRICTIONAL, name="one_cell_over_facets", block=(0.25, 1))
@scene("a slider with the surfaces' roles exchanged: master corners pass over slave facets", FRICTIONAL, name="master_corner_over_facets", exchange=True)
def over_facets(seed, exchange=False, **shape):
    mesh, whole = slider(seed, "0.9*(1-abs(t-2))*(t>1)", "-0.01*min(t,1)", to=3, increments=60, **shape)
    if exchange:
        pair_ = whole["contact"][0]
        pair_["slave"], pair_["master"] = pair_["master"], pair_["slave"]

    def check(run):
        yield from felt_again(run, 1, 3)
        yield from felt_again(run, 1.5, 2.5)

    return mesh, whole, check


@scene("slides off the end of the master", FRICTIONAL, name="off_the_end")
@scene("slides off the end of the master with friction", FRICTIONAL, name="off_the_end_friction", mu=0.3)
def off_the_end(seed, mu=None):
    mesh, whole = slider(seed, "1.8*max(t-1,0)", "-0.01*min(t,1)", mu=mu, increments=80)

    def check(run):
        yield "force at the end / largest", np.linalg.norm(forces(run, 2)) / np.abs(run.history["reaction_block_top_y"]).max(), 1e-6
        yield "area in contact at the end", run.history["contact_pair_area"][-1], 1e-12

    return mesh, whole, check


LEFT = "left_master is 1 at t = 2, allowed 0.2: pair 'pair': points under pressure have left the master"


@scene("small kinematics carry a block that has left its master on: refused", (*FRICTIONAL, "vi", "dual"), status=4, diagnosis=LEFT)
def off_the_end_small(seed):
    # On the master at t = 1.5 still, gone at t = 2.
    mesh, whole = slider(seed, "2*max(t-1,0)", "-0.01*min(t,1)", increments=4)
    del whole["kinematics"]
    return mesh, whole, None


@scene("contact lost, the block carried on, and found again", FRICTIONAL, name="lost_and_found")
@scene("contact lost and found again with friction", FRICTIONAL, name="lost_and_found_friction", mu=0.3)
def lost_and_found(seed, mu=None):
    # Pressed at even times, lifted at odd ones, moved along in between and back; t and 4 - t are the same place.
    mesh, whole = slider(seed, "0.25*(1-cos(pi*t/2))", "0.03-0.04*abs(cos(pi*t/2))^3", mu=mu, to=4, increments=40)

    def check(run):
        row = run.history["contact_pair_area"]
        yield "area while lifted", float(np.interp(1.0, run.history["time"], row)), 1e-12
        if mu is None:
            yield "force at t = 0.1 and 3.9", np.linalg.norm(forces(run, 3.9) - forces(run, 0.1)) / np.linalg.norm(forces(run, 0.1)), 1e-6
        yield "the block is pressed", float(forces(run, 2)[1] >= 0), 0.5

    return mesh, whole, check


# --- states at the start, and rubber


def raise_block(mesh, height):
    of_block = [nodes for _, nodes, group in mesh.elements if mesh.groups[group - 1][1] == "block"]
    mesh.nodes[np.unique(of_block), 1] += height


@scene("penetrates at the start, is lifted off and pressed in again", FRICTIONAL, name="starts_inside")
def starts_inside(seed):
    mesh, whole = slider(seed, 0, "0.06*(1-abs(t-2))*(t>1)", to=3, increments=15)
    raise_block(mesh, -0.02)

    def check(run):
        yield from felt_again(run, 1, 3)
        yield "area while lifted", float(np.interp(2.0, run.history["time"], run.history["contact_pair_area"])), 1e-12

    return mesh, whole, check


@scene("a block at a distance, pushed by a force and held by nothing else", FRICTIONAL, name="starts_far_away")
def starts_far_away(seed):
    mesh, whole = slider(seed, 0, 0, to=1, increments=5)
    raise_block(mesh, 0.1)
    whole["boundary"][1] = {"on": "block_top", "displacement": {"x": 0}, "resultant": {"y": "-0.5*t"}}

    def check(run):
        yield "force up against that which pushes", abs(run.history["contact_pair_force_y"][-1] / 0.5 - 1), 1e-6

    return mesh, whole, check


RUBBER = {"neo_hookean": {"E": 10.0, "nu": 0.4999}}


@scene("rubber of nu = 0.4999 pressed to half its height", FRICTIONAL)
def rubber_at_half(seed):
    """Half of a block 2 wide and 1 high under a smooth rigid plate. It stays a rectangle; for an incompressible one in
    plane strain sigma_yy = G (s^2 - 1 / s^2) at the stretch s, on the width 1 / s."""
    mesh = Mesh(seed)
    mesh.box("block", (0, 0), (1, 1), (4, 4))
    boundary = [hold("block_bottom", y=0), hold("block_left", x=0)]
    contact = pair("block_top", plane((0, 1), (0, -1), y="-0.5*t"), segment=False)
    contact["search_distance"] = 2.0
    whole = deck({"block": (E, NU)}, boundary, [contact], ((1, 10),))
    whole["materials"]["block"] = RUBBER
    whole["kinematics"] = "finite"
    exact = RUBBER["neo_hookean"]["E"] / (2 * 1.4999) * (1 / 0.25 - 0.25) / 0.5

    def check(run):
        yield "force against that of incompressible rubber", abs(run.history["reaction_block_bottom_y"][-1] / exact - 1), 2e-3

    return mesh, whole, check


# --- a thin wall folded onto itself


def hairpin(place):
    """A strip bent to two legs 1 long and half a circle between them; its lower side is the inside, of radius 0.23."""
    leg, radius = 1.0, 0.23 + place[1]
    angle = (place[0] - leg) / 0.25
    if angle < 0:
        return np.array([leg - place[0], -radius, 0])
    if angle < np.pi:
        return np.array([-radius * np.sin(angle), -radius * np.cos(angle), 0])
    return np.array([place[0] - leg - 0.25 * np.pi, radius, 0])


@scene("a pressure folds the legs of a thin hairpin onto each other and lets them go", ("uzawa", "penalty"), name="folded_wall")
@scene("the same with friction", ("uzawa", "penalty"), name="folded_wall_friction", mu=0.3)
def folded_wall(seed, mu=None):
    mesh = Mesh(seed)
    mesh.box("wall", (0, 0), (2 + 0.25 * np.pi, 0.04), (60, 2), bend=hairpin)
    inside = np.arange(0, len(mesh.nodes), 3)  # nodes of the lower side, along the strip
    # The ends are brought from 0.46 to 0.1 of each other, then the pressure comes and goes.
    boundary = [
        hold("wall_left", x=0, y=0),
        hold("wall_right", x=0, y="-0.36*min(t,1)"),
        {"on": "wall_top", "pressure": f"{1e-3 * E}*max(0,1-abs(t-2))"},
    ]
    contact = {"name": "pair", "between": "all"}
    if mu is not None:
        contact["friction"] = {"coulomb": {"mu": mu}}
    whole = deck({"wall": (E, NU)}, boundary, [contact], ((1, 5), (2, 20), (3, 20)))
    whole["kinematics"] = "finite"
    # A wall that is soft in bending: see inputs/ring_crush.
    whole["petsc"] = {"snes_linesearch_type": "nleqerr"}

    def check(run):
        time, area = run.history["time"], run.history["contact_pair_area"]
        yield "area before the pressure and after", area[0] + np.interp(1.0, time, area) + area[-1], 1e-12
        yield "length that is missing of 0.2 in contact", 0.2 - np.interp(2.0, time, area), 0.0
        folded = run.at(2.0)
        now = (folded.places[:, :2] + folded.nodal["displacement"][:, :2])[inside]
        lower, upper = now[: len(now) // 2], now[len(now) // 2 :]
        near = (upper[:, 0] > 0.1) & (upper[:, 0] < 0.9)
        heights = np.interp(upper[near, 0], lower[::-1, 0], lower[::-1, 1])
        yield "legs overlap by / thickness", max(0.0, (heights - upper[near, 1]).max()) / 0.04, 0.02
        if mu is None:
            yield "forces at t = 1.8 and 2.2", folding_difference(run, 1.8, 2.2), 1e-6

    return mesh, whole, check


def folding_difference(run, first, second):
    time = run.history["time"]
    one, other = (np.array([run.history[f"reaction_wall_right_{c}"][np.argmin(np.abs(time - t))] for c in "xy"]) for t in (first, second))
    return np.linalg.norm(one - other) / np.linalg.norm(one)
