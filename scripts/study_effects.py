"""What every effect of a deck costs and changes: the deck as it is, and with each effect switched off in turn."""

import copy
import csv

from deck_edit import get_value, remove_value
from study_analysis import median, spread
from study_file import Variant
from study_words import percent


def friction_of_pairs(deck):
    """(name, paths that go) for the friction of each contact pair."""
    for i, pair in enumerate(deck.get("contact") or []):
        if "friction" in pair:
            yield f"friction of {pair.get('name', i)}", (f"contact[{i}].friction", f"contact[{i}].friction_factor")


def body_forces(deck):
    if "body_force" in deck:
        yield "body force", ("body_force",)


# A new effect: a function that yields its name and the keys whose absence switches it off.
EFFECTS = (friction_of_pairs, body_forces)


def effect_variants(study):
    """(name, variant): the deck as it is first, then without each effect that it has."""
    found = [("as in the deck", Variant(study.deck, study.ranks, {}, {"effects": {}}))]
    for effect in EFFECTS:
        for name, paths in effect(study.deck):
            deck = copy.deepcopy(study.deck)
            for path in paths:
                if get_value(deck, path) is not None:
                    remove_value(deck, path)
            found.append((f"without {name}", Variant(deck, study.ranks, {"without": name}, {"effects": {}})))
    return found


def change(value, before):
    """Relative change of a quantity, or the value itself where it was zero."""
    if value is None or before is None:
        return "–"
    return f"{100 * (value - before) / abs(before):+.3g} %" if before else f"{value:.4g} (was 0)"


def write_effects(path, study, names, outcomes):
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(["variant", "outcome", "cpu_seconds", "cpu_spread", "wall_seconds", "memory_mb", "unknowns",
                         *(quantity.name for quantity in study.quantities)])
        for name, outcome in zip(names, outcomes):
            writer.writerow([name, outcome.word, median(outcome.cpu), spread(outcome.cpu), median(outcome.wall),
                             median([byte / 1e6 for byte in outcome.memory]), outcome.unknowns,
                             *(outcome.values.get(quantity.name, "") for quantity in study.quantities)])


def effects_words(study, names, outcomes):
    """A table of what each effect costs and changes (Markdown)."""
    base = outcomes[0]
    if not base.solved:
        return f"The deck as it is ended {base.word} ({base.message}); there is nothing to compare with.\n"
    if len(outcomes) == 1:
        return "The deck has no effect that could be switched off.\n"
    # The value of a profile is an error, not something that an effect changes.
    quantities = [quantity for quantity in study.quantities if quantity.source[0] != "profile"]
    values = [f"{base.values[q.name]:.4g}" if q.name in base.values else "–" for q in quantities]
    lines = ["| switched off | CPU time | memory | unknowns | " + " | ".join(q.label for q in quantities) + " |",
             "|---" * (4 + len(quantities)) + "|",
             f"| nothing | {median(base.cpu):.3g} s ± {percent(0.5 * spread(base.cpu))} | "
             f"{median(base.memory) / 1e6:.0f} MB | {base.unknowns} | "
             + " | ".join(values) + " |"]
    for name, outcome in list(zip(names, outcomes))[1:]:
        if not outcome.solved:
            lines.append(f"| {name[8:]} | {outcome.word} |" + " |" * (2 + len(quantities)))
            continue
        doubt = "" if outcome.word == "certified" else f" ({outcome.word})"
        lines.append(
            f"| {name[8:]}{doubt} | {median(outcome.cpu):.3g} s ({change(median(outcome.cpu), median(base.cpu))}) | "
            f"{median(outcome.memory) / 1e6:.0f} MB ({change(median(outcome.memory), median(base.memory))}) | "
            f"{outcome.unknowns} | " + " | ".join(change(outcome.values.get(q.name), base.values.get(q.name))
                                                  for q in quantities) + " |")
    return (f"Effects of `{study.deck_path.name}` switched off one at a time; changes are relative to the deck as it "
            f"is, times are medians of {len(base.cpu)} runs.\n\n" + "\n".join(lines) + "\n")
