"""Solves model.npz and job.json of the current folder with GetFEM, and leaves found.json. Run by scripts/bench.

Linear cells; contact is GetFEM's integral augmented Lagrangian with projection by raytracing, multipliers linear on the slave,
r = E / h of the softer body, linear solver MUMPS. GetFEM has an integral contact brick for small displacements, too. On
`hertz_2d` that paired only points that were within a twentieth of a cell of the other body before anything moved, and converged to
half of the contact.

GetFEM's test of convergence adds forces and weighted gaps, relative to the loads, which penalized supports make large. In
units of stress in which E is 70,000 a gap is then below the tolerance whatever it is; so all stresses are solved for in units of the
softer body's E, where forces and gaps are of one size, and given back in those of the deck.
"""

import json
import time
from pathlib import Path

import getfem as gf
import numpy as np

# By dimension and nodes of a cell: the nodes in GetFEM's order, element, map and integration.
KINDS = {(3, 8): ([0, 1, 3, 2, 4, 5, 7, 6], "FEM_QK(3,1)", "GT_QK(3,1)", "IM_GAUSS_PARALLELEPIPED(3,3)"),
         (3, 4): ([0, 1, 2, 3], "FEM_PK(3,1)", "GT_PK(3,1)", "IM_TETRAHEDRON(3)"),
         (2, 4): ([0, 1, 3, 2], "FEM_QK(2,1)", "GT_QK(2,1)", "IM_GAUSS_PARALLELEPIPED(2,3)"),
         (2, 3): ([0, 1, 2], "FEM_PK(2,1)", "GT_PK(2,1)", "IM_TRIANGLE(3)")}
TOLERANCE = 1e-12  # of the loads, which the penalized supports make SUPPORT times the forces
RELEASE = 20.0     # how far points look for the other body, in facets
SUPPORT = 1e3      # stiffness of supports in E of the stiffer body per length


class Body:
    """Mesh, displacement and bricks of one body."""

    def __init__(self, model, name, blocks, nodes, material):
        dimension = nodes.shape[1]
        self.name, self.used, self.regions = name, set(np.unique(np.concatenate([b.ravel() for b in blocks])).tolist()), {}
        self.mesh = gf.Mesh("empty", dimension)
        kinds = [KINDS[dimension, cells.shape[1]] for cells in blocks]
        places = [np.transpose(nodes[cells[:, kind[0]]], (2, 1, 0)) for cells, kind in zip(blocks, kinds)]
        added = [self.mesh.add_convex(gf.GeoTrans(kind[2]), place) for kind, place in zip(kinds, places)]
        self.space, self.integration = gf.MeshFem(self.mesh, dimension), gf.MeshIm(self.mesh)
        for convexes, (_, element, _, integration) in zip(added, kinds):
            self.space.set_fem(gf.Fem(element), convexes)
            self.integration.set_integ(gf.Integ(integration), convexes)
        self.variable = f"u_{name}"
        model.add_fem_variable(self.variable, self.space)
        young, poisson = material["E"], material["nu"]
        model.add_initialized_data(f"lame_{name}", [young * poisson / ((1 + poisson) * (1 - 2 * poisson))])
        model.add_initialized_data(f"shear_{name}", [young / (2 * (1 + poisson))])
        model.add_isotropic_linearized_elasticity_brick(self.integration, self.variable, f"lame_{name}", f"shear_{name}")

    def region(self, name, facets, nodes):
        """Number of the mesh region that is this surface."""
        if name not in self.regions:
            number = len(self.regions) + 1
            points = self.mesh.pid_from_coords(nodes[np.unique(facets)].T)
            self.mesh.set_region(number, self.mesh.faces_from_pid(points))
            self.regions[name] = number
        return self.regions[name]


def body_of(bodies, facets):
    return next(body for body in bodies if int(facets[0, 0]) in body.used)


def hold(model, bodies, job, surfaces, nodes):
    """Conditions on the prescribed components of every group; data names by group."""
    components = {}
    for group, component, _ in job["motion"][0]:
        components.setdefault(group, set()).add(component)
    for group, wanted in components.items():
        body = body_of(bodies, surfaces[group])
        region = body.region(group, surfaces[group], nodes)
        axes = range(nodes.shape[1])
        model.add_initialized_data(f"value_{group}", [0.0 for _ in axes])
        model.add_initialized_data(f"which_{group}", np.diag([float(c in wanted) for c in axes]))
        model.add_generalized_Dirichlet_condition_with_penalization(
            body.integration, body.variable, SUPPORT * max(m["E"] for m in job["bodies"].values()), region,
            f"value_{group}", f"which_{group}")
    return components


def join(model, slave, master, job, surfaces, nodes):
    """The contact brick; returns the slave's region."""
    regions = [body.region(name, surfaces[name], nodes)
               for body, name in ((slave, job["slave"]), (master, job["master"]))]
    multipliers = gf.MeshFem(slave.mesh, nodes.shape[1])
    multipliers.set_classical_fem(1)
    model.add_filtered_fem_variable("lambda", multipliers, regions[0])
    model.add_initialized_data("r", [1.0 / job["size"]])
    model.add_initialized_data("mu", [float(job["mu"] or 0.0)])
    model.add_initialized_data("alpha", [1.0])
    brick = model.add_integral_large_sliding_contact_brick_raytracing("r", RELEASE * job["size"], "mu", "alpha", 0)
    for body in (slave, master):
        model.add_fem_data(f"old_{body.name}", body.space)
    model.add_slave_contact_boundary_to_large_sliding_contact_brick(
        brick, slave.integration, regions[0], slave.variable, "lambda", f"old_{slave.name}")
    model.add_master_contact_boundary_to_large_sliding_contact_brick(
        brick, master.integration, regions[1], master.variable, f"old_{master.name}")
    return regions[0]


def march(model, bodies, job):
    """All increments; returns their number and that of Newton's iterations."""
    iterations = increments = 0
    for start, end, count in zip(job["motion"], job["motion"][1:], job["increments"]):
        for i in range(1, count + 1):
            for group in {entry[0] for entry in end}:
                value = [0.0] * bodies[0].mesh.dim()
                for (name, component, before), (_, _, after) in zip(start, end):
                    if name == group:
                        value[component] = before + (after - before) * i / count
                model.set_variable(f"value_{group}", value)
            iterations += model.solve("max_iter", 60, "max_res", TOLERANCE, "lsolver", "mumps")[0]
            increments += 1
            print(f"increment {increments} after {iterations} iterations, {time.process_time():.1f} s of CPU", flush=True)
            if job["mu"] is not None:
                for body in bodies:
                    model.set_variable(f"old_{body.name}", model.variable(body.variable))
    return increments, iterations


def outward(nodes, facets, inside):
    """Mean normal of a surface, away from a point of its body."""
    corners = nodes[facets]
    along, across = corners[:, 1] - corners[:, 0], corners[:, -1] - corners[:, 0]
    normal = np.cross(along, across).sum(axis=0) if nodes.shape[1] == 3 else np.array([-1.0, 1.0]) * along.sum(axis=0)[::-1]
    normal /= np.linalg.norm(normal)
    return normal if normal @ (corners.mean(axis=(0, 1)) - inside) > 0.0 else -normal


def tractions(model, slave, region, facets, nodes, normal):
    """Force on the slave; pressure and shear traction at its nodes (in the order of numpy's unique), by the mean normal."""
    places = nodes[np.unique(facets)].T
    size = model.mesh_fem_of_variable("lambda").qdim()
    values = np.reshape(model.interpolation("lambda", places, slave.mesh, -1, 1), (-1, size))
    parts = ["lambda"] if size == 1 else [f"lambda({c + 1})" for c in range(size)]
    force = np.array([float(gf.asm_generic(slave.integration, 0, part, region, model)) for part in parts])
    if size == 1:
        return force * normal, -values.ravel(), np.zeros_like(places.T)
    pressure = -values @ normal
    return force, pressure, values + np.outer(pressure, normal)


def main():
    job, arrays = json.loads(Path("job.json").read_text(encoding="utf-8")), np.load("model.npz")
    nodes = arrays["nodes"]
    surfaces = {name[8:]: arrays[name] for name in arrays.files if name.startswith("surface_")}
    softest = min(material["E"] for material in job["bodies"].values())
    for material in job["bodies"].values():
        material["E"] /= softest
    gf.util_trace_level(0)
    model = gf.Model("real")
    bodies = [Body(model, name, [arrays[f"cells_{i}"] for i, body in enumerate(job["blocks"]) if body == name], nodes,
                   material) for name, material in job["bodies"].items()]
    slave, master = (body_of(bodies, surfaces[job[role]]) for role in ("slave", "master"))
    components = hold(model, bodies, job, surfaces, nodes)
    region = join(model, slave, master, job, surfaces, nodes)
    increments, iterations = march(model, bodies, job)
    facets = surfaces[job["slave"]]
    normal = outward(nodes, facets, nodes[list(slave.used)].mean(axis=0))
    force, pressure, shear = (softest * part for part in tractions(model, slave, region, facets, nodes, normal))
    # Only groups that hold a body along the contact force carry it; supports on cuts get nothing.
    axis = int(np.argmax(np.abs(normal)))
    reactions = {group: (force * (-1.0 if body_of(bodies, surfaces[group]) is slave else 1.0)).tolist()
                 for group, held in components.items() if axis in held}
    Path("found.json").write_text(json.dumps({
        "reactions": reactions, "pressure": pressure.tolist(), "shear": shear.tolist(), "increments": increments,
        "newton": iterations, "unknowns": int(model.nbdof())}), encoding="utf-8")


if __name__ == "__main__":
    main()
