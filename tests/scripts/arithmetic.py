#!/usr/bin/python3
"""The arithmetic of studies on data whose answer is known: power laws, extrapolation, fronts, integrals, paths, words."""
import copy
import json
import math
import random
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np

TOP = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(TOP / "scripts"))
import course_analysis  # noqa: E402
import deck_edit  # noqa: E402
import expressions  # noqa: E402
import performance_model  # noqa: E402
import plan_models  # noqa: E402
import study_analysis  # noqa: E402
import study_file  # noqa: E402
import study_results  # noqa: E402
import study_words  # noqa: E402

NUMBER = {"type": "number"}
# A schema in the shape that `amontons schema` has: maps, lists, tagged alternatives, free names.
SCHEMA = {"properties": {
    "mesh": {"properties": {"order": NUMBER, "parameters": {"additionalProperties": NUMBER}},
             "additionalProperties": False},
    "contact": {"items": {"properties": {
        "name": NUMBER,
        "enforce": {"anyOf": [
            {"const": "semismooth"},
            {"properties": {"semismooth": {"properties": {"alpha": NUMBER}}}, "additionalProperties": False},
            {"properties": {"penalty": {"anyOf": [{"properties": {"alpha": NUMBER}}]}}, "additionalProperties": False}]},
    }, "additionalProperties": False}},
}, "additionalProperties": False}
DECK = {"mesh": {"order": 1, "parameters": {"h": 0.1}}, "contact": [{"name": "a", "enforce": {"semismooth": {"alpha": 2}}}]}


class Powers(unittest.TestCase):
    def test_exact_law(self):
        x = [0.2, 0.1, 0.05, 0.02]
        power = study_analysis.fit_power(x, [3.0 * value**1.5 for value in x])
        self.assertAlmostEqual(power.exponent, 1.5, 12)
        self.assertAlmostEqual(power.last, 1.5, 12)
        self.assertAlmostEqual(power.fit, 1.0, 12)
        self.assertLess(power.deviation, 1e-12)
        self.assertTrue(power.clear)

    def test_scatter_is_within_its_standard_error(self):
        """With log-normal scatter the exponent is off by more than three standard errors in few cases only; for 6 degrees of
        freedom Student's t gives 2.4 %."""
        source, missed = random.Random(7), 0
        x = [2.0**-k for k in range(8)]
        for _ in range(1000):
            y = [value**2 * math.exp(source.gauss(0.0, 0.2)) for value in x]
            power = study_analysis.fit_power(x, y)
            missed += abs(power.exponent - 2.0) > 3.0 * power.deviation
        self.assertTrue(10 <= missed <= 40, missed)

    def test_no_law(self):
        self.assertFalse(study_analysis.fit_power([1, 2, 4, 8], [1.0, 3.0, 0.5, 1.1]).clear)
        self.assertIsNone(study_analysis.fit_power([1, 2], [1, 2]))
        self.assertIsNone(study_analysis.fit_power([1, 1, 1], [1, 2, 3]))
        self.assertIsNone(study_analysis.fit_power([1, 2, 3], [1.0, 0.0, None]))


class PerformanceModel(unittest.TestCase):
    RATES = {"start": 2e-5, "bulk": 4e-7, "search and contact": 3e-6, "certificate and output": 5e-7,
             "set-ups": 3e-5, "iterations": 4e-7}

    def summary(self, unknowns, newton, linear, set_ups, busy=1.0):
        """What a run with these rates leaves behind; all phases take `busy` times their CPU time."""
        counts = performance_model.Counts(newton, linear, set_ups, 4)
        work = performance_model.parts_of(unknowns, counts)
        cpu = {name: rate * work[name][0] for name, rate in self.RATES.items()}
        phases = {"mesh": cpu["start"], "bulk": cpu["bulk"], "contact": cpu["search and contact"],
                  "certificate": cpu["certificate and output"], "linear solver": cpu["set-ups"] + cpu["iterations"]}
        return {"scene": {"unknowns": {"displacement": unknowns, "multipliers": 0}}, "newton_iterations": newton,
                "linear_iterations": linear, "factorizations": set_ups, "increments": 4,
                "resources": {"cpu_seconds": sum(cpu.values()),
                              "phase_seconds": {name: busy * value for name, value in phases.items()}}}

    def test_rates_are_found_again(self):
        fit = performance_model.fit([self.summary(1e5, 40, 150, 1), self.summary(7e5, 50, 260, 2, busy=3.0)])
        for name, rate in self.RATES.items():
            self.assertAlmostEqual(fit.seconds[name] / rate, 1.0, 9, name)
        for misfit in fit.misfits:
            self.assertAlmostEqual(misfit, 1.0, 9)

    def test_one_run_is_not_enough(self):
        with self.assertRaises(ValueError):
            performance_model.fit([self.summary(1e5, 40, 150, 1)])

    def test_a_network_without_cost_loses_only_on_the_interface(self):
        free = performance_model.Network(latency=0.0, bandwidth=math.inf, hop=0.0)
        fit = performance_model.Fit(self.RATES)
        counts = performance_model.Counts(12, 60, 0.1, 1)
        one, many = (performance_model.wall_seconds(fit, 1e7, ranks, counts, free) for ranks in (1, 512))
        for name in one:
            expected = 1.0 if one[name] == 0.0 else 64.0 if name == "search and contact" else 512.0
            self.assertAlmostEqual(one[name] / (many[name] or 1.0) if one[name] else 1.0, expected, 6, name)

    def test_costs_of_messages(self):
        counts = performance_model.Counts(12, 60, 0.1, 1)
        self.assertEqual(sum(performance_model.communication(1e7, 1, counts).values()), 0.0)
        slow = performance_model.Network(latency=1.0, bandwidth=math.inf, hop=0.0)
        fast = performance_model.Network(latency=0.0, bandwidth=1.0, hop=0.0)
        grid = performance_model.Multigrid(coarsening=1e9)
        # One level: latency of 26 messages whatever the size; a surface of (N / P)^(2/3) values.
        for network, ratio in ((slow, 1.0), (fast, 8 ** (2 / 3))):
            big, small = (performance_model.communication(n, 64, counts, network, grid)["halo"] for n in (8e6, 1e6))
            self.assertAlmostEqual(big / small, ratio, 9)
        hops = performance_model.Network(latency=0.0, bandwidth=math.inf, hop=1.0)
        few, many = (performance_model.communication(1e6, ranks, counts, hops)["reductions"] for ranks in (4, 64))
        self.assertAlmostEqual(many / few, 3.0, 9)


class Courses(unittest.TestCase):
    def test_order_is_found_above_rounding(self):
        quadratic = [1e3, 1e2, 1e0, 1e-4, 1e-12, 1e-12]
        linear = [1e3 * 0.1**k for k in range(16)]
        self.assertAlmostEqual(course_analysis.tails([quadratic])[0], 2.0)
        self.assertAlmostEqual(course_analysis.tails([linear])[0], 1.0)
        self.assertAlmostEqual(course_analysis.tails([quadratic])[1], 1e-4)
        self.assertTrue(np.isnan(course_analysis.tails([[1.0, 1e-9]])[0]))

    def test_distance_of_histories(self):
        one = {"time": np.array([0.0, 1.0]), "reaction_a_x": np.array([0.0, 4.0]), "reaction_a_y": np.array([0.0, 1e-3]),
               "newton": np.array([3.0, 3.0])}
        other = {**one, "reaction_a_y": np.array([0.0, 2e-3]), "newton": np.array([3.0, 5.0])}
        self.assertAlmostEqual(course_analysis.apart(one, other), 1e-3 / 4)
        finer = {"time": np.array([0.0, 0.5, 1.0]), **{name: np.array([0.0, 2.0, 4.0]) * column[1] / 4
                                                       for name, column in one.items() if name != "time"}}
        self.assertAlmostEqual(course_analysis.apart(one, finer), 0.0)

    def test_work_that_is_missing(self):
        history = {"energy_external_work": np.array([1.0, 2.0]), "energy_stored": np.array([0.5, 1.0]),
                   "energy_dissipated": np.array([0.5, 0.9])}
        self.assertAlmostEqual(course_analysis.unbalanced(history), 0.05)


class Extrapolation(unittest.TestCase):
    def test_recovers_limit_and_order(self):
        for sizes in ([0.4, 0.2, 0.1], [0.5, 0.3, 0.1, 0.07]):  # ratios need not be equal
            for order in (0.5, 1.0, 2.3):
                values = [5.0 - 3.0 * s**order for s in sizes]
                limit, uncertainty, found = study_analysis.extrapolate(sizes, values)
                self.assertAlmostEqual(limit, 5.0, 9)
                self.assertAlmostEqual(found, order, 9)
                self.assertAlmostEqual(uncertainty, 3.0 * sizes[-1]**order, 9)

    def test_falls_back_on_the_finest(self):
        for values in ([1.0, 2.0, 1.5], [1.0, 1.1, 1.5], [1.0, 2.0, 2.0]):
            limit, uncertainty, order = study_analysis.extrapolate([0.4, 0.2, 0.1], values)
            self.assertEqual((limit, uncertainty, order), (values[2], abs(values[2] - values[1]), None))
        self.assertEqual(study_analysis.extrapolate([0.4, 0.2, 0.1], [3.0, 3.0, 3.0]), (3.0, 0.0, None))


class Choice(unittest.TestCase):
    def test_front_is_what_nobody_beats(self):
        source = random.Random(3)
        costs, errors = ([source.random() for _ in range(200)] for _ in range(2))
        front = study_analysis.pareto(costs, errors)
        for i in range(200):
            beaten = any((costs[j] <= costs[i] and errors[j] < errors[i]) or (costs[j] < costs[i] and errors[j] <= errors[i])
                         for j in range(200))
            self.assertEqual(i in front, not beaten)
        self.assertEqual([costs[i] for i in front], sorted(costs[i] for i in front))

    def test_cheapest(self):
        self.assertEqual(study_analysis.cheapest([3, 1, 2], [0.001, 0.2, 0.009], 0.01), 2)
        self.assertIsNone(study_analysis.cheapest([3, 1], [0.1, 0.2], 0.01))


class Expressions(unittest.TestCase):
    def test_values(self):
        x = np.array([0.0, 0.6, 2.0])
        found = expressions.evaluate("p0*sqrt(max(0, 1 - (x/a)^2))", {"p0": 2.0, "a": 1.0, "x": x})
        np.testing.assert_allclose(found, [2.0, 1.6, 0.0], atol=1e-15)
        self.assertEqual(expressions.evaluate("-2^2 + min(3, 4)", {}), -1.0)

    def test_integral(self):
        found = expressions.evaluate("2*integral(sqrt(1 - (u/a)^2), u, -a, a)/a", {"a": 3.0})
        self.assertAlmostEqual(found, np.pi, 12)  # area of the unit circle
        self.assertAlmostEqual(expressions.evaluate("u + integral(u^3, u, 0, 2)", {"u": 5.0}), 9.0, 12)
        self.assertEqual(expressions.names_in("u + integral(b*v, v, 0, c) + sqrt(pi)"), {"u", "b", "c"})

    def test_refused(self):
        for text, words in (("a + b", "unknown name 'b'"), ("sqr(4)", "Did you mean 'sqrt'"), ("a.real", "something else"),
                            ("().__class__", "something else"), ("1 +", "not an expression"), ("integral(a, 2, 0, 1)", "function"), ("1/0", "no value")):
            with self.assertRaisesRegex(deck_edit.StudyError, words):
                expressions.evaluate(text, {"a": 1.0})


class Integrals(unittest.TestCase):
    """The surface integral of a linear field over facets of every kind, against the closed form."""

    def integral(self, places, elements, nodal, function):
        places = np.array(places, float)
        spots, values, weights = study_results.on_facets(places, {code: np.array(nodes) for code, nodes in elements.items()},
                                                         nodal(places))
        np.testing.assert_allclose(values, nodal(spots), atol=1e-13)
        return np.sum(weights * function(spots))

    def test_facets(self):
        def linear(p):
            return 1.0 + p[:, 0] + 2.0 * p[:, 1]

        def eighth(p):
            return p[:, 0]**4 * p[:, 1]**4

        line = self.integral([[0, 0, 0], [3, 4, 0]], {2: [[0, 1]]}, linear, linear)
        self.assertAlmostEqual(line, 5.0 * 6.5, 12)
        triangle = self.integral([[0, 0, 0], [1, 0, 0], [0, 1, 0]], {4: [[0, 1, 2]]}, linear, eighth)
        self.assertAlmostEqual(triangle, math.factorial(4)**2 / math.factorial(10), 14)
        square = self.integral([[0, 0, 1], [2, 0, 1], [2, 1, 1], [0, 1, 1]], {5: [[0, 1, 2, 3]]}, linear, eighth)
        self.assertAlmostEqual(square, 2.0**5 / 25.0, 12)


class Paths(unittest.TestCase):
    def test_alternatives_give_way(self):
        deck = copy.deepcopy(DECK)
        deck_edit.set_value(deck, SCHEMA, "contact[0].enforce.penalty.alpha", 10)
        self.assertEqual(deck["contact"][0]["enforce"], {"penalty": {"alpha": 10}})
        deck["contact"][0]["enforce"] = "semismooth"
        deck_edit.set_value(deck, SCHEMA, "contact[0].enforce.semismooth.alpha", 3)
        self.assertEqual(deck["contact"][0], {"name": "a", "enforce": {"semismooth": {"alpha": 3}}})
        deck_edit.set_value(deck, SCHEMA, "mesh.parameters.h", 0.2)
        self.assertEqual(deck["mesh"], {"order": 1, "parameters": {"h": 0.2}})

    def test_all_entries(self):
        deck = {"contact": [{"name": "a"}, {"name": "b", "enforce": "semismooth"}]}
        varied = study_file.vary(None, deck, SCHEMA, "a", {"contact[*].enforce": {"penalty": {}}})
        self.assertEqual([pair["enforce"] for pair in varied["contact"]], [{"penalty": {}}] * 2)
        self.assertEqual(study_file.short_name("contact[*].enforce"), "enforce")
        with self.assertRaisesRegex(deck_edit.StudyError, "no list with entries"):
            deck_edit.check_path(DECK, SCHEMA, "mesh[*].order")

    def test_unknown_knobs_and_their_nearest(self):
        for path, words in (("mesh.ordr", "no 'ordr' in 'mesh'. Did you mean 'order'"), ("mehs.order", "Did you mean 'mesh'"),
                            ("h", "Did you mean 'mesh.parameters.h'"), ("contact[1].name", "has 1 entry"),
                            ("contact.name", "unknown knob"), ("mesh..order", "not a path")):
            with self.assertRaisesRegex(deck_edit.StudyError, words):
                deck_edit.check_path(DECK, SCHEMA, path)
        deck_edit.check_path(DECK, SCHEMA, "contact[0].enforce.penalty.alpha")


def read(text):
    """The study in `text` for the deck above."""
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "deck.yaml").write_text(json.dumps(DECK), encoding="utf-8")
        path = Path(folder) / "a.study.yaml"
        path.write_text("deck: deck.yaml\n" + text, encoding="utf-8")
        study = study_file.read_study(path, SCHEMA)
        return study, study_file.variants_of(study, SCHEMA)


class Files(unittest.TestCase):
    def test_variants_are_shared_between_sweeps(self):
        _, variants = read("quantities: {n: {summary: nodes}}\n"
                           "sweeps: {a: {mesh.order: [1, 2], ranks: [1, 2]}, b: {mesh.parameters.h: [0.1, 0.2]}}")
        self.assertEqual(len(variants), 5)  # 4 of a; of b only h = 0.2 is new
        self.assertEqual(sorted(variants[0].sweeps), ["a", "b"])

    def test_wrong_files(self):
        good = "quantities: {n: {summary: nodes}}\n"
        for text, words in (
            (good + "sweeps: {a: {mesh.order: []}}", "has no values"), (good + "sweeps: {a: {}}", "has no knobs"),
            (good + "sweeps: {a: {mesh.order: [1, 1]}}", "same value twice"), (good, "'sweeps' is missing"),
            (good + "sweeps: {a: {ranks: [0]}}", "whole numbers from 1"),
            (good + "sweeps: {a: {mesh.order: [1]}}\nrepetition: 2", "Did you mean 'repetitions'"),
            (good + "sweeps: {a: {mesh.order: [1]}}\nrepetitions: 0", "whole number of at least 1"),
            (good + "sweeps: {a: {'contact[0].enforce.penalty.alpha': [1], 'contact[0].enforce.semismooth.alpha': [1]}}",
             "contradicts itself"),
            ("quantities: {n: {}}\nsweeps: {a: {mesh.order: [1]}}", "exactly one of"),
            ("quantities: {n: {summary: a, reference: {exact: b}}}\nsweeps: {a: {mesh.order: [1]}}", "unknown name 'b'"),
            ("quantities: {n: {summary: a, reference: {finest: b}}}\nsweeps: {a: {mesh.order: [1]}}", "not there"),
            ("quantities: {n: {summary: a, reference: {finest: a}}}\nsweeps: {a: {mesh.order: [1, 2]}}", "three or more"),
        ):
            with self.assertRaisesRegex(deck_edit.StudyError, words):
                read(text)


class Words(unittest.TestCase):
    """What is said of made-up runs with error = 0.99 h^2 and time = 1/h."""

    def outcomes(self, study, variants):
        found = []
        for variant in variants:
            h = variant.knobs["mesh.parameters.h"]
            found.append(study_results.Outcome(variant, "certified", cpu=[1 / h] * 3, wall=[1 / h] * 3, memory=[1e8] * 3,
                                               load=[1.0] * 3, values={"q": 0.99 * h**2}, errors={"q": 0.99 * h**2}))
        return found

    def test_targets_rates_and_failures(self):
        study, variants = read("quantities: {q: {summary: a, reference: {exact: 1}}}\n"
                               "sweeps: {size: {mesh.parameters.h: [0.4, 0.2, 0.1, 0.05]}}")
        outcomes = self.outcomes(study, variants)
        outcomes[3].word, outcomes[3].message = "not converged", "giving up"
        rates = study_words.find_rates(study, outcomes)
        words = study_words.paragraph(study, outcomes, rates, {})
        self.assertIn("5 % costs least with h 0.2 (4 %, 5 s CPU, 100 MB)", words)
        self.assertIn("1 % costs least with h 0.1 (0.99 %, 10 s CPU, 100 MB)", words)
        self.assertIn("no setting reaches 0.1 %; the best is 0.99 % with h 0.1", words)
        self.assertIn("error of q ~ h^2.00", words)
        self.assertIn("CPU time ~ h^-1.00", words)
        self.assertIn("h 0.05 (not converged: giving up)", words)
        self.assertEqual([outcome.variant.knobs["mesh.parameters.h"] for outcome in study_words.front_of(
            outcomes, study.quantities[0])], [0.4, 0.2, 0.1])

    def test_luck_is_named(self):
        study, variants = read("quantities: {q: {summary: a, reference: {exact: 1}}}\n"
                               "sweeps: {size: {mesh.parameters.h: [0.4, 0.2, 0.1]}}")
        outcomes = self.outcomes(study, variants)
        outcomes[0].errors["q"] = 1e-4  # the error goes through zero here
        words = study_words.paragraph(study, outcomes, [], {})
        self.assertIn("by chance or at a price: h 0.2", words)

    def test_uncertain_reference(self):
        study, variants = read("quantities: {q: {summary: a, reference: {finest: size}}}\n"
                               "sweeps: {size: {mesh.parameters.h: [0.4, 0.2, 0.1]}}")
        outcomes = self.outcomes(study, variants)
        for outcome in outcomes:
            outcome.values["q"] += 1.0  # 1 + 0.99 h^2
        finest = study_results.compare_with_finest(study, outcomes)
        self.assertAlmostEqual(finest["q"]["value"], 1.0, 9)
        self.assertAlmostEqual(finest["q"]["order"], 2.0, 9)
        self.assertAlmostEqual(outcomes[1].errors["q"], 0.99 * 0.04, 9)
        words = study_words.paragraph(study, outcomes, [], finest)
        self.assertIn("5 % costs least with h 0.2 (4 %", words)
        self.assertIn("1 % costs least with h 0.1", words)
        self.assertIn("errors below 0.99 % cannot be told with this reference", words)
        self.assertNotIn("0.1 %", words)

    def test_reference_of_zero(self):
        study, variants = read("quantities: {q: {summary: a, reference: {exact: 0}}}\n"
                               "sweeps: {size: {mesh.parameters.h: [0.4, 0.2]}}")
        outcomes = self.outcomes(study, variants)
        for outcome in outcomes:
            study_results.set_error(outcome, study.quantities[0], outcome.values["q"], 0.0)
        words = study_words.paragraph(study, outcomes, [], {})
        self.assertIn("the error is absolute; the smallest is 0.04 with h 0.2", words)


class Plans(unittest.TestCase):
    def test_power_law(self):
        law = plan_models.power_law([0.4, 0.2, 0.1], [3 * 0.4**2, 3 * 0.2**2, 3 * 0.1**2])
        self.assertAlmostEqual(law(0.05), 3 * 0.05**2)
        self.assertAlmostEqual(law.inverse(3e-4), 0.01)
        # What dies out on finer meshes is seen by the first point only.
        law = plan_models.power_law([4.0, 0.2, 0.1], [99.0, 0.2, 0.1])
        self.assertAlmostEqual(law.exponent, 1.0)
        self.assertIsNone(plan_models.power_law([0.2, 0.1], [2.0, 1.0]))
        self.assertIsNone(plan_models.power_law([0.4, 0.2, 0.1], [1.0, 1.0, 1.0]))

    def test_cost_law(self):
        unknowns = [1000, 4000, 16000]
        law = plan_models.cost_law(unknowns, [0.5 + 2e-5 * n**1.2 for n in unknowns], 1.2)
        self.assertAlmostEqual(law.start, 0.5)
        self.assertAlmostEqual(law(1e5), 0.5 + 2e-5 * 1e5**1.2)
        self.assertAlmostEqual(law.inverse(law(5e4)), 5e4, delta=1.0)
        constant = plan_models.cost_law(unknowns, [2.0, 2.0, 1.0], 1.2)  # never falls with the unknowns
        self.assertEqual(constant.rate, 0.0)
        self.assertGreater(constant(1e6), 0.0)

    def test_further_pilot(self):
        self.assertIsNone(plan_models.further_pilot(1999, 500, 10000, 2))  # near enough to the plan
        self.assertIsNone(plan_models.further_pilot(1e6, 5001, 10000, 2))  # as large as pilots may be
        self.assertAlmostEqual(500 / plan_models.further_pilot(2000, 500, 10000, 2)**2, 1500)
        self.assertAlmostEqual(6400 / plan_models.further_pilot(1e6, 6400, 16000, 3)**3, 16000)

    def test_errors_of_values(self):
        found = plan_models.errors_of_values([0.4, 0.2, 0.1], [5.0 + 0.4**1.5, 5.0 + 0.2**1.5, 5.0 + 0.1**1.5])
        for error, size in zip(found, (0.4, 0.2, 0.1)):
            self.assertAlmostEqual(error, size**1.5 / 5.0, places=9)
        found = plan_models.errors_of_values([0.4, 0.2, 0.1], [5.0, 5.1, 5.0])  # no order: at least the last change
        self.assertAlmostEqual(min(found), 0.1 / 5.0)

    def test_increments(self):
        exact = {n: [2.0 + 0.6 / n, 1.0] for n in (1, 4, 10, 20)}  # off by 0.3 / n of the value 2
        found, error = plan_models.fewest_increments(exact, 0.1, 20)
        self.assertEqual(found, 4)
        self.assertAlmostEqual(error, 0.3 / 4, delta=0.01)
        found, error = plan_models.fewest_increments(exact, 0.02, 20)
        self.assertEqual(found, 20)
        self.assertLess(error, 0.02)
        found, _ = plan_models.fewest_increments(exact, 0.001, 20)
        self.assertAlmostEqual(found, 300, delta=10)
        self.assertEqual(plan_models.fewest_increments({1: None, 5: [1.0, 1.0], 10: [1.0, 1.0]}, 0.01, 10), (5, 0.0))
        self.assertEqual(plan_models.fewest_increments({1: None, 5: [1.0]}, 0.01, 5), (5, None))


class Call(unittest.TestCase):
    def test_no_program(self):
        done = subprocess.run([TOP / "scripts/study", "a.study.yaml", "--program", "/nowhere/amontons"], capture_output=True,
                              text=True, check=False)
        self.assertEqual(done.returncode, 2)
        self.assertIn("cannot be run", done.stderr)


if __name__ == "__main__":
    unittest.main()
