"""Solves model.npz and job.json of the current folder with GetFEM, and leaves found.json. Run by scripts/bench.

Trilinear hexahedra or linear tetrahedra; contact is GetFEM's integral augmented Lagrangian between meshes that do not
match, multipliers linear on the slave, r = E / h of the softer body: without friction its symmetric version, with
friction the unsymmetric one, which takes 16 iterations where the symmetric one takes 300. Linear solver MUMPS.
"""

import json
from pathlib import Path

import getfem as gf
import numpy as np

# Nodes of a cell in GetFEM's order; its element, map and integration.
KINDS = {8: ([0, 1, 3, 2, 4, 5, 7, 6], "FEM_QK(3,1)", "GT_QK(3,1)", "IM_GAUSS_PARALLELEPIPED(3,3)"),
         4: ([0, 1, 2, 3], "FEM_PK(3,1)", "GT_PK(3,1)", "IM_TETRAHEDRON(3)")}
TOLERANCE = 1e-12  # of the first residual, which the penalized supports make 1e4 times the forces


class Body:
    """Mesh, displacement and bricks of one body."""

    def __init__(self, model, name, cells, nodes, material):
        order, element, geometry, integration = KINDS[cells.shape[1]]
        self.name, self.used, self.regions = name, set(np.unique(cells).tolist()), {}
        self.mesh = gf.Mesh("empty", 3)
        self.mesh.add_convex(gf.GeoTrans(geometry), np.transpose(nodes[cells[:, order]], (2, 1, 0)))
        self.space = gf.MeshFem(self.mesh, 3)
        self.space.set_fem(gf.Fem(element))
        self.integration = gf.MeshIm(self.mesh, gf.Integ(integration))
        self.variable = f"u_{name}"
        model.add_fem_variable(self.variable, self.space)
        young, poisson = float(material["E"]), float(material["nu"])
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
        model.add_initialized_data(f"value_{group}", [0.0, 0.0, 0.0])
        model.add_initialized_data(f"which_{group}", np.diag([float(c in wanted) for c in range(3)]))
        model.add_generalized_Dirichlet_condition_with_penalization(
            body.integration, body.variable, 1e4 * max(float(m["E"]) for m in job["bodies"].values()), region,
            f"value_{group}", f"which_{group}")
    return components


def join(model, slave, master, job, surfaces, nodes):
    """The contact brick; returns the slave's region."""
    regions = [body.region(name, surfaces[name], nodes)
               for body, name in ((slave, job["slave"]), (master, job["master"]))]
    multipliers = gf.MeshFem(slave.mesh, 1 if job["mu"] is None else 3)
    multipliers.set_classical_fem(1)
    model.add_filtered_fem_variable("lambda", multipliers, regions[0])
    softest = min(float(material["E"]) for material in job["bodies"].values())
    model.add_initialized_data("r", [softest / job["size"]])
    names = [slave.variable, master.variable, "lambda", "r"]
    if job["mu"] is None:
        model.add_integral_contact_between_nonmatching_meshes_brick(slave.integration, *names, *regions, 2)
        return regions[0]
    model.add_initialized_data("mu", [float(job["mu"])])
    model.add_initialized_data("alpha", [1.0])
    for body in (slave, master):
        model.add_fem_data(f"old_{body.name}", body.space)
    model.add_integral_contact_between_nonmatching_meshes_brick(
        slave.integration, *names, "mu", *regions, 1, "alpha", f"old_{slave.name}", f"old_{master.name}")
    return regions[0]


def march(model, bodies, job):
    """All increments; returns their number and that of Newton's iterations."""
    iterations = increments = 0
    for start, end, count in zip(job["motion"], job["motion"][1:], job["increments"]):
        for i in range(1, count + 1):
            for group in {entry[0] for entry in end}:
                value = [0.0, 0.0, 0.0]
                for (name, component, before), (_, _, after) in zip(start, end):
                    if name == group:
                        value[component] = before + (after - before) * i / count
                model.set_variable(f"value_{group}", value)
            iterations += model.solve("max_iter", 60, "max_res", TOLERANCE, "lsolver", "mumps")[0]
            increments += 1
            if job["mu"] is not None:
                for body in bodies:
                    model.set_variable(f"old_{body.name}", model.variable(body.variable))
    return increments, iterations


def contact_force(model, slave, region, normal, has_friction):
    """Force on the slave, and the largest pressure."""
    values = np.asarray(model.variable("lambda"))
    if has_friction:
        parts = [gf.asm_generic(slave.integration, 0, f"lambda({c + 1})", region, model) for c in range(3)]
        return [float(part) for part in parts], float((-values.reshape(-1, 3) @ normal).max())
    total = float(gf.asm_generic(slave.integration, 0, "lambda", region, model))
    return [total * component for component in normal], float((-values).max())


def main():
    job, arrays = json.loads(Path("job.json").read_text(encoding="utf-8")), np.load("model.npz")
    nodes = arrays["nodes"]
    surfaces = {name[8:]: arrays[name] for name in arrays.files if name.startswith("surface_")}
    gf.util_trace_level(0)
    model = gf.Model("real")
    bodies = [Body(model, name, arrays[f"body_{name}"], nodes, material) for name, material in job["bodies"].items()]
    slave, master = (body_of(bodies, surfaces[job[role]]) for role in ("slave", "master"))
    components = hold(model, bodies, job, surfaces, nodes)
    region = join(model, slave, master, job, surfaces, nodes)
    increments, iterations = march(model, bodies, job)
    corners = nodes[surfaces[job["slave"]]]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, -1] - corners[:, 0])
    normal = normals.sum(axis=0) / np.linalg.norm(normals.sum(axis=0))
    inside = np.mean([nodes[list(slave.used)].mean(axis=0)], axis=0)
    if normal @ (corners.mean(axis=(0, 1)) - inside) < 0.0:
        normal = -normal
    force, peak = contact_force(model, slave, region, normal, job["mu"] is not None)
    # Only groups that hold a body along the contact force carry it; supports on cuts get nothing.
    axis = int(np.argmax(np.abs(normal)))
    reactions = {group: (np.array(force) * (-1.0 if body_of(bodies, surfaces[group]) is slave else 1.0)).tolist()
                 for group, held in components.items() if axis in held}
    Path("found.json").write_text(json.dumps({"reactions": reactions, "max_pressure": peak, "increments": increments,
                                              "newton": iterations, "unknowns": int(model.nbdof())}), encoding="utf-8")


if __name__ == "__main__":
    main()
