"""Linear solvers: each of them leads to the same tractions on a scene with friction."""
import numpy as np

MU = 0.3
SMALL = {"steps.0.increments": 1, "steps.1.increments": 4}
MULTIGRID = {"ksp_type": "gmres", "ksp_pc_side": "right", "pc_type": "gamg", "snes_ksp_ew": True}
SOLVERS = {
    "a factorization for every tangent": {"petsc": {"pc_type": "lu", "ksp_type": "preonly"}},
    "kept factorizations": {"petsc": {"pc_type": "shell", "ksp_type": "preonly"}},
    "condensed onto contact": {"petsc": {"pc_type": "shell", "ksp_type": "preonly", "shell_solver": "schur"}},
}
ALONE = {"condensed onto contact"}  # what there is on one rank only


def slid(bench, label, results):
    """All of it slides at the end, with mu N; a resultant is a little less, for directions of slip differ."""
    history, points = results.history, results.points["interface"]
    bench.below(f"{label}: points that do not slide", np.sum(points["status"] != 2), 0)
    shear, normal = (abs(history[f"contact_interface_force_{c}"][-1]) for c in "xz")
    whole = np.sum(np.linalg.norm(points["shear"], axis=1) * points["weight"])
    bench.close(f"{label}: integral of the shear traction's size", whole, MU * normal, 1e-9)
    along = np.sum(-points["shear"][:, 0] * points["weight"])
    bench.close(f"{label}: resultant along the push", shear, abs(along), 1e-9)
    bench.close(f"{label}: resultant / (mu N)", shear / (MU * normal), 1.0, 1e-3)
    bound = MU * points["pressure"]
    off = np.abs(np.linalg.norm(points["shear"], axis=1) - bound).max() / bound.max()
    bench.below(f"{label}: distance from Coulomb's cone", off, 1e-9)
    reactions = [history[f"reaction_{group}_x"] for group in ("base_bottom", "slider_top")]
    bench.below(f"{label}: reactions out of balance", np.abs(sum(reactions)).max() / np.abs(reactions).max(), 1e-8)


def same(bench, label, results, reference, tolerance):
    for name in ("displacement", "pressure"):
        found, exact = (run.nodal_sorted(name) if name == "displacement" else run.surface_sorted("interface", name)
                        for run in (results, reference))
        bench.below(f"{label}: {name}", np.abs(found - exact).max() / np.abs(exact).max(), tolerance)


def press_and_slide(bench):
    runs = {name: bench.run("press_and_slide_3d", {**SMALL, **changes}, ranks=1 if name in ALONE else None)
            for name, changes in SOLVERS.items()}
    reference = runs["a factorization for every tangent"]
    for name, results in runs.items():
        slid(bench, name, results)
        same(bench, name, results, reference, 1e-8)
    bench.below("condensed onto contact: factorizations", runs["condensed onto contact"].summary["factorizations"], 1)
    # The multipliers settle to the tolerance of the Uzawa loop.
    uzawa = bench.run("press_and_slide_3d", {**SMALL, "contact.0.enforce": {"uzawa": {"alpha": 1}}})
    same(bench, "uzawa", uzawa, reference, 1e-6)
    krylov = bench.run("press_and_slide_3d", {**SMALL, "contact.0.enforce": {"uzawa": {"alpha": 1}}, "petsc": MULTIGRID})
    slid(bench, "uzawa with multigrid", krylov)
    same(bench, "uzawa with multigrid", krylov, uzawa, 1e-6)
    bench.below("uzawa with multigrid: linear iterations per Newton iteration",
                krylov.summary["linear_iterations"] / krylov.summary["newton_iterations"], 25)


def refined(bench):
    """Cells halved after distribution give the mesh of twice as many cells, where their numbers are exact doubles."""
    press = {"steps": [{"name": "press", "to": 1, "increments": 1}], "mesh.parameters": {"ratio": 1.0, "n": 6}}
    coarse = bench.run("press_and_slide_3d", {**press, "mesh.refine": 1})
    fine = bench.run("press_and_slide_3d", {**press, "mesh.parameters.n": 12})
    same(bench, "refined after distribution", coarse, fine, 1e-8)


CASES = {"press_and_slide_3d": {"reference": press_and_slide, "refined": refined}}
