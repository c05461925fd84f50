"""Closed forms in study files: arithmetic on numbers, names and some functions, written as in a deck (`^` is power)."""

import ast
import operator

import numpy as np

from deck_edit import StudyError, nearest

FUNCTIONS = {
    "sqrt": np.sqrt, "abs": np.abs, "exp": np.exp, "log": np.log, "log10": np.log10, "sin": np.sin, "cos": np.cos,
    "tan": np.tan, "asin": np.arcsin, "acos": np.arccos, "atan": np.arctan, "atan2": np.arctan2, "cbrt": np.cbrt,
    "min": lambda *values: np.minimum.reduce(np.broadcast_arrays(*values)),
    "max": lambda *values: np.maximum.reduce(np.broadcast_arrays(*values)),
}
OPERATORS = {
    ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv,
    ast.Pow: operator.pow, ast.USub: operator.neg, ast.UAdd: operator.pos,
}


def names_in(text):
    """Names that an expression uses, functions left out. Errors: StudyError for what is not an expression."""
    tree = parse(text)
    called = {id(node.func) for node in ast.walk(tree) if isinstance(node, ast.Call)}
    return {node.id for node in ast.walk(tree) if isinstance(node, ast.Name) and id(node) not in called} - {"pi"}


def parse(text):
    try:
        return ast.parse(str(text).replace("^", "**").strip(), mode="eval")
    except SyntaxError as error:
        raise StudyError(f"'{text}' is not an expression: {error.msg}.") from error


def evaluate(text, names):
    """Value of an expression of `names` (numbers or arrays) and pi. Errors: StudyError for unknown names and functions
    and for anything that is not arithmetic."""
    names = {"pi": np.pi, **names}

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
