"""What a study found, in words and tables."""

import csv
from dataclasses import dataclass

from study_analysis import Power, cheapest, fit_power, median, pareto, spread
from study_file import number, setting_text, short_name, short_value

TARGETS = (0.05, 0.01, 0.001)


@dataclass
class Rate:
    """A fitted power law: `what` ~ `against`^power in a sweep, with the other knobs of the sweep fixed at `others`."""
    sweep: str
    others: dict
    what: str
    against: str
    power: Power


def main_knob(sweep):
    """The knob that a sweep is drawn over: the first one with several numbers, else the first with several values."""
    varied = {path: values for path, values in sweep.items() if len(values) > 1} or sweep
    numeric = [path for path, values in varied.items() if all(number(value) is not None for value in values)]
    return (numeric or list(varied))[0]


def groups(study, outcomes, name):
    """The solved variants of a sweep, apart for the values of all knobs but the main one, in the order of the main
    knob's values: (others, [(value, outcome)])."""
    sweep, found = study.sweeps[name], []
    knob = main_knob(sweep)
    for outcome in outcomes:
        if name not in outcome.variant.sweeps or not outcome.solved:
            continue
        knobs = outcome.variant.sweeps[name]
        others = {path: value for path, value in knobs.items() if path != knob and len(sweep[path]) > 1}
        place = next((members for known, members in found if known == others), None)
        if place is None:
            place = []
            found.append((others, place))
        place.append((knobs[knob], outcome))
    for _, members in found:
        members.sort(key=lambda member: sweep[knob].index(member[0]))
    return found


def find_rates(study, outcomes):
    """Power laws of errors and of CPU time over the numeric main knobs; of time over unknowns where these vary."""
    rates = []
    for name, sweep in study.sweeps.items():
        knob = main_knob(sweep)
        if any(number(value) is None for value in sweep[knob]):
            continue
        for others, members in groups(study, outcomes, name):
            x = [number(value) for value, _ in members]
            for quantity in study.quantities:
                power = fit_power(x, [outcome.errors.get(quantity.name) for _, outcome in members])
                if power:
                    rates.append(Rate(name, others, quantity.label, short_name(knob), power))
            sizes = [outcome.unknowns for _, outcome in members]
            grows = None not in sizes and len(sizes) > 0 and max(sizes) > 2 * min(sizes)
            power = fit_power(sizes if grows else x, [median(outcome.cpu) for _, outcome in members])
            if power:
                rates.append(Rate(name, others, "CPU time", "unknowns" if grows else short_name(knob), power))
    return rates


def write_table(path, study, outcomes):
    """One row a variant: settings, how it ended, medians and ranges of time and memory, counts, quantities, errors."""
    knobs = list(dict.fromkeys(knob for outcome in outcomes for knob in outcome.variant.knobs if knob != "ranks"))
    head = ["sweeps", *knobs, "ranks", "outcome", "runs"]
    for what in ("cpu_seconds", "wall_seconds", "memory_mb"):
        head += [what, what + "_min", what + "_max"]
    head += ["load_average", "unknowns", "increments", "newton_iterations", "linear_iterations"]
    for quantity in study.quantities:
        head += [quantity.name] + ([quantity.name + "_error"] if quantity.reference else [])
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow([*head, "message"])
        for outcome in outcomes:
            row = [" ".join(outcome.variant.sweeps)]
            row += [short_value(outcome.variant.knobs[knob]) if knob in outcome.variant.knobs else "" for knob in knobs]
            row += [outcome.variant.ranks, outcome.word, len(outcome.wall)]
            for values in (outcome.cpu, outcome.wall, [byte / 1e6 for byte in outcome.memory]):
                row += [f"{value:.6g}" for value in (median(values), min(values), max(values))] if values else [""] * 3
            row += [f"{median(outcome.load):.3g}" if outcome.load else "", outcome.unknowns or ""]
            row += [outcome.summary.get(key, "") for key in ("increments", "newton_iterations", "linear_iterations")]
            for quantity in study.quantities:
                row.append(outcome.values.get(quantity.name, ""))
                if quantity.reference:
                    row.append(outcome.errors.get(quantity.name, ""))
            writer.writerow([*row, outcome.message or "; ".join(outcome.missing.values())])


def write_rates(path, rates):
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(["sweep", "others", "what", "against", "exponent", "standard_error", "r_squared", "points",
                         "exponent_between_last_two"])
        for rate in rates:
            power = rate.power
            writer.writerow([rate.sweep, setting_text(rate.others) if rate.others else "", rate.what, rate.against,
                             f"{power.exponent:.4g}", f"{power.deviation:.2g}", f"{power.fit:.4g}", power.count,
                             f"{power.last:.4g}"])


def percent(value):
    return f"{100 * value:.2g} %"


def comparable(outcomes, quantity):
    """Variants that count in a comparison of cost: certified, with a time and an error."""
    return [outcome for outcome in outcomes
            if outcome.word == "certified" and outcome.cpu and quantity.name in outcome.errors]


def is_absolute(outcomes, quantity):
    return any(quantity.name in outcome.absolute for outcome in outcomes)


def cost_text(outcome):
    return f"{median(outcome.cpu):.2g} s CPU, {median(outcome.memory) / 1e6:.0f} MB"


def cheapest_words(study, outcomes, quantity, finest):
    """The sentence about one quantity: what is it off from, and the cheapest setting for each target."""
    kind = f"against the closed form {quantity.reference[1]}" if quantity.reference[0] == "exact" else ""
    if quantity.name in finest:
        found = finest[quantity.name]
        why = "no order to extrapolate with" if found["closing"] else "which do not converge"
        kind = f"against {found['value']:.6g}, " + (
            f"extrapolated (Richardson) from the sweep '{found['sweep']}' with order {found['order']:.2f}"
            if found["order"] else f"the finest run of the sweep '{found['sweep']}' ({why})"
        ) + f", itself uncertain by {found['uncertainty']:.1e}"
    kind += f", relative to {quantity.scale}" if quantity.scale else ""
    what = "relative L2 error" if quantity.source[0] == "profile" else "relative error"
    good = comparable(outcomes, quantity)
    if not good:
        reasons = {outcome.missing.get(quantity.name) for outcome in outcomes if outcome.solved} - {None}
        why = f" ({'; '.join(sorted(reasons))})" if reasons else ""
        return f"**{quantity.label}**: no certified run gives it{why}."
    if is_absolute(good, quantity):
        best = min(good, key=lambda outcome: outcome.errors[quantity.name])
        return (f"**{quantity.label}** ({kind}): the reference is zero, so the error is absolute; the smallest is "
                f"{best.errors[quantity.name]:.2g} with {setting_text(best.variant.knobs)} ({cost_text(best)}).")
    return f"**{quantity.label}** ({what} {kind}): " + "; ".join(target_words(study, good, quantity, finest)) + "."


def target_words(study, good, quantity, finest):
    """For each target the cheapest setting; targets that the same setting meets together. What a reference is itself
    uncertain by is no error that can be told."""
    errors, costs = [outcome.errors[quantity.name] for outcome in good], [median(outcome.cpu) for outcome in good]
    found = finest.get(quantity.name)
    floor = found["uncertainty"] / abs(found["value"]) if found and found["value"] and not quantity.scale else 0.0
    winners = {}
    for target in (target for target in TARGETS if target >= floor):
        winners.setdefault(cheapest(costs, errors, target), []).append(target)
    for i, targets in winners.items():
        *before, last = map(percent, targets)
        goal = (", ".join(before) + (" or " if i is None else " and ") if before else "") + last
        if i is None:
            i = min(range(len(good)), key=lambda j: errors[j])
            yield (f"no setting reaches {goal}; the best is {percent(errors[i])} with "
                   f"{setting_text(good[i].variant.knobs)} ({cost_text(good[i])})")
            continue
        worse = dearer_and_worse(study, good, good[i], quantity, targets[-1])
        warning = (f" – by chance or at a price: {setting_text(worse.variant.knobs)} in the same sweep costs more "
                   f"and is off by {percent(worse.errors[quantity.name])}") if worse else ""
        yield (f"{goal} cost{'s' * (len(targets) == 1)} least with {setting_text(good[i].variant.knobs)} "
               f"({percent(errors[i])}, {cost_text(good[i])}){warning}")
    if floor > TARGETS[-1]:
        yield f"errors below {percent(floor)} cannot be told with this reference"


def dearer_and_worse(study, outcomes, chosen, quantity, target):
    """The worst setting in a row of numbers with `chosen` that costs more and misses the target all the same; None when
    paying more never loses it."""
    found = []
    for name in chosen.variant.sweeps:
        if number(study.sweeps[name][main_knob(study.sweeps[name])][0]) is None:
            continue
        for _, members in groups(study, outcomes, name):
            row = [outcome for _, outcome in members]
            if any(outcome is chosen for outcome in row):
                found += [outcome for outcome in row if median(outcome.cpu) > median(chosen.cpu)
                          and outcome.errors.get(quantity.name, 0.0) > target]
    return max(found, key=lambda outcome: outcome.errors[quantity.name], default=None)


def rate_words(study, rates):
    """Rates of the first quantity with a reference and of CPU time, a sentence a sweep; rates.csv has all of them."""
    first = next((quantity.label for quantity in study.quantities if quantity.reference), None)
    sentences = []
    for sweep in dict.fromkeys(rate.sweep for rate in rates):
        parts = []
        for rate in rates:
            power = rate.power
            if rate.sweep != sweep or rate.what not in (first, "CPU time"):
                continue
            others = f" ({setting_text(rate.others)})" if rate.others else ""
            last = f", {power.last:.2f} between the last two" if abs(power.last - power.exponent) > 0.15 else ""
            if power.clear:
                what = rate.what if rate.what == "CPU time" else f"error of {rate.what}"
                parts.append(f"{what}{others} ~ {rate.against}^{power.exponent:.2f} (± {power.deviation:.2f}{last})")
            elif abs(power.exponent) < 0.01 and rate.what == first:
                parts.append(f"error of {rate.what}{others} does not depend on {rate.against}")
        if parts:
            sentences.append(f"Sweep '{sweep}': " + "; ".join(parts) + ".")
    return " ".join(sentences)


def failure_words(outcomes):
    failed = [outcome for outcome in outcomes if outcome.word != "certified"]
    if not failed:
        return ""
    return "Not in the comparison: " + "; ".join(
        f"{setting_text(outcome.variant.knobs)} ({': '.join(filter(None, (outcome.word, outcome.message[:120])))})"
        for outcome in failed) + "."


def paragraph(study, outcomes, rates, finest):
    """The study in words (Markdown)."""
    runs = sum(len(outcome.wall) for outcome in outcomes)
    spreads = sorted(spread(outcome.cpu) for outcome in outcomes if len(outcome.cpu) > 1)
    loads = [load for outcome in outcomes for load in outcome.load]
    repetitions = max((len(outcome.wall) for outcome in outcomes), default=0)
    sentences = [f"{len(outcomes)} variants of `{study.deck_path.name}`, {runs} runs in random order "
                 f"(seed {study.seed}). Cost is CPU time summed over ranks, the median of {repetitions} "
                 f"run{'s' * (repetitions != 1)}"
                 + (f"; between repetitions it spreads by {percent(median(spreads))} (median over variants; largest "
                    f"{percent(spreads[-1])})" if spreads else "")
                 + (f"; load average of the machine {min(loads):.1f} to {max(loads):.1f}." if loads else ".")]
    with_reference = [quantity for quantity in study.quantities if quantity.reference]
    sentences += [cheapest_words(study, outcomes, quantity, finest) for quantity in with_reference]
    sentences += [text for text in (rate_words(study, rates), failure_words(outcomes)) if text]
    return "\n\n".join(sentences) + "\n"


def front_of(outcomes, quantity):
    """The variants on the Pareto front of CPU time and one quantity's error, by rising cost."""
    good = comparable(outcomes, quantity)
    return [good[i] for i in pareto([median(outcome.cpu) for outcome in good],
                                    [outcome.errors[quantity.name] for outcome in good])]
