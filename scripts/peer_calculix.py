"""CalculiX on the mesh of a deck: writes model.inp, reads model.dat, model.frd and model.sta.

Contact is surface to surface with a linear pressure over penetration of 10 E / h per length (E of the softer body, h the
smallest slave facet); sticking has a tenth of that stiffness. Small displacements (no NLGEOM), solver SPOOLES.
"""

import re

import numpy as np

PACKAGE = "calculix-ccx"
CELL = {(3, 8): "C3D8", (3, 4): "C3D4", (2, 4): "CPE4", (2, 3): "CPE3"}


def numbered(values, width=12):
    """Numbers in lines of at most 12, as CalculiX wants sets."""
    return "\n".join(", ".join(map(str, values[i:i + width])) for i in range(0, len(values), width))


def mesh_lines(mesh):
    yield "*NODE, NSET=NALL"
    for i, place in enumerate(mesh.nodes, 1):
        yield f"{i}, " + ", ".join(f"{x:.12g}" for x in place)
    element = 1
    for body, cells in mesh.blocks:
        yield f"*ELEMENT, TYPE={CELL[mesh.dimension, cells.shape[1]]}, ELSET=BODY_{body}"
        for nodes in cells:
            yield f"{element}, " + ", ".join(map(str, nodes + 1))
            element += 1


def contact_lines(deck, mesh):
    pair = deck["contact"][0]
    for role in ("slave", "master"):
        yield f"*SURFACE, NAME={role.upper()}, TYPE=ELEMENT"
        for cell, face in mesh.faces_of(pair[role]):
            yield f"{cell + 1}, S{face + 1}"
    softest = min(float(material["elastic"]["E"]) for material in deck["materials"].values())
    stiffness = 10.0 * softest / mesh.facet_size(pair["slave"])
    yield "*SURFACE INTERACTION, NAME=CONTACT"
    yield "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR"
    yield f"{stiffness:.6g}"
    if "friction" in pair:
        yield "*FRICTION"
        yield f"{pair['friction']['coulomb']['mu']}, {0.1 * stiffness:.6g}"
    yield "*CONTACT PAIR, INTERACTION=CONTACT, TYPE=SURFACE TO SURFACE"
    yield "SLAVE, MASTER"


def step_lines(step, begin, motion, groups):
    length = (step["to"] - begin) / step["increments"]
    yield "*STEP, INC=1000"
    yield "*STATIC, SOLVER=SPOOLES"
    yield f"{length}, {step['to'] - begin}, {length / 64}, {length}"
    yield "*BOUNDARY"
    for group, component, value in motion:
        yield f"G_{group}, {component + 1}, {component + 1}, {value:.12g}"
    for group in groups:
        yield f"*NODE PRINT, NSET=G_{group}, TOTALS=ONLY, FREQUENCY=1"
        yield "RF"
    yield "*CONTACT FILE, FREQUENCY=1000"
    yield "CDIS, CSTR"
    yield "*END STEP"


def write_input(place, deck, mesh, motion, groups):
    """Writes model.inp and returns the command that solves it. `motion`: displacements at the start and at the end of
    every step, between which CalculiX goes straight."""
    lines = list(mesh_lines(mesh))
    for group in groups:
        lines += [f"*NSET, NSET=G_{group}", numbered(np.unique(mesh.surfaces[group]) + 1)]
    for name, material in deck["materials"].items():
        lines += [f"*MATERIAL, NAME={name}", "*ELASTIC", f"{material['elastic']['E']}, {material['elastic']['nu']}"]
    lines += [f"*SOLID SECTION, ELSET=BODY_{body}, MATERIAL={material}" for body, material in deck["bodies"].items()]
    lines += contact_lines(deck, mesh)
    begin = 0.0
    for step, moved in zip(deck["steps"], motion[1:]):
        lines += step_lines(step, begin, moved, groups)
        begin = step["to"]
    (place / "model.inp").write_text("\n".join(lines) + "\n", encoding="utf-8")
    return ["ccx", "-i", "model"]


def last_forces(text):
    """Last total force of every set in model.dat."""
    found = {}
    for group, numbers in re.findall(r"total force \(fx,fy,fz\) for set G_(\S+) and time.*?\n\s*\n(.*?)\n", text, re.S):
        found[group.lower()] = [float(word) for word in numbers.split()]
    return found


def nodal_tractions(path, count):
    """Pressure and the two parts of the shear traction at nodes 1 to count: the last CONTACT block of model.frd, zero at nodes
    that are not in it."""
    found, inside = np.zeros((count, 3)), False
    with open(path, encoding="utf-8", errors="replace") as file:
        for line in file:
            if line.startswith(" -4"):
                inside = line.split()[1] == "CONTACT"
                found = np.zeros((count, 3)) if inside else found
            elif inside and line.startswith(" -1") and int(line[3:13]) <= count:
                found[int(line[3:13]) - 1] = [float(line[at:at + 12]) for at in (49, 61, 73)]  # the last of six numbers
            elif line.startswith(" -3"):
                inside = False
    return found[:, 0], found[:, 1:]


def read_results(place, deck, mesh):
    """Reactions, tractions and counts, or None when the last step has not been reached."""
    try:
        rows = [line.split() for line in (place / "model.sta").read_text(encoding="utf-8").splitlines()]
        rows = [row for row in rows if len(row) == 7 and row[0].isdigit()]
        end = float(rows[-1][4])
    except (OSError, IndexError):
        return None
    if end < deck["steps"][-1]["to"] * (1.0 - 1e-9):
        return None
    forces = last_forces((place / "model.dat").read_text(encoding="utf-8"))
    names = {group.lower(): group for group in mesh.surfaces}
    pressure, shear = nodal_tractions(place / "model.frd", len(mesh.nodes))
    slave = np.unique(mesh.surfaces[deck["contact"][0]["slave"]])
    return {"reactions": {names[group]: force for group, force in forces.items()}, "pressure": pressure[slave],
            "shear": shear[slave], "unknowns": mesh.dimension * len(mesh.nodes),
            "increments": len({(row[0], row[1]) for row in rows}), "newton": sum(int(row[3]) for row in rows)}
