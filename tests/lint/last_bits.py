"""Findings of floats whose last bit is not ours: sums and functions that differ between processors and Pythons.

Builtin `sum` of floats adds otherwise since Python 3.12. The C library has several sines, exponentials and powers, with
and without fused multiply-add. BLAS adds in another order on each kind of processor, and so does einsum.
"""

import ast
import tomllib
from collections.abc import Iterator
from pathlib import Path

from tests.lint.rules import Finding

ROOMS = ("hal/", "behaviors/", "simbridge/", "kurt2rt/core/", "kurt2rt/robots/", "kurt2rt/ros/")
"""Rooms in which a float may decide how a robot drives or a simulation goes on."""
_TABLE = tomllib.loads((Path(__file__).parent / "last_bits.toml").read_text(encoding="utf-8"))
ALLOWED: dict[str, dict[str, str]] = _TABLE["allowed"]
"""Why an operation is right in a file, by path and name."""
_FUNCTIONS = {module: frozenset(names) for module, names in _TABLE["functions"].items()}


def last_bits_findings(path: str, text: str) -> Iterator[Finding]:
    """Yield each float in a module of ROOMS whose last bit differs between computers, except in places of ALLOWED.

    Raises SyntaxError.
    """
    if path.startswith(ROOMS):
        for name, line in _found(ast.parse(text, path)):
            if name not in ALLOWED.get(path, {}):
                yield Finding(path, line, "last-bits", name)


def _found(node: ast.AST) -> Iterator[tuple[str, int]]:
    if _rounds(node):
        return
    name = _name(node)
    if name:
        assert isinstance(node, ast.expr | ast.AugAssign)
        yield name, node.lineno
    for child in ast.iter_child_nodes(node):
        yield from _found(child)


def _rounds(node: ast.AST) -> bool:
    """Return whether a call takes the last bits off its argument: of `round_portable`, or of `round` to some digits."""
    match node:
        case ast.Call(func=ast.Name(id="round_portable")) | ast.Call(func=ast.Name(id="round"), args=[_, _]):
            return True
    return False


def _name(node: ast.AST) -> str:
    """Return the name of an operation that is not portable; empty for any other node."""
    match node:
        case ast.Call(func=ast.Name(id="sum"), args=[values, *_]) if not _counts(values):
            return "sum"
        case ast.Attribute(value=ast.Name(id=module), attr=name) if name in _FUNCTIONS.get(module, ()):
            return f"{module}.{name}"
        case ast.Call(func=ast.Attribute(attr="dot")):
            return "dot"
        case ast.BinOp(op=ast.MatMult()) | ast.AugAssign(op=ast.MatMult()):
            return "@"
        case ast.BinOp(op=ast.Pow(), left=base) if not isinstance(base, ast.Constant):
            return "**"
    return ""


def _counts(values: ast.expr) -> bool:
    """Return whether the values of a sum are seen to be whole numbers."""
    if not isinstance(values, ast.GeneratorExp | ast.ListComp):
        return False
    match values.elt:
        case ast.Compare() | ast.BoolOp() | ast.UnaryOp(op=ast.Not()) | ast.BinOp(op=ast.LShift()):
            return True
        case ast.Constant(value=int()) | ast.Call(func=ast.Name(id="len")):
            return True
    return False
