"""Checks that any scene must pass: formulations agree, and the number of ranks does not matter."""
import numpy as np

# At the same alpha, multipliers found by an outer loop and as unknowns are the same. A larger alpha makes a penalty's
# penetration smaller, and its pressure rougher where the meshes do not match.
OTHERS = {"uzawa": {"uzawa": {"alpha": 1}}, "penalty": {"penalty": {"alpha": 30}}}
DUAL = {"semismooth": {"basis": "dual"}}


def formulations_agree(bench, scene, changes=None):
    """Against semismooth: nodal pressures of uzawa within 1 % of the peak everywhere, the peak of penalty within 1 %."""
    reference = bench.run(scene, changes)
    for name, enforce in OTHERS.items():
        results = bench.run(scene, {**(changes or {}), "contact.*.enforce": enforce})
        for pair in reference.surface:
            exact = reference.surface_sorted(pair, "pressure").ravel()
            found = results.surface_sorted(pair, "pressure").ravel()
            if name == "uzawa":
                error = np.nanmax(np.abs(found - exact)) / np.nanmax(exact)
                bench.below(f"uzawa, pair {pair}: difference / peak pressure", error, 0.01)
            else:
                bench.close(f"penalty, pair {pair}: peak pressure", np.nanmax(found), np.nanmax(exact), 0.01)


def ranks_agree(bench, scene, changes=None):
    """Displacements and pressures on 2 and 3 ranks equal those on 1 to 1e-8 of their largest, after two increments."""
    changes = {**(changes or {}), "steps.0.increments": 2}
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


def there_and_back(bench, pair, area, force):
    """Area and force of a pair grow up to the largest force and shrink after it, without friction by the same values."""
    top = int(np.argmax(force))
    both = min(top, len(force) - 1 - top)  # increments that have a partner on the other side
    bench.below(f"{pair}: increments without a partner on the way back", abs(len(force) - 1 - 2 * top), 1)
    for name, values in (("area", area), ("force", force)):
        bench.below(f"{pair}: {name}, largest shrinking while loading", -np.diff(values[: top + 1]).min() / values.max(), 0.0)
        bench.below(f"{pair}: {name}, largest growing while unloading", np.diff(values[top:]).max() / values.max(), 0.0)
        difference = np.abs(values[top + 1 :][:both] - values[top - 1 :: -1][:both])
        bench.below(f"{pair}: {name} on the way back / largest", difference.max() / values.max(), 1e-8)
