"""How each effect is taken out of the sources (without_effect.py): what is changed, and what may not be left.

Handles of the effect (pointers, optionals, flags) become types that are known to be empty when the program is compiled
(absent.hpp): the compiler then drops each branch that hangs on them. The effect's own sources are emptied, so that the
program links only if nothing else needs them; its keys are taken out of the deck.
"""
from typing import NamedTuple


class Cut(NamedTuple):
    functions: str  # regular expression: the effect's functions
    sources: tuple  # files that are emptied
    edits: tuple    # (file, regular expression, replacement), each of which must find something


def key(name, file="app/deck.cpp"):
    """A key's declaration, up to the next one or the end of the statement."""
    return file, rf'\n *\.optional\(\s*"{name}",.*?(?=\n *\.(optional|required|check|then|not_yet)\(|;\n)', ""


def function(file, begin):
    """A function by the beginning of its definition in column 1; of its helpers, too, whatever stands before them."""
    return file, rf"^{begin}.*?\n}}\n", ""


def absent(file, holder, type_name, name):
    """`holder` (optional, unique_ptr, or * behind the type) of an object, now never there."""
    old = rf"{type_name}\* {name}( = nullptr)?;" if holder == "*" else rf"{holder}<{type_name}> {name}( = [^;]*)?;"
    return file, rf"\b(std::)?{old}", f"Absent<{type_name}> {name};"


def tag(name, file="app/deck.cpp"):
    """An alternative of a key, up to the next one or the end of the statement."""
    return file, rf'\n *\.tag\(\s*"{name}",.*?(?=(\n *\.tag\(|;\n))', ""


def nothing(file, holder, type_name):
    """An expression that says whether there is an object, and leads to it."""
    return file, rf"\b{holder}\b", f"Absent<{type_name}>{{}}"


CUTS = {
    # Laws and history stay in the program, for the parts of finite kinematics call them; nothing of this run does.
    "friction": Cut(
        r"evaluate_friction\(|check_friction|friction_factors",
        ("lib/accuracy/friction_checks.cpp",),
        (key("friction"), key("friction_factor"),
         nothing("app/scene.cpp", r"declared\.friction", "FrictionLaw"),
         ("app/scene.cpp", r"\n *check_friction_factors\([^\n]*;", ""),
         function("app/scene.cpp", r"void check_friction_factors"),
         nothing("app/scene.cpp", r"contact->pair\(\)\.friction", "Friction"),
         nothing("app/ledger.cpp", r"contact\.pair\(\)\.friction", "Friction"),
         nothing("app/restart.cpp", r"contact\.pair\(\)\.friction", "Friction"),
         nothing("app/report.cpp", r"scene\.contacts\[i\]->pair\(\)\.friction", "Friction"),
         nothing("app/report.cpp", r"contact->pair\(\)\.friction", "Friction"),
         ("app/report.cpp", r"sample\.has_friction", "false"),
         nothing("lib/contact/contact_form.cpp", r"pair_\.friction", "Friction"),
         ("lib/contact/contact_form.cpp", r"\n *if \(tangential_\) evaluate_friction\(state\);", ""),
         function("lib/contact/contact_form.cpp", r"void ContactForm::evaluate_friction"),
         *(nothing(f"lib/contact/{file}.cpp", "tangential_", "TangentialPart")
           for file in ("contact_form", "contact_switching", "turning_master")),
         ("lib/accuracy/certificate.cpp", r"FrictionChecks friction = accuracy::check_friction\(input\)",
          "FrictionChecks friction = {}"))),
    # Of small strain: what it shares with that of finite strain (radial_return) stays.
    "plasticity": Cut(
        r"SmallPlastic::",
        ("lib/material/small_plastic.cpp",),
        (tag("elastic_plastic", "lib/material/bulk_material.cpp"),
         ("lib/material/bulk_material.cpp", r"std::visit\(SmallLawOf", "visit_first(SmallLawOf"),
         ("lib/material/small_law.cpp", r"std::visit\(", "visit_first("),
         ("lib/material/small_law.cpp", r"template <>\nconstexpr std::size_t num_state<SmallPlastic>[^\n]*\n", ""),
         ("lib/material/small_law.cpp", r"\n[^\n]*<SmallPlastic>\(law\)\) return[^\n]*", ""),
         ("lib/material/small_law.cpp", r"std::get_if<SmallPlastic>\(&law\)", "static_cast<const SmallPlastic*>(nullptr)"))),
    "finite kinematics": Cut(
        r"FiniteBulkForm::|ContactPoints::follow\(|add_tangent_now|couple_now|turning_forces",
        ("lib/form/finite_bulk.cpp", "lib/contact/finite_contact.cpp"),
        (("app/deck.cpp", r'\n *\.word\("finite", Kinematics::Finite,.*?(?=;\n)', ""),
         ("app/scene.cpp", r"if \(deck\.kinematics == Kinematics::Finite\)", "if constexpr (false)"),
         *((f"lib/contact/{file}.cpp", r"(points_\.)?\bis_following\(\)", "false")
           for file in ("contact_form", "contact_points", "turning_master")),
         function("lib/contact/followed_points.cpp", r"void ContactPoints::follow\(const State& state\)"))),
    "pressure that follows": Cut(
        r"FollowerPressureForm::",
        ("lib/form/follower_pressure.cpp",),
        (*(nothing(f"app/{file}.cpp", r"scene_?\.follower", "FollowerPressureForm") for file in ("ledger", "report")),
         ("app/scene.cpp", r"if \(!conditions\.follower\.empty\(\)\)", "if constexpr (false)"))),
    "segments": Cut(
        r"place_by_segments|segment_quadrature",
        ("lib/geometry/segment_quadrature.cpp",),
        (tag("segment"),
         ("lib/contact/contact_points.cpp", r"\n *if \(const auto\* segment = [^\n]*\n *place_by_segments[^\n]*\n *else", ""),
         function("lib/contact/contact_points.cpp", r"void ContactPoints::place_by_segments"))),
    "smoothing": Cut(
        r"SmoothMaster::|BezierFacet",
        ("lib/contact/smooth_master.cpp", "lib/geometry/bezier_facet.cpp"),
        (key("smoothing"), absent("lib/contact/master_surface.hpp", "optional", "SmoothMaster", "smooth_"))),
    "path error and path control": Cut(
        r"PathRecord::|PathControl::|solve_halves",
        ("app/path_record.cpp", "lib/solve/path_control.cpp"),
        (key("estimate_path_error"), key("path_tolerance"),
         absent("app/run.cpp", "optional", "PathRecord", "path_"),
         absent("app/run.cpp", "optional", "PathControl", "path"),
         ("app/run.cpp", r"\n[^\n]*path_\.emplace\(\);", ""),
         nothing("app/error_budget.cpp", r"input\.path", "PathRecord"),
         ("app/run.cpp", r"automatic && automatic->path_tolerance", "false"),
         ("app/run.cpp", r"stretch\.path \|\| scene_->deck\.estimate_path_error", "false"),
         function("app/increment_solver.cpp", r"std::vector<SolvedState> IncrementSolver::solve_halves"))),
    "refinement": Cut(
        r"refined\(amontons::PlexMesh",
        ("lib/mesh/plex_refine.cpp",),
        (key("refine"),
         ("lib/mesh/distribute.cpp", r"\n *for \(int level = 0; level < refine; \+\+level\)\n[^\n]*", ""))),
    "audit of inertia": Cut(
        r"MotionRecord::add|audit_motion",
        (),
        (absent("app/run.cpp", "optional", "MotionRecord", "motion_"),
         ("app/run.cpp", r"\n[^\n]*motion_\.emplace\(\);", ""),
         function("app/effects_audit.cpp", r"void MotionRecord::add"),
         function("lib/accuracy/absent_effects.cpp", r"MotionAudit audit_motion"))),
    "stabilization": Cut(
        r"ViscousForm::|stabilization_rule",
        ("lib/form/viscous.cpp",),
        (key("stabilization"),
         function("app/deck.cpp", r"TaggedRule<StabilizationDeck> stabilization_rule"),
         *(nothing(f"app/{file}.cpp", r"scene_?\.stabilization", "ViscousForm") for file in ("ledger", "report", "restart")),
         ("app/scene.cpp", r"if \(deck\.stabilization\)", "if constexpr (false)"),
         # A remedy uses the same form: gone with it.
         ("app/increment_solver.cpp", r"(make_support = \[this\]\(double ratio\) -> std::unique_ptr<Form> \{).*?\n  \};",
          r"\1 return nullptr; };"))),
    "other solutions": Cut(
        r"SolutionCensus|solve_from|go_to\(amontons::|other_starts",
        ("app/solution_census.cpp", "lib/solve/other_starts.cpp"),
        (key("look_for_other_solutions"),
         absent("app/run.cpp", "optional", "SolutionCensus", "census_"),
         ("app/run.cpp", r"\n[^\n]*census_\.emplace\(\);", ""),
         function("app/increment_solver.cpp", r"SolveOutcome IncrementSolver::solve_from"))),
    "adaptive meshing": Cut(
        r"Adaptation::|SizeField|wanted_sizes|simplex_errors|free_from_script|adapt_rule",
        ("app/adaptation.cpp", "lib/accuracy/mesh_sizes.cpp", "lib/mesh/size_field.cpp"),
        (key("adapt"),
         function("app/deck.cpp", r"ObjectRule<AdaptDeck> adapt_rule"),
         ("app/run.cpp", r"Adaptation\* adaptation", "Absent<Adaptation> adaptation"),
         function("app/run.cpp", r"int run_passes"),
         ("app/run.cpp", r"\n *if \(deck\.adapt\) return run_passes[^\n]*", ""),
         function("lib/mesh/gmsh_session.cpp", r"std::vector<SizeSample> sizes_of_cells"),
         function("lib/mesh/gmsh_session.cpp", r"void impose_sizes"),
         function("lib/mesh/gmsh_session.cpp", r"void free_from_script"),
         ("lib/mesh/gmsh_session.cpp", r"\n  if \(source\.free\) \{.*?\n  \}", ""))),
}
