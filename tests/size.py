"""A price for each line: token lines by room, held to a budget (`make size`).

A token line holds at least one token that is neither comment nor docstring. So dropping docstrings saves nothing.
"""

import ast
import subprocess
import sys
import tomllib
from collections import Counter
from collections.abc import Iterator, Mapping
from pathlib import Path

ROOT = Path(__file__).parents[1]
DOCUMENTED = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)


def docstring_lines(node: ast.AST) -> Iterator[int]:
    """Yield the numbers of all lines of docstrings of a module, class or function and of those in it."""
    if not isinstance(node, DOCUMENTED):
        return
    if ast.get_docstring(node, clean=False) is not None:
        text = node.body[0]
        yield from range(text.lineno, (text.end_lineno or text.lineno) + 1)
    for child in node.body:
        yield from docstring_lines(child)


def token_lines(source: str) -> int:
    """Return the number of lines that hold a token of the program."""
    documents = set(docstring_lines(ast.parse(source)))
    lines = enumerate((line.strip() for line in source.split("\n")), start=1)
    return sum(bool(line) and not line.startswith("#") and number not in documents for number, line in lines)


def room(path: str) -> str:
    """Return the room that a file belongs to: the top folder, within kurt2rt the folder below it.

    Loose modules of kurt2rt are the room `kurt2rt`.
    """
    parts = path.split("/")
    return f"kurt2rt/{parts[1]}" if parts[0] == "kurt2rt" and len(parts) > 2 else parts[0]


def git(*words: str) -> str:
    """Return the output of a git command in the project's folder.

    Raises:
        subprocess.CalledProcessError: the folder is no checkout.

    """
    return subprocess.run(["git", *words], cwd=ROOT, capture_output=True, text=True, check=True).stdout


def python_files() -> Iterator[str]:
    """Yield each Python file that git tracks or would track, by its path from the root."""
    listed = git("ls-files", "--cached", "--others", "--exclude-standard", "*.py")
    return (path for path in listed.splitlines() if (ROOT / path).is_file())


def sizes() -> Counter[str]:
    """Return the token lines of each room in the working tree."""
    counted: Counter[str] = Counter()
    for path in python_files():
        counted[room(path)] += token_lines((ROOT / path).read_text("utf-8"))
    return counted


def growth() -> Counter[str]:
    """Return the token lines of each room that the working tree has more than the last commit, negative for fewer."""
    grown: Counter[str] = Counter()
    for line in git("diff", "--name-status", "--no-renames", "HEAD", "--", "*.py").splitlines():
        status, path = line.split("\t")
        now = token_lines((ROOT / path).read_text("utf-8")) if status != "D" else 0
        before = token_lines(git("show", f"HEAD:{path}")) if status != "A" else 0
        grown[room(path)] += now - before
    for path in git("ls-files", "--others", "--exclude-standard", "*.py").splitlines():
        grown[room(path)] += token_lines((ROOT / path).read_text("utf-8"))
    return grown


def findings(counted: Mapping[str, int], budgets: Mapping[str, int]) -> Iterator[str]:
    """Yield a line for each room that is above its budget, has none, or is gone."""
    for name in sorted(counted.keys() | budgets.keys()):
        if name not in budgets:
            yield f"{name}: no budget in pyproject.toml, [tool.kurt2rt.size]; it has {counted[name]} token lines"
        elif name not in counted:
            yield f"{name}: a budget in pyproject.toml, and no such room; remove it"
        elif (over := counted[name] - budgets[name]) > 0:
            yield f"{name}: {counted[name]} token lines, {over} above its budget"


def main() -> int:
    """Print the table and return 1 if a room is above its budget, else 0."""
    budgets = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["tool"]["kurt2rt"]["size"]
    if not (ROOT / ".git").exists():
        print("size: no git checkout, so it is unknown which files are the project's")
        return 0
    counted, grown = sizes(), growth()
    print(f"{'room':<22}{'lines':>8}{'budget':>8}{'since HEAD':>12}")
    for name, lines in sorted(counted.items()):
        print(f"{name:<22}{lines:>8}{budgets.get(name, '-'):>8}{grown[name]:>+12}")
    for title, chosen in (("production", [each for each in counted if each != "tests"]), ("tests", ["tests"])):
        lines, more = sum(counted[each] for each in chosen), sum(grown[each] for each in chosen)
        print(f"{title:<22}{lines:>8}{sum(budgets.get(each, 0) for each in chosen):>8}{more:>+12}")
    over = list(findings(counted, budgets))
    print(*over, sep="\n")
    return 1 if over else 0


if __name__ == "__main__":
    sys.exit(main())
