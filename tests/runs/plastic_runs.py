"""Plastic flow through a restart: the second half of a run, on any number of ranks, against the run in one piece."""
import numpy as np

from harness import TOP, Results, load_deck, set_key

# Loaded, let go and loaded the other way: the second half depends on what the points remember of the first.
STEPS = [{"name": "push", "to": 1, "increments": 3}, {"name": "pull", "to": 2, "increments": 3}]
HALF_WAY = [STEPS[0], {"name": "pull", "to": 4 / 3, "increments": 1}]
METAL = {
    "elastic_plastic": {
        "E": 240.0, "nu": 0.3, "hardening": {"linear": {"yield": 0.5, "H": 5}}, "kinematic": {"prager": {"H": 5}},
    }
}
VARIANTS = {
    "small strain, quadrilaterals": ({"kinematics": "small", "mesh.parameters.n": 4}, (2, 3)),
    "small strain, triangles of order 2": (
        {"kinematics": "small", "mesh.order": 2, "mesh.parameters": {"n": 3, "quads": 0}}, (2,)
    ),
    "finite strain, quadrilaterals of order 2": ({"mesh.parameters.n": 3, "mesh.order": 2}, (1, 2)),
    "finite strain, triangles": ({"mesh.parameters": {"n": 4, "quads": 0}}, (3,)),
}


def write_deck(case, changes, steps, name):
    deck = load_deck("cook_membrane")
    deck["mesh"]["file"] = str((TOP / "inputs" / "cook_membrane" / deck["mesh"]["file"]).resolve())
    fixed = {
        "materials.rubber": METAL,
        "boundary.1": {"on": "right", "displacement": {"x": 0, "y": "2*(1-abs(1-t))"}},
        "petsc": {"snes_rtol": "1e-13"},
        "steps": steps,
    }
    for path, value in {**fixed, **changes}.items():
        set_key(deck, path, value)
    return case.write(deck, name)


def restart_of_plasticity(case):
    for number, (name, (changes, ranks)) in enumerate(VARIANTS.items()):
        whole = case.folder / f"whole_{number}"
        deck = write_deck(case, changes, STEPS, f"deck_{number}")
        status, text = case.run(1, deck, "--out", whole)
        case.expect(f"{name}: the whole run ends with 0", status == 0, text)
        exact = Results(None, whole)
        plastic = exact.nodal["accumulated_plastic_strain"].max()
        case.expect(f"{name}: there is plastic strain", plastic > 0.02, plastic)
        case.expect(f"{name}: and heat", exact.history["energy_dissipated"][-1] > 0.1 * exact.history["energy_stored"][-1])
        half = write_deck(case, changes, HALF_WAY, f"half_{number}")
        parts = case.folder / f"parts_{number}"
        status, text = case.run(1, half, "--out", parts)
        case.expect(f"{name}: the first half ends with 0", status == 0, text)
        for rank_count in ranks:
            out = case.folder / f"rest_{number}_{rank_count}"
            status, text = case.run(rank_count, deck, "--out", out, "--restart", parts / "checkpoint.h5")
            case.expect(f"{name}: the restart on {rank_count} ranks ends with 0", status == 0, text)
            found = Results(None, out)
            worst = max(
                np.abs(found.nodal_sorted(field) - exact.nodal_sorted(field)).max() / np.abs(exact.nodal_sorted(field)).max()
                for field in ("displacement", "stress", "accumulated_plastic_strain")
            )
            books = abs(found.history["energy_dissipated"][-1] / exact.history["energy_dissipated"][-1] - 1.0)
            print(f"     {name}, on {rank_count} ranks: fields differ by {worst:.1e}, dissipation by {books:.1e}")
            case.expect(f"{name}: same fields on {rank_count} ranks", worst < 1e-9, worst)
            case.expect(f"{name}: same dissipation on {rank_count} ranks", books < 1e-10, books)
