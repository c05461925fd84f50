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
    """A key's declaration, up to the next one."""
    return file, rf'\n *\.optional\(\s*"{name}",.*?(?=\n *\.(optional|required|check|then|not_yet)\()', ""


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


def no_alternative(file, name):
    """Questions whether a variant holds the alternative."""
    return file, rf"std::holds_alternative<{name}>\([\w.>\[\]-]*(\(\)[\w.>-]*)?\)", "false"


def nothing(file, holder, type_name):
    """An expression that says whether there is an object, and leads to it."""
    return file, rf"\b{holder}\b", f"Absent<{type_name}>{{}}"


def never(file, name):
    return file, rf"\bbool {name} = false;", f"Never {name};"


CUTS = {
    "other solutions": Cut(
        r"SolutionCensus|solve_from|go_to\(amontons::|other_starts",
        ("app/solution_census.cpp", "lib/solve/other_starts.cpp"),
        (key("look_for_other_solutions"),
         absent("app/run.cpp", "optional", "SolutionCensus", "census_"),
         ("app/run.cpp", r"\n[^\n]*census_\.emplace\(\);", ""),
         function("app/increment_solver.cpp", r"SolveOutcome IncrementSolver::solve_from"))),
}
