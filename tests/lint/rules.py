"""Rules of the checker of words, and the findings of a source text."""

import ast
import re
import tomllib
from collections import deque
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

WORDS: dict[str, list[str]] = tomllib.loads((Path(__file__).parent / "words.toml").read_text(encoding="utf-8"))
_QUESTION, _PREPOSITION = frozenset(WORDS["question"]), frozenset(WORDS["preposition"])
_BANNED = re.compile(rf"\b({'|'.join(WORDS['banned'])})\b", re.IGNORECASE)
_UNIT_NAME = re.compile(rf"(?:^|_)(?:{'|'.join(WORDS['unit_suffix'])})$")
_UNIT = re.compile(rf"(?<![\w'])(?:{'|'.join(map(re.escape, WORDS['unit']))})(?!\w)|\b[01](?:\.0)? (?:to|and|or) 1\b")
_SHAPE = re.compile(r"\bshapes?\b|\([\w*+ ]+,(?: *[\w*+ ]+,?)* *\)")  # "shape", or a tuple such as (n, 36)
_ARRAY = re.compile(r"\b(?:NDArray|ndarray|Floats|Flags|Vector|Shades|Ring|Points)\b")
_QUESTION_TEST = re.compile(r"test_(?:what|who|whose|where|how|when)_")
LONGEST_TEST_NAME = 60
LONGEST_SENTENCE = 22
_BLOCKS = ("body", "handlers", "orelse", "finalbody", "cases")
"""Fields of a syntax node that hold statements, in the order of the text."""
RUFF_RULES = ("D102", "D205", "D209", "D400", "D401", "D403")

Function = ast.FunctionDef | ast.AsyncFunctionDef


class Finding(NamedTuple):
    """Place of one broken rule."""

    path: str
    line: int
    rule: str
    name: str

    def __str__(self) -> str:
        return f"{self.path}:{self.line}: {self.rule}: {self.name}"


def text_findings(path: str, text: str) -> Iterator[Finding]:
    """Yield each banned word of a text of any kind."""
    if _BANNED.search(text) is None:
        return
    for number, line in enumerate(text.splitlines(), 1):
        for word in _BANNED.findall(line):
            yield Finding(path, number, "banned-word", word.lower())


def python_findings(path: str, text: str) -> Iterator[Finding]:
    """Yield the findings of a Python module except banned words. Raises SyntaxError."""
    module = ast.parse(text, path)
    for name, docstring in _docstrings(module):
        if rule := first_word_rule(docstring.value):
            yield Finding(path, docstring.lineno, rule, name)
    if path.startswith("tests/"):
        functions = (node for node in _blocks(module) if isinstance(node, Function))
        tests = (node for node in functions if node.name.startswith("test_"))
        yield from (
            Finding(path, test.lineno, rule, test.name) for test in tests for rule in _test_name_rules(test.name)
        )
    else:
        for prefix, function, context in _public_functions(module):
            for rule in _contract_rules(function, context):
                if rule == "raises" and path.startswith(
                    "kurt2rt/cli/"
                ):  # there a docstring is the help that a user reads
                    continue
                yield Finding(path, function.lineno, rule, prefix + function.name)


def first_word_rule(docstring: str) -> str | None:
    """Return the rule that the first word of a docstring breaks."""
    words = re.findall(r"[A-Za-z]+", docstring.lstrip()[:40])
    if not words or not docstring.lstrip()[:1].isalpha():
        return None
    first = words[0].lower()
    return "first-word" if first in _QUESTION else "preposition-first" if first in _PREPOSITION else None


def _docstrings(module: ast.Module) -> Iterator[tuple[str, "_Text"]]:
    """Yield the name and docstring of the module, its classes, functions and attributes."""
    for node in _blocks(module):
        if not isinstance(node, ast.Module | ast.ClassDef | Function):
            continue
        before: ast.AST = node
        for statement in node.body:
            if (text := _text(statement)) is not None and not isinstance(before, ast.Expr):
                yield _name(before), text
            before = statement
            if isinstance(node, Function):
                break


def _blocks(module: ast.Module) -> Iterator[ast.AST]:
    """Yield the module and all statements in it; ast.walk visits expressions too, and doubles the time of the check."""
    nodes: deque[ast.AST] = deque([module])
    while nodes:
        node = nodes.popleft()
        yield node
        nodes += _statements_in(node)


def _statements_in(node: ast.AST) -> Iterator[ast.AST]:
    """Yield the statements, exception handlers and cases directly in a statement, which no expression can hold."""
    for block in _BLOCKS:
        yield from getattr(node, block, ())


class _Text(NamedTuple):
    value: str
    lineno: int


def _text(statement: ast.stmt) -> _Text | None:
    if isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Constant):
        value = statement.value.value
        return _Text(value, statement.lineno) if isinstance(value, str) else None
    return None


def _name(node: ast.AST) -> str:
    if isinstance(node, Function | ast.ClassDef):
        return node.name
    if isinstance(node, ast.Assign):
        return ast.unparse(node.targets[0])
    return ast.unparse(node.target) if isinstance(node, ast.AnnAssign) else "module"


def _public_functions(module: ast.Module) -> Iterator[tuple[str, Function, str]]:
    """Yield the class prefix, the node and the class docstring of each public function and of constructors."""
    for node in module.body:
        if isinstance(node, Function) and not node.name.startswith("_"):
            yield "", node, ""
        elif isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
            for method in node.body:
                if isinstance(method, Function) and (method.name == "__init__" or not method.name.startswith("_")):
                    yield f"{node.name}.", method, (ast.get_docstring(node) or "") if method.name == "__init__" else ""


def _contract_rules(function: Function, context: str) -> Iterator[str]:
    """Yield shape, unit and raises where the docstring of a function lacks them."""
    docstring = f"{context}\n{ast.get_docstring(function) or ''}"
    arguments = [*function.args.posonlyargs, *function.args.args, *function.args.kwonlyargs]
    typed = [(each.arg, ast.unparse(each.annotation)) for each in arguments if each.annotation is not None]
    typed += [(function.name, ast.unparse(function.returns))] if function.returns is not None else []
    if any(_ARRAY.search(kind) for _, kind in typed) and not _SHAPE.search(docstring):
        yield "shape"
    numbers = (name for name, kind in typed if kind in ("float", "float | None"))
    if not all(_UNIT_NAME.search(name) for name in numbers) and not _UNIT.search(docstring):
        yield "unit"
    if any(not re.search(rf"\b{name}\b", docstring) for name in _raised(function)):
        yield "raises"


def _raised(function: Function) -> set[str]:
    """Return the classes that the body raises itself, except those of typer, which print and exit."""
    names = set()
    nodes: list[ast.AST] = list(function.body)
    while nodes:
        node = nodes.pop()
        if isinstance(node, Function | ast.ClassDef):
            continue
        nodes += _statements_in(node)
        raised = node.exc if isinstance(node, ast.Raise) else None
        name = ast.unparse(raised.func if isinstance(raised, ast.Call) else raised) if raised is not None else ""
        if name.rpartition(".")[2][:1].isupper() and not name.startswith("typer."):
            names.add(name.rpartition(".")[2])
    return names


def _test_name_rules(name: str) -> Iterator[str]:
    if _QUESTION_TEST.match(name):
        yield "test-first-word"
    if len(name) > LONGEST_TEST_NAME:
        yield "test-length"
