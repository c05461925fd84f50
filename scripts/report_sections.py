"""The sections of a report, each from what the run left behind: a function of it that returns HTML, '' where there is
nothing to say."""

import platform

import matplotlib

import run_pictures
from report_page import bar, markdown, note, picture, picture_of, table, text
from study_file import short_value

CAPTIONS = {
    "deformed.png": "Deformed mesh with von Mises stress at the last step.",
    "contact.png": "The same close to the contact, at true scale.",
    "pressure.png": "Contact pressure on the slave surfaces.",
    "friction.png": "Tangential traction and its bound (Coulomb: mu times the pressure).",
    "hysteresis.png": "Tangential force against tangential displacement.",
    "history.png": "Histories over the increments of the run.",
}
SPACES = {"plane_strain": "plane strain", "plane_stress": "plane stress", "axisymmetric": "axisymmetric", "solid": "3D"}


def outcome(run):
    """How the run ended, and what is wrong with its folder."""
    summary, parts = run.summary, []
    if summary:
        good = summary.get("status") == 0
        resources = summary.get("resources", {})
        known = {key: text(summary.get(key, "?")) for key in ("outcome", "status", "increments", "time", "ranks",
                                                              "newton_iterations")}
        parts.append(f"<p><span class='outcome {'good' if good else 'bad'}'>{known['outcome']}</span> <span class=soft>"
                     f"(exit status {known['status']}), {known['increments']} increments to t = {known['time']}, "
                     f"{known['newton_iterations']} Newton iterations, {known['ranks']} ranks, "
                     f"{text(round(resources.get('wall_seconds', 0.0), 2))} s</span></p>")
    return "".join(parts + [note(fault) for fault in run.faults])


def condition_words(item):
    """A boundary condition of the deck in words."""
    where = item.get("on", "?")
    for kind, value in item.items():
        if kind == "on":
            continue
        if isinstance(value, dict):
            value = ", ".join(f"{axis} = {component}" for axis, component in value.items())
        return f"{where}: {kind} {value}"
    return where


def pair_words(pair):
    enforce = pair.get("enforce", "semismooth")
    master = pair.get("master")
    master = master if isinstance(master, str) else f"a rigid {short_value(master).split('(')[0]}"
    friction = f"friction {short_value(pair['friction'])}" if "friction" in pair else "no friction"
    integration = f", integration {short_value(pair['integration'])}" if "integration" in pair else ""
    return (f"{pair.get('name')}: {pair.get('slave')} (slave) on {master}, {short_value(enforce)}{integration}, "
            f"{friction}")


def scene_sentence(deck, found):
    """What kind of scene this is, in one sentence."""
    def counted(number, what):
        return f"{number} {what}{'s' * (number != 1)}"

    pairs, unknowns = found.get("contact", deck.get("contact") or []), sum(found.get("unknowns", {}).values())
    parts = [SPACES.get(deck.get("space"), f"{found['dim']}D" if "dim" in found else "")]
    parts += [counted(len(deck["bodies"]), "body").replace("bodys", "bodies")] if deck.get("bodies") else []
    parts += [counted(len(pairs), "contact pair") + (" with friction" if found.get("effects", {}).get("friction") else
                                                     " without friction")] if pairs else ["no contact"]
    parts += [counted(unknowns, "unknown")] if unknowns else []
    parts += [counted(len(deck["steps"]), "step")] if deck.get("steps") else []
    words = ", ".join(part for part in parts if part)
    return f"<p>{text(words[:1].upper() + words[1:])}.</p>"


def scene(run):
    """The scene in words, from the deck and from the summary."""
    rows, found = [], run.summary.get("scene", {}) if run.summary else {}
    deck = run.deck or {}
    if deck:
        kinematics = "large" if deck.get("kinematics") == "finite" else "small"
        rows.append(("kind", f"{SPACES.get(deck.get('space'), deck.get('space'))}, {kinematics} strains"))
        for body, material in (deck.get("bodies") or {}).items():
            law = (deck.get("materials") or {}).get(material, {})
            rows.append((f"body {body}", f"{material}: {short_value(law)}"))
    if found:
        unknowns = found.get("unknowns", {})
        rows.append(("mesh", f"{found.get('cells')} cells of order {found.get('order')}, {found.get('nodes')} nodes"))
        rows.append(("unknowns", ", ".join(f"{count} {what}" for what, count in unknowns.items())))
        floating = found.get("bodies_held_by_contact_alone")
        if floating:
            rows.append(("held by contact alone", ", ".join(floating)))
    rows += [("boundary", condition_words(item)) for item in deck.get("boundary") or []]
    rows += [("contact", pair_words(pair)) for pair in deck.get("contact") or []]
    for step in deck.get("steps") or []:
        increments = step.get("increments", 1)
        rows.append((f"step {step.get('name')}", f"to t = {step.get('to')}, increments: {short_value(increments)}"))
    on = [effect.replace("_", " ") for effect, used in found.get("effects", {}).items() if used]
    off = [effect.replace("_", " ") for effect, used in found.get("effects", {}).items() if not used]
    if on or off:
        rows += [("effects on", ", ".join(on) or "none"), ("effects off", ", ".join(off) or "none")]
    return scene_sentence(deck, found) + table((), rows) if rows else ""


def pictures(run):
    """All pictures that scripts/plot would draw; what is missing is said below them."""
    parts, said = [], []
    title = run_pictures.read_title(run.folder, lambda _: None)
    for name, make in run_pictures.pictures(run.folder, title, said.append):
        try:
            parts.append(picture(make(), CAPTIONS[name]))
        except (ValueError, KeyError) as error:
            said.append(f"{name} cannot be drawn: {error}")
    return "".join(parts) + "".join(f"<p class=soft>{text(words)}</p>" for words in said)


def certificate(run):
    found = (run.summary or {}).get("certificate")
    if not found:
        return ""
    rows = []
    for name, item in found.get("items", {}).items():
        good = item.get("passed")
        verdict = f"<span class={'good' if good else 'bad'}>{'holds' if good else 'FAILS'}</span>"
        rows.append((name.replace("_", " "), item.get("worst"), item.get("tolerance"), (verdict,), item.get("time"),
                     item.get("where")))
    words = "holds in every accepted increment" if found.get("passed") else \
        f"fails in {found.get('failed_increments', '?')} increments"
    return (f"<p>Checked after every accepted increment by a search that shares no code with the solver but the "
            f"geometry. The certificate {text(words)}. Worst values over the run:</p>"
            + table(("check", "worst", "tolerance", "", "at t", "where"), rows))


def nested_rows(content, prefix=""):
    """Numbers and words of nested maps as rows."""
    for key, value in content.items():
        name = f"{prefix}{str(key).replace('_', ' ')}"
        if isinstance(value, dict):
            yield from nested_rows(value, name + ": ")
        else:
            yield name, short_value(value) if isinstance(value, (list, float)) else value


def error_budget(run):
    """What the summary knows of errors: estimates when it has some, and otherwise what bounds them."""
    summary = run.summary or {}
    estimates = summary.get("errors") or summary.get("error_estimates")
    parts = [table(("estimate", ""), nested_rows(estimates))] if isinstance(estimates, dict) else []
    items = summary.get("certificate", {}).get("items", {})
    rows = [(kind, name.replace("_", " "), items[name].get("worst"), of)
            for kind, name, of in (("constraint", "penetration", "facet size"),
                                   ("constraint", "complementarity", "contact force x facet size"),
                                   ("constraint", "friction_cone", "bound"),
                                   ("algebra", "force_balance", "force scale"),
                                   ("algebra", "virtual_work", "work")) if name in items]
    energy = summary.get("energy", {})
    if energy.get("external_work"):
        rows.append(("path", "uncertainty of the external work (trapezoidal rule, an upper bound)",
                     abs(energy.get("external_work_uncertainty", 0.0) / energy["external_work"]), "external work"))
    if rows:
        parts.append(table(("kind", "what", "size", "relative to"), rows))
    if parts and not estimates:
        parts.append("<p class=soft>This run holds no estimate of the discretization error; a study of the mesh size "
                     "(scripts/study) tells it.</p>")
    return "".join(parts)


def time_budget(run):
    resources = (run.summary or {}).get("resources")
    if not resources:
        return ""
    wall = resources.get("wall_seconds", 0.0) or 1.0
    phases = sorted(resources.get("phase_seconds", {}).items(), key=lambda item: -item[1])
    growth = resources.get("memory_growth_bytes", {})
    rows = [(name, seconds, f"{100 * seconds / wall:.1f} %", bar(seconds / wall), round(growth.get(name, 0.0) / 1e6))
            for name, seconds in phases]
    return (f"<p>{text(wall)} s wall time, {text(resources.get('cpu_seconds', 0.0))} s CPU time over all ranks, "
            f"{text(round(resources.get('peak_memory_bytes', 0.0) / 1e6))} MB peak memory (sum over ranks). "
            "Phases, seconds as mean over ranks, MB by which the peak rose meanwhile:</p>"
            + table(("phase", "seconds", "share", "", "MB"), rows))


def audit(run):
    found = (run.summary or {}).get("effects")
    return table((), nested_rows(found)) if isinstance(found, dict) else ""


def options(run):
    summary = run.summary or {}
    rows = [("linear solver", summary.get("linear_solver", "?"))] if summary else []
    rows += [(f"-{name}", value) for name, value in ((run.deck or {}).get("petsc") or {}).items()]
    for key in ("newton_iterations", "linear_iterations", "outer_iterations", "factorizations", "cutbacks"):
        if key in summary:
            rows.append((key.replace("_", " "), summary[key]))
    if summary.get("version"):
        rows.append(("Amontons", summary["version"]))
    rows.append(("report drawn with", f"Python {platform.python_version()}, matplotlib {matplotlib.__version__}"))
    return table((), rows)


def study(folder):
    """Words and pictures of a study or of a comparison of effects in a folder."""
    parts = []
    for name in ("words.md", "effects.md"):
        if (folder / name).is_file():
            parts.append(markdown((folder / name).read_text(encoding="utf-8")))
    for name, caption in (("error_time.png", "Error against CPU time; the line joins settings that no other beats."),
                          ("knobs.png", "Errors, CPU time and iterations over the knob of each sweep.")):
        if (folder / name).is_file():
            parts.append(picture_of((folder / name).read_bytes(), caption))
    return "".join(parts)


def deck_text(run):
    return f"<pre>{text(run.deck_text)}</pre>" if run.deck_text else ""
