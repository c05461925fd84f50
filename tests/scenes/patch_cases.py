"""Contact patch test: the exact stress is uniform in both blocks, whatever the meshes, elements and formulation."""
import common_checks
import numpy as np

import references

FORMULATIONS = {
    "semismooth": {"semismooth": {}},
    "uzawa": {"uzawa": {}},
    "penalty": {"penalty": {"alpha": 1e5}},
    "vi": {"vi": {}},
    "dual": common_checks.DUAL,
}


def elements(shape, orders=(1, 2)):
    """(label, changes) for every cell shape, order and kind of mesh; `shape` is the .geo's name of the switch."""
    for flag in (1, 0):
        for order in orders:
            for structured in (1, 0):
                label = f"{shape if flag else 'simplices'}, order {order}, {'7:3' if structured else 'unstructured'}"
                yield label, {
                    f"mesh.parameters.{shape}": flag,
                    "mesh.parameters.structured": structured,
                    # Recombined cells come in pairs along an edge: 3 and 7 would give 4 and 8, and the meshes match.
                    "mesh.parameters.n_lower": 3 if structured else 5,
                    "mesh.order": order,
                }


def check_exact(bench, label, results, up):
    """Stress and multipliers to rounding."""
    normal = "xyz"[up] * 2
    others = [name for name in results.tensor if name != normal and not (up == 1 and name == "zz")]
    wrong = max(np.abs(results.stress(normal) + 1.0).max(), *(np.abs(results.stress(name)).max() for name in others))
    bench.below(f"{label}: largest error of the stress", wrong, 1e-10)
    pressure = results.surface["interface"]["pressure"]
    bench.below(f"{label}: largest error of the multipliers", np.abs(pressure - 1.0).max(), 1e-10)


def check_uniform(bench, label, results, up):
    """Stress -1 along `up` (the pressed direction) and zero across, and the displacements that follow, per body."""
    normal = "xyz"[up] * 2
    others = [name for name in results.tensor if name != normal and not (up == 1 and name == "zz")]
    bench.below(f"{label}: largest error of the stress", np.abs(results.stress(normal) + 1.0).max(), 1e-3)
    bench.below(f"{label}: largest other stress", max(np.abs(results.stress(name)).max() for name in others), 1e-3)
    materials = {name: law["elastic"] for name, law in results.deck["materials"].items()}
    for body, material in results.deck["bodies"].items():
        E, nu = materials[material]["E"], materials[material]["nu"]
        across = references.uniaxial_plane_strain(1.0, E, nu)[0] if up == 1 else nu / E
        nodes = results.in_body(body)
        error = results.nodal["displacement"][nodes, 0] - across * results.places[nodes, 0]
        bench.below(f"{label}: error of the sliding of {body}", np.abs(error).max() / across, 1e-3)


def run_elements(bench, scene, shape, up, formulations):
    for label, changes in elements(shape):
        for name in formulations:
            results = bench.run(scene, {**changes, "contact.0.enforce": FORMULATIONS[name]})
            check_uniform(bench, f"{label}, {name}", results, up)


def elements_2d(bench):
    """Every element, semismooth."""
    run_elements(bench, "patch_2d", "quads", 1, ["semismooth"])


def formulations_2d(bench):
    """Every element, the other formulations."""
    run_elements(bench, "patch_2d", "quads", 1, ["uzawa", "penalty"])


def vi_2d(bench):
    """Every element, vi; then with every step searched for a fall of energy: the first one, of a body that nothing holds
    yet, is a million times too long and must be cut down."""
    run_elements(bench, "patch_2d", "quads", 1, ["vi"])
    searched = {"contact.0.enforce": FORMULATIONS["vi"], "petsc.vi_free_iterations": 0}
    check_uniform(bench, "vi, energy descent", bench.run("patch_2d", searched), 1)


def projection_2d(bench):
    """Projection along the slave's normal."""
    for label, changes in elements("quads"):
        results = bench.run("patch_2d", {**changes, "contact.0.projection": {"slave_normal": {}}})
        check_uniform(bench, f"{label}, slave normal", results, 1)


def elements_3d(bench):
    run_elements(bench, "patch_3d", "hexes", 2, ["semismooth"])


def formulations_3d(bench):
    run_elements(bench, "patch_3d", "hexes", 2, ["uzawa", "penalty"])


def run_segments(bench, scene, shape, up, formulations):
    """Integration on segments, with the finer side as slave and with the coarser one."""
    for label, changes in elements(shape):
        # Shape functions on a quadrilateral that is no parallelogram are not polynomials in place: no rule is exact for
        # them, one of order 16 is to 1e-11.
        skewed = changes["mesh.parameters.structured"] == 0 and shape == "hexes" and changes["mesh.parameters.hexes"] == 1
        for name in formulations:
            for side, (slave, master) in {
                "fine": ("upper_bottom", "lower_top"),
                "coarse": ("lower_top", "upper_bottom"),
            }.items():
                formulation = {"uzawa": {"tolerance": 1e-13}} if name == "uzawa" else FORMULATIONS[name]
                results = bench.run(
                    scene,
                    {
                        **changes,
                        "contact.0.slave": slave,
                        "contact.0.master": master,
                        "contact.0.enforce": formulation,
                        "contact.0.integration": {"segment": {"order": 16 if skewed else 4}},
                        "petsc": {"snes_rtol": 1e-13},
                    },
                )
                check_exact(bench, f"{label}, {name}, {side} slave", results, up)


def serendipity(bench, scene, shape, up):
    """Cells of order 2 that come with 8 or 20 nodes, on segments, the coarser side as slave."""
    for name in ("semismooth", "dual", "vi"):
        results = bench.run(
            scene,
            {
                "mesh.parameters.serendipity": 1,
                "mesh.parameters.n_lower": 2,
                "mesh.parameters.n_upper": 3,
                "mesh.order": 2,
                "contact.0.slave": "lower_top",
                "contact.0.master": "upper_bottom",
                "contact.0.enforce": FORMULATIONS[name],
                "contact.0.integration": {"segment": {"order": 4}},
                "petsc": {"snes_rtol": 1e-13},
            },
        )
        check_exact(bench, f"{shape} without nodes on the middles of their faces, {name}", results, up)


def segments_2d(bench):
    run_segments(bench, "patch_2d", "quads", 1, ["semismooth", "uzawa", "vi", "dual"])


def segments_3d(bench):
    run_segments(bench, "patch_3d", "hexes", 2, ["semismooth"])


def segments_uzawa_3d(bench):
    run_segments(bench, "patch_3d", "hexes", 2, ["uzawa"])


def segments_vi_3d(bench):
    run_segments(bench, "patch_3d", "hexes", 2, ["vi"])


def segments_dual_3d(bench):
    run_segments(bench, "patch_3d", "hexes", 2, ["dual"])


CASES = {
    "patch_2d": {"elements": elements_2d, "formulations": formulations_2d, "vi": vi_2d, "projection": projection_2d, "segments": segments_2d, "serendipity": lambda bench: serendipity(bench, "patch_2d", "quads", 1), "ranks": lambda bench: common_checks.ranks_agree(bench, "patch_2d")},
    "patch_3d": {"elements": elements_3d, "formulations": formulations_3d, "segments": segments_3d, "segments_uzawa": segments_uzawa_3d, "segments_vi": segments_vi_3d, "segments_dual": segments_dual_3d, "serendipity": lambda bench: serendipity(bench, "patch_3d", "hexes", 2), "ranks": lambda bench: common_checks.ranks_agree(bench, "patch_3d")},
}
