"""Closed forms in study files: arithmetic on numbers, names and some functions, written as in a deck (`^` is power)."""

import ast
import operator

import numpy as np

from deck_edit import StudyError, nearest

FUNCTIONS = {
    "sqrt": np.sqrt, "abs": np.abs, "exp": np.exp, "log": np.log, "log10": np.log10, "sin": np.sin, "cos": np.cos,
    "tan": np.tan, "asin": np.arcsin, "acos": np.arccos, "atan": np.arctan, "atan2": np.arctan2, "cbrt": np.cbrt,
    "acosh": np.arccosh,
    "min": lambda *values: np.minimum.reduce(np.broadcast_arrays(*values)),
    "max": lambda *values: np.maximum.reduce(np.broadcast_arrays(*values)),
}
OPERATORS = {
    ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv,
    ast.Pow: operator.pow, ast.USub: operator.neg, ast.UAdd: operator.pos,
}


def is_integral(node):
    return isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "integral" and \
        len(node.args) == 4 and isinstance(node.args[1], ast.Name)


def names_in(text):
    """Names that an expression needs from outside. Errors: StudyError for what is not an expression."""
    def names(node):
        if is_integral(node):
            function, variable, *limits = node.args
            return (names(function) - {variable.id}).union(*map(names, limits))
        if isinstance(node, ast.Name):
            return {node.id}
        inside = node.args if isinstance(node, ast.Call) else ast.iter_child_nodes(node)
        return set().union(*map(names, inside))

    return names(parse(text)) - {"pi"}


def parse(text):
    try:
        return ast.parse(str(text).replace("^", "**").strip(), mode="eval")
    except SyntaxError as error:
        raise StudyError(f"'{text}' is not an expression: {error.msg}.") from error


def evaluate(text, names):
    """Value of an expression of `names` (numbers or arrays) and pi. integral(f, u, a, b) is the integral of f over u
    from the number a to the number b. Errors: StudyError for unknown names and functions and for what is not
    arithmetic."""
    names = {"pi": np.pi, **names}

    def integral(function, variable, *limits):
        """200 Gauss points in angle: u = a + (b - a) sin^2 lets square roots at the ends do no harm."""
        low, high = map(value, limits)
        place, weight = np.polynomial.legendre.leggauss(200)
        angle = 0.25 * np.pi * (place + 1.0)
        slope = 0.25 * np.pi * (high - low) * np.sin(2.0 * angle)
        hidden = names.get(variable.id)
        names[variable.id] = low + (high - low) * np.sin(angle)**2
        found = np.sum(weight * slope * value(function))
        names.pop(variable.id) if hidden is None else names.update({variable.id: hidden})
        return found

    def value(node):
        if isinstance(node, ast.Expression):
            return value(node.body)
        if isinstance(node, ast.Constant) and isinstance(node.value, (int, float)):
            return float(node.value)
        if isinstance(node, ast.Name):
            if node.id not in names:
                raise StudyError(f"'{text}' uses the unknown name '{node.id}'.{nearest(node.id, names)}")
            return names[node.id]
        if isinstance(node, ast.BinOp) and type(node.op) in OPERATORS:
            return OPERATORS[type(node.op)](value(node.left), value(node.right))
        if isinstance(node, ast.UnaryOp) and type(node.op) in OPERATORS:
            return OPERATORS[type(node.op)](value(node.operand))
        if is_integral(node):
            return integral(*node.args)
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and not node.keywords:
            if node.func.id not in FUNCTIONS:
                raise StudyError(f"'{text}' uses the unknown function '{node.func.id}'."
                                 f"{nearest(node.func.id, FUNCTIONS)}")
            return FUNCTIONS[node.func.id](*map(value, node.args))
        raise StudyError(f"'{text}' holds something else than numbers, names, + - * / ^ and functions.")

    try:
        with np.errstate(all="ignore"):
            return value(parse(text))
    except (ZeroDivisionError, OverflowError, TypeError, ValueError) as error:
        raise StudyError(f"'{text}' has no value: {error}.") from error
