"""Friction against closed forms."""
import numpy as np

import common_checks
import references

# --- partial slip of cylinders ----------------------------------------------------------------------------------------

MU, RADIUS, YOUNG, POISSON, LOAD = 0.3, 500.0, 210e3, 0.3, 100.0
RATIOS = (0.25, 0.5, 0.75)  # Q / (mu P) at t = 1 + ratio


def slip_error(results, ratio):
    """L2 of the shear traction's error, relative to the L2 norm of the bound mu p; and the same relative to the error of
    the best function that is linear between nodes. The exact traction has vertical tangents at a and c."""
    points, a, p0 = results.points["interface"], *partial_slip_contact()

    def exact(x):
        return references.cattaneo_mindlin(x, a, MU * p0, ratio)[1]

    error = np.abs(points["shear"][:, 0]) - exact(points["places"][:, 0])
    size = np.sqrt(np.sum(points["weight"] * error**2))
    _, least = references.best_linear(np.sort(results.surface["interface"]["places"][:, 0]), exact)
    return size / (MU * p0 * np.sqrt(4.0 * a / 3.0)), size / least


def partial_slip_contact():
    return references.line_contact(LOAD, RADIUS, references.contact_modulus((YOUNG, POISSON), (YOUNG, POISSON)))


def partial_slip(bench, results, ratio):
    """One state against Cattaneo and Mindlin."""
    label, h = f"Q/(mu P) = {ratio}", results.deck["mesh"]["parameters"]["h"]
    results = results.at(1.0 + ratio)
    points, a, p0 = results.points["interface"], *partial_slip_contact()
    x, weight, status, shear = points["places"][:, 0], points["weight"], points["status"], points["shear"]
    bench.close(f"{label}: normal force", np.sum(points["pressure"] * weight), LOAD, 1e-6)
    bench.close(f"{label}: shear force", abs(np.sum(shear[:, 0] * weight)), ratio * MU * LOAD, 1e-6)
    c = a * np.sqrt(1.0 - ratio)
    for side, edge in (("left", -x[status == 1].min()), ("right", x[status == 1].max())):
        bench.below(f"{label}: stick edge on the {side}, in cells", abs(edge - c) / h, 1.0)
        bench.close(f"{label}: stick half-width on the {side}", edge, c, 0.02)
    error, over_least = slip_error(results, ratio)
    bench.below(f"{label}: L2 of the shear traction's error / L2 of mu p", error, 0.02)
    bench.below(f"{label}: this error / that of the best piecewise linear function", over_least, 1.0)
    slipping = status == 2
    off = np.abs(np.linalg.norm(shear[slipping], axis=1) - MU * points["pressure"][slipping]).max() / (MU * p0)
    bench.below(f"{label}: distance of sliding points from the bound", off, 1e-10)


def cattaneo_mindlin(bench):
    """Cells of a/20."""
    results = bench.run("cattaneo_mindlin_2d")
    for ratio in RATIOS:
        partial_slip(bench, results, ratio)


def cattaneo_mindlin_segments(bench):
    """The same with integration on segments."""
    once = {f"steps.{i}.increments": 1 for i in (1, 2, 3)}
    results = bench.run("cattaneo_mindlin_2d", {**once, "contact.0.integration": {"segment": {}}})
    for ratio in RATIOS:
        partial_slip(bench, results, ratio)


def cattaneo_mindlin_convergence(bench):
    """The error falls with the cells' size; the increments of a force that only grows do not matter (here one for each
    ratio). Where a and c lie in their cells changes single errors, so that those of the three ratios are taken
    together."""
    errors = []
    once = {f"steps.{i}.increments": 1 for i in (1, 2, 3)}
    for cells in (10, 20, 40):
        h = 0.742790 / cells
        results = bench.run("cattaneo_mindlin_2d", {**once, "mesh.parameters.h": h})
        errors.append(np.linalg.norm([slip_error(results.at(1.0 + ratio), ratio)[0] for ratio in RATIOS]))
        print(f"     a/{cells}: error of the shear traction {errors[-1]:.3e}")
    bench.below("error at a/40 over error at a/10", errors[-1] / errors[0], 0.5)


def cattaneo_mindlin_held(bench):
    """Under constant forces nothing moves, however many increments are taken, with any formulation."""
    changes = {
        "mesh.parameters.h": 0.742790 / 10,
        "boundary.1.resultant.x": "0.5*mu*P*min(max(t-1,0),1)",
        "steps": [
            {"name": "press", "to": 1, "increments": 4},
            {"name": "shear", "to": 2, "increments": 4},
            {"name": "hold", "to": 3, "increments": 20},
        ],
    }
    formulations = {"semismooth": {"semismooth": {}}, "dual basis": common_checks.DUAL, **common_checks.OTHERS}
    for name, enforce in formulations.items():
        results = bench.run("cattaneo_mindlin_2d", {**changes, "contact.*.enforce": enforce}, ranks=1)
        moved, held = results.history["displacement_top_x"], results.history["time"] >= 2.0 - 1e-9
        bench.below(f"{name}: motion while held / motion before", np.ptp(moved[held]) / np.abs(moved).max(), 1e-8)
        change = np.abs(results.points["interface"]["shear"] - results.at(2.0).points["interface"]["shear"]).max()
        largest = np.abs(results.points["interface"]["shear"]).max()
        bench.below(f"{name}: change of the shear traction / largest", change / largest, 1e-8)


# --- a sphere pushed to and fro ---------------------------------------------------------------------------------------


class PushedSphere:
    """Forces of the whole sphere (the deck has half) over the displacement that the deck prescribes."""

    def __init__(self, results):
        self.history, constants = results.history, results.deck["constants"]
        self.time, self.amplitude = self.history["time"], float(constants["D"])
        self.moved = self.amplitude * 2 / np.pi * np.arcsin(np.sin(np.pi / 2 * np.maximum(self.time - 1.0, 0.0)))
        self.force = 2.0 * self.history["contact_interface_force_x"]
        self.normal = 2.0 * np.abs(self.history["contact_interface_force_z"])
        law = results.deck["materials"]["rubber"]["elastic"]
        E, nu = float(law["E"]), law["nu"]
        self.a, _ = references.sphere_contact(self.normal[-1], 10.0, references.contact_modulus((E, nu)))
        self.compliance = (2.0 - nu) * 2.0 * (1.0 + nu) / E

    def between(self, begin, end):
        return np.flatnonzero((self.time >= begin - 1e-9) & (self.time <= end + 1e-9))

    def loop(self, begin, end):
        """Area between the branches, and what friction dissipates meanwhile."""
        rows = self.between(begin, end)
        dissipated = 2.0 * np.sum(self.history["contact_interface_dissipation"][rows[1:]])
        return abs(np.trapz(self.force[rows], self.moved[rows])), dissipated


def mindlin_cycling(bench):
    """Two cycles against Mindlin and Deresiewicz for the measured forces."""
    results = bench.run("mindlin_sphere_cycling")
    sphere = PushedSphere(results)
    at = {t: sphere.between(t, t)[0] for t in (2, 4, 6)}
    amplitude, normal = 0.5 * (sphere.force[at[6]] - sphere.force[at[4]]), sphere.normal[-1]
    bench.below("largest change of the normal force", np.ptp(sphere.normal[sphere.time >= 1.0]) / normal, 1e-3)
    arguments = (normal, sphere.a, sphere.compliance, MU)
    first, second = sphere.loop(2, 6), sphere.loop(6, 10)
    label = f"Q*/(mu P) = {abs(amplitude) / (MU * normal):.3f}"
    bench.close(f"{label}: area of the second loop", second[0],
                references.mindlin_loop_energy(abs(amplitude), *arguments), 0.05)
    bench.close(f"{label}: displacement at Q*", sphere.amplitude,
                references.mindlin_displacement(abs(amplitude), *arguments), 0.03)
    difference = np.abs(sphere.force[sphere.between(2, 6)] - sphere.force[sphere.between(6, 10)]).max()
    bench.below("largest difference of the two cycles / Q*", difference / abs(amplitude), 1e-3)
    bench.close("area of the second loop against the first", second[0], first[0], 1e-3)
    # The sum of increments takes the traction at their ends, which is on the high side while it grows.
    bench.close("dissipation in the second cycle against the loop's area", second[1], second[0], 0.03)
    # Masing: the way back starts where a first push to the other side would end.
    bench.close("force at -D against that at +D", sphere.force[at[4]], -sphere.force[at[2]], 1e-3)
    c = np.sqrt(2.0 * sphere.history["contact_interface_stick_area"][at[2]] / np.pi)
    exact = sphere.a * (1.0 - abs(sphere.force[at[2]]) / (MU * normal)) ** (1.0 / 3.0)
    parameters = {"patch": 0.17, **results.deck["mesh"]["parameters"]}
    bench.below("radius of the stick zone, in cells", abs(c - exact) / (parameters["patch"] / parameters["n"]), 1.0)


# --- a stack of plates ------------------------------------------------------------------------------------------------

PAIRS = ("lower", "middle", "upper")


def slid_stack(bench, label, results):
    """Everything slides: each pair passes on the whole weight P, and mu P against its motion; every plate is in
    balance; no point is outside Coulomb's cone."""
    P, history = float(results.deck["constants"]["P"]), results.history
    mu = {pair["name"]: pair["friction"]["coulomb"]["mu"] for pair in results.deck["contact"]}
    lower, middle, upper = (mu[pair] * P for pair in PAIRS)
    # on the slave, the plate above; plate 2 goes towards +x, plate 4 towards +y
    expected = {"lower": (-lower, 0, P), "middle": (middle, 0, P), "upper": (0, -upper, P)}
    for pair, force in expected.items():
        found = np.array([history[f"contact_{pair}_force_{c}"][-1] for c in "xyz"])
        bench.below(f"{label}, {pair}: error of the force / P", np.linalg.norm(found - force) / P, 3e-5)
        points = results.points[pair]
        slipping, pressed = points["status"] == 2, points["pressure"] > 0.0
        bench.below(f"{label}, {pair}: pressed points that do not slide", np.sum(pressed & ~slipping), 0)
        shear, bound = np.linalg.norm(points["shear"], axis=1), mu[pair] * points["pressure"]
        bench.below(f"{label}, {pair}: distance from Coulomb's cone", np.abs(shear - bound).max() / bound.max(), 1e-10)
    forces = {pair: [history[f"contact_{pair}_force_{c}"] for c in "xyz"] for pair in PAIRS}
    held = {2: "ends_2", 3: "ends_3", 4: "top_4"}
    for plate, below, above in ((2, "lower", "middle"), (3, "middle", "upper"), (4, "upper", None)):
        for i, c in enumerate("xy"):
            sum_ = forces[below][i] - (forces[above][i] if above else 0.0) + history[f"reaction_{held[plate]}_{c}"]
            bench.below(f"{label}, plate {plate}: forces along {c} out of balance / P", np.abs(sum_).max() / P, 1e-8)


def stack(bench):
    for name, enforce in {"semismooth": {"semismooth": {}}, **common_checks.OTHERS}.items():
        slid_stack(bench, name, bench.run("stack_with_friction_3d", {"contact.*.enforce": enforce}))


def stack_segments(bench):
    """Meshes of quadrangles on triangles, which segments cut exactly."""
    slid_stack(bench, "segments", bench.run("stack_with_friction_3d", {"contact.*.integration": {"segment": {}}}))


def stack_ranks(bench, changes=None):
    """Displacements and tractions on 2 and 3 ranks equal those on 1 to 1e-8 of their largest."""
    reference = bench.run("stack_with_friction_3d", changes, ranks=1)

    def in_order(results, pair, field):
        """By place, and where nodes of facets share one, by area and pressure."""
        points = results.points[pair]
        ties = (np.round(points["pressure"] / points["pressure"].max(), 6), np.round(points["weight"], 9))
        return points[field][np.lexsort((*ties, *np.round(points["places"], 9).T))]

    for ranks in (2, 3):
        results = bench.run("stack_with_friction_3d", changes, ranks=ranks)
        exact = reference.nodal_sorted("displacement")
        error = np.abs(results.nodal_sorted("displacement") - exact).max() / np.abs(exact).max()
        bench.below(f"{ranks} ranks: displacement", error, 1e-8)
        for pair in PAIRS:
            for field in ("pressure", "shear"):
                exact = in_order(reference, pair, field)
                error = np.abs(in_order(results, pair, field) - exact).max() / np.abs(exact).max()
                bench.below(f"{ranks} ranks: {field} of {pair}", error, 1e-8)


# --- the path matters -------------------------------------------------------------------------------------------------


def press_and_shift(bench, press, shift):
    """The scene with these increments (anything that a step's key `increments` takes)."""
    return bench.run("cylinder_press_shear_path", {"steps.0.increments": press, "steps.1.increments": shift}, ranks=1)


def path_distance(results, reference, time):
    """L2 of the difference of the shear tractions at `time` / L2 of the bound mu p."""
    (found, exact) = ({k: v[np.lexsort(np.round(points["places"], 9).T)] for k, v in points.items()}
                      for points in (run.at(time).points["interface"] for run in (results, reference)))
    difference = np.sum(exact["weight"] * np.sum((found["shear"] - exact["shear"]) ** 2, axis=1))
    return np.sqrt(difference / np.sum(exact["weight"] * (MU * exact["pressure"]) ** 2))


def press_shear_path(bench):
    """Increments of 1/100 are near the limit of a fine path; 1 and 2 are far off, in the shear traction and in how much
    of the contact sticks, although their forces are in balance just as well."""
    fine = press_and_shift(bench, 100, 100)
    few, some, more = (press_and_shift(bench, *increments) for increments in ((1, 2), (10, 10), (30, 30)))
    for time, name in ((1.0, "pressed"), (2.0, "shifted")):
        errors = [path_distance(results, fine, time) for results in (few, some, more)]
        print(f"     {name}: distance from the fine path {', '.join(f'{error:.3e}' for error in errors)}")
        bench.below(f"{name}: 0.1 / distance of the large increments from the fine path", 0.1 / errors[0], 1.0)
        bench.below(f"{name}: distance of increments of 1/30", errors[2], 0.005)
        # With an error in proportion to the increment this is (1/30 - 1/100) / (1/10 - 1/100) = 0.26.
        bench.below(f"{name}: distance of 1/30 over that of 1/10", errors[2] / errors[1], 0.31)


def press_shear_path_control(bench):
    """A path tolerance for each step is kept, against the fine path, in fewer increments than that has; and the run's own
    estimate is not below its distance."""
    fine = press_and_shift(bench, 100, 100)
    for tolerance in (0.05, 0.02):
        auto = {"auto": {"first": 0.1, "path_tolerance": tolerance}}
        results = press_and_shift(bench, auto, auto)
        distances = [path_distance(results, fine, time) for time in (1.0, 2.0)]
        said = results.summary["path"]["estimated_error"]
        print(f"     tolerance {tolerance}: {results.summary['increments']} increments, distance {distances[0]:.2e} pressed, "
              f"{distances[1]:.2e} shifted, the run says {said:.2e}")
        bench.below(f"tolerance {tolerance}: distance from the fine path / tolerance", max(distances) / tolerance, 1.0)
        bench.below(f"tolerance {tolerance}: distance from the fine path / what the run says", max(distances) / said, 1.0)
        bench.below(f"tolerance {tolerance}: increments", results.summary["increments"], 150)


CASES = {
    "cattaneo_mindlin_2d": {"reference": cattaneo_mindlin, "segments": cattaneo_mindlin_segments,
                            "convergence": cattaneo_mindlin_convergence, "held": cattaneo_mindlin_held},
    "mindlin_sphere_cycling": {"reference": mindlin_cycling},
    "cylinder_press_shear_path": {"reference": press_shear_path, "path_control": press_shear_path_control},
    "stack_with_friction_3d": {"reference": stack, "segments": stack_segments, "ranks": stack_ranks},
}
