"""Checks that any scene must pass: formulations agree, and the number of ranks does not matter."""
import numpy as np

OTHERS = {"uzawa": {"uzawa": {}}, "penalty": {"penalty": {"alpha": 1000}}}


def formulations_agree(bench, scene, changes=None):
    """Nodal pressures of uzawa and penalty against semismooth, within 1 % of the peak of each pair."""
    reference = bench.run(scene, changes)
    for name, enforce in OTHERS.items():
        results = bench.run(scene, {**(changes or {}), "contact.*.enforce": enforce})
        for pair in reference.surface:
            exact = reference.surface_sorted(pair, "pressure").ravel()
            error = np.nanmax(np.abs(results.surface_sorted(pair, "pressure").ravel() - exact))
            bench.below(f"{name}, pair {pair}: difference / peak pressure", error / np.nanmax(exact), 0.01)


def ranks_agree(bench, scene, changes=None):
    """Displacements and pressures on 2 and 3 ranks equal those on 1 to 1e-8 of their largest."""
    reference = bench.run(scene, changes, ranks=1)
    for ranks in (2, 3):
        results = bench.run(scene, changes, ranks=ranks)
        exact = reference.nodal_sorted("displacement")
        error = np.abs(results.nodal_sorted("displacement") - exact).max() / np.abs(exact).max()
        bench.below(f"{ranks} ranks: displacement", error, 1e-8)
        for pair in reference.surface:
            exact = reference.surface_sorted(pair, "pressure").ravel()
            error = np.nanmax(np.abs(results.surface_sorted(pair, "pressure").ravel() - exact))
            bench.below(f"{ranks} ranks: pressure of {pair}", error / np.nanmax(exact), 1e-8)
