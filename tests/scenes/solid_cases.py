"""Bodies without contact: rubber and metal at finite strain, plastic flow."""
import numpy as np

import references

# Vertical displacement of the corner (48, 60) in mm by cells a side, four-node F-bar element: OpenGeoSys 6, benchmark
# LargeDeformation/CooksMembraneFbar (W. Wang, T. Nagel, 2024), which follows E. A. de Souza Neto et al., Int. J. Solids
# Struct. 33 (1996) 3277-3296, and T. Elguedj et al., Comput. Methods Appl. Mech. Eng. 197 (2008) 2732-2762.
COOK_FBAR = {4: 6.1414, 10: 6.7463, 15: 6.8242, 20: 6.8589, 25: 6.8731, 30: 6.8914}


def displacement_at(results, place):
    place = np.array([*place, 0.0])
    node = np.argmin(np.linalg.norm(results.places - place, axis=1))
    return results.nodal["displacement"][node]


def corner(results):
    return displacement_at(results, (48.0, 60.0))[1]


def check_energy(bench, label, results):
    """Work = stored + dissipated to second order in the increments: far below what the books allow for."""
    history = results.history
    defect = history["energy_external_work"] - history["energy_stored"] - history["energy_dissipated"]
    bench.below(f"{label}: energy not accounted for / work", abs(defect[-1]) / abs(history["energy_external_work"][-1]), 0.01)


def cook_reference(bench):
    """The same meshes as published: the difference of the two elements is a part of the discretization error."""
    for n, tolerance in ((4, 0.03), (10, 0.01), (15, 0.005)):
        results = bench.run("cook_membrane", {"mesh.parameters.n": n})
        bench.close(f"corner, {n} cells a side", corner(results), COOK_FBAR[n], tolerance)
        check_energy(bench, f"{n} cells a side", results)


def cook_elements(bench):
    """Order 2 is at the limit of the refined meshes of order 1 on coarse ones; triangles of order 1 lock."""
    limit = COOK_FBAR[30]
    for label, changes, tolerance in (
        ("quadrilaterals of order 2, 8 a side", {"mesh.parameters.n": 8, "mesh.order": 2}, 0.01),
        ("triangles of order 2, 12 a side", {"mesh.parameters.n": 12, "mesh.order": 2, "mesh.parameters.quads": 0}, 0.03),
    ):
        bench.close(label, corner(bench.run("cook_membrane", changes)), limit, tolerance)
    locked = corner(bench.run("cook_membrane", {"mesh.parameters.n": 12, "mesh.parameters.quads": 0}))
    bench.below("triangles of order 1, 12 a side, corner / limit (they are known to lock)", locked / limit, 0.8)


def inflated_cylinder(bench):
    """Growth of the bore under 0.5 of the shear modulus against the closed form of incompressible rubber."""
    parameters = {"inner": 1.0, "outer": 2.0}
    exact = references.inflated_cylinder_growth(0.5, 1.0, parameters["inner"], parameters["outer"])
    for label, changes, tolerance in (
        ("quadrilaterals of order 2", {}, 1e-3),
        ("quadrilaterals of order 1", {"mesh.order": 1, "mesh.parameters.n": 16, "mesh.parameters.m": 24}, 5e-3),
        ("triangles of order 2", {"mesh.parameters.quads": 0, "mesh.parameters.n": 6, "mesh.parameters.m": 10}, 1e-2),
    ):
        results = bench.run("inflated_cylinder", changes)
        grown = displacement_at(results, (parameters["inner"], 0.0))[0]
        bench.close(f"{label}: displacement of the bore", grown, exact, tolerance)
        # The wall's hoop force balances the pressure on the bore as it is now.
        hoop = -results.history["reaction_bottom_y"][-1]
        bench.close(f"{label}: hoop force", hoop, 0.5 * (parameters["inner"] + grown), 1e-7)


def necking_uniform(bench):
    """A bar without a notch stays uniform: force against the uniaxial law, up to nearly the largest force."""
    results = bench.run(
        "necking_bar",
        {"mesh.parameters": {"n": 2, "m": 4, "middle": 1.0}, "boundary.2.displacement.y": "3*t", "steps.0.increments": 12},
    )
    law = results.deck["materials"]["steel"]["elastic_plastic"]
    for t, force in zip(results.history["time"], results.history["reaction_end_y"]):
        exact = references.round_bar_force(np.log1p(3.0 * t / 26.667), law, 6.413)
        if t == results.history["time"][0] or t > 0.99:
            bench.close(f"force at an elongation of {6 * t:.2f} mm", force, exact, 2e-5)


def necking_reference(bench):
    """The largest force lies between those of uniform bars of the thinnest and of the full section (Considere)."""
    results = bench.run("necking_bar")
    law = results.deck["materials"]["steel"]["elastic_plastic"]
    force, time = results.history["reaction_end_y"], results.history["time"]
    strains = np.linspace(0.05, 0.3, 501)
    full = max(references.round_bar_force(strain, law, 6.413) for strain in strains)
    bench.below("largest force / that of the full section", force.max() / full, 1.0)
    bench.below("that of the thinnest section / largest force", 0.982**2 * full / force.max(), 1.0)
    neck = 1.0 + displacement_at(results, (0.982 * 6.413, 0.0))[0] / (0.982 * 6.413)
    print(f"     largest force {force.max():.3f} at an elongation of {14 * time[force.argmax()]:.2f} mm; at 14 mm: force "
          f"{force[-1]:.3f}, radius of the neck / first one {neck:.4f}")
    bench.below("force at the end / largest (it has necked)", force[-1] / force.max(), 0.6)
    check_energy(bench, "necked bar", results)


HALF_HEIGHTS = (10.0, 5.0, 2.5)


def apparent_modulus(bench, half_height):
    """Shape factor, and mean stress over strain over E of the rubber disc at a compression of 0.01 %."""
    changes = {
        "mesh.parameters.half_height": half_height,
        "mesh.order": 2,
        "mesh.parameters.n": 10,
        "mesh.parameters.m": 5,
        "boundary.2.displacement.y": f"-{1e-4 * half_height}*t",
        "steps": [{"name": "touch", "to": 1, "increments": 1}],
    }
    results = bench.run("pressed_rubber_block", changes)
    law = results.deck["materials"]["rubber"]["neo_hookean"]
    radius = results.deck["mesh"]["parameters"].get("radius", 20.0)
    stress = -results.history["reaction_plate_y"][-1] / (np.pi * radius**2)
    return radius / (4.0 * half_height), stress / 1e-4 / law["E"]


def pressed_rubber_block(bench):
    """Stiffness at small strain by the shape factor S: Gent and Lindley's formula, which measurements follow within a few
    per cent."""
    for half_height in HALF_HEIGHTS:
        shape, modulus = apparent_modulus(bench, half_height)
        bulk = 1.0 / (3.0 * (1.0 - 2.0 * 0.4999))  # K / E
        expected = 1.0 / (1.0 / (1.0 + 2.0 * shape**2) + 1.0 / bulk)
        bench.close(f"apparent modulus / E at shape factor {shape:g}", modulus, expected, 0.05)


CASES = {
    "cook_membrane": {"reference": cook_reference, "elements": cook_elements},
    "inflated_cylinder": {"reference": inflated_cylinder},
    "necking_bar": {"uniform": necking_uniform, "reference": necking_reference},
    "pressed_rubber_block": {"reference": pressed_rubber_block},
}
