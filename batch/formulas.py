"""Arithmetic of sweep files: numbers, parameters and keys of the case, + - * / // % **, and a few functions."""

from __future__ import annotations

import ast
import math
import operator
from collections.abc import Callable

OPERATORS: dict[type, Callable] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.FloorDiv: operator.floordiv,
    ast.Mod: operator.mod,
    ast.Pow: operator.pow,
    ast.USub: operator.neg,
    ast.UAdd: operator.pos,
}
FUNCTIONS: dict[str, Callable] = {
    name: getattr(math, name) for name in ("sqrt", "exp", "log", "log10", "sin", "cos", "tan", "floor", "ceil")
}
FUNCTIONS |= {"abs": abs, "min": min, "max": max, "round": round}
CONSTANTS = {"pi": math.pi}
# Beyond these 9**9**9 and ((9**999)**999)**999 would keep the computer busy.
LARGEST_EXPONENT, LARGEST_INTEGER = 1000, 2**63


class FormulaError(Exception):
    """A formula without a value; the message is one line."""


def is_free(name: str) -> bool:
    """Whether formulas read `name` (or `group.key`) as just that: no constant or function, no word of Python, no sign changed."""
    try:
        return name.lower() not in CONSTANTS | FUNCTIONS and _name(ast.parse(name, mode="eval").body) == name
    except SyntaxError:
        return False


def evaluate(formula: str, look_up: Callable[[str], object]) -> object:
    """The value of a formula; `look_up(name)` gives that of a name, None if it is unknown."""
    try:
        tree = ast.parse(formula, mode="eval")
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        raise FormulaError(f"found '{formula}', which is no formula") from error
    try:
        value = _value(tree.body, look_up)
    except (ArithmeticError, ValueError, TypeError, RecursionError) as error:
        raise FormulaError(f"'{formula}' has no value: {error}") from error
    if isinstance(value, complex) or (isinstance(value, float) and not math.isfinite(value)):
        raise FormulaError(f"'{formula}' has no value: it would be {value}")
    return value


def _value(node: ast.AST, look_up: Callable[[str], object]) -> object:
    """The value of one part of a formula."""
    if isinstance(node, ast.Constant) and isinstance(node.value, int | float):
        return node.value
    if isinstance(node, ast.UnaryOp) and type(node.op) in OPERATORS:
        return OPERATORS[type(node.op)](_number(node.operand, look_up))
    if isinstance(node, ast.BinOp) and type(node.op) in OPERATORS:
        left, right = _number(node.left, look_up), _number(node.right, look_up)
        if isinstance(node.op, ast.Pow) and abs(right) > LARGEST_EXPONENT:
            raise ValueError(f"the exponent {right} is too large")
        value = OPERATORS[type(node.op)](left, right)
        if isinstance(value, int) and abs(value) > LARGEST_INTEGER:
            raise ValueError("an integer in it is too large")
        return value
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in FUNCTIONS and not node.keywords:
        return FUNCTIONS[node.func.id](*(_number(part, look_up) for part in node.args))
    name = _name(node)
    if name is None:
        raise FormulaError(f"found '{ast.unparse(node)}', expected numbers, names, + - * / // % ** and {', '.join(FUNCTIONS)}")
    value = CONSTANTS.get(name, look_up(name))
    if value is None:
        raise FormulaError(f"found {name}, expected a parameter, an earlier formula, or group.key with a value in the case")
    return value


def _number(node: ast.AST, look_up: Callable[[str], object]) -> float:
    """The value of a part with which is computed."""
    value = _value(node, look_up)
    if not isinstance(value, int | float):
        raise TypeError(f"{ast.unparse(node)} is {value!r}, expected a number")
    return value


def _name(node: ast.AST) -> str | None:
    """`name` or `group.key`."""
    if isinstance(node, ast.Name):
        return node.id
    if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
        return f"{node.value.id}.{node.attr}"
    return None
