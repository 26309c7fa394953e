"""Program that runs `kurt2rt` commands where some packages cannot be imported.

Its argument is JSON: the hidden packages, and a list of commands, each a list of words. It imports the modules of all
commands, then runs the given ones in this process, and prints their exit codes and outputs as JSON.
"""

import json
import sys
from collections.abc import Sequence
from contextlib import redirect_stderr, redirect_stdout
from importlib.abc import MetaPathFinder
from io import StringIO
from types import ModuleType


class _Hiding(MetaPathFinder):
    """Finder that comes first and refuses the hidden packages."""

    def __init__(self, hidden: Sequence[str]) -> None:
        self._hidden = frozenset(hidden)

    def find_spec(self, name: str, path: Sequence[str] | None, target: ModuleType | None = None) -> None:  # noqa: ARG002
        """Raise ModuleNotFoundError for a hidden module."""
        if name.partition(".")[0] in self._hidden:
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)


def _run(words: list[str]) -> dict[str, object]:
    from kurt2rt.cli.main import main

    sys.argv = ["kurt2rt", *words]
    with redirect_stdout(StringIO()) as out, redirect_stderr(StringIO()) as err:
        try:
            main()
        except SystemExit as end:
            return {"exit_code": end.code or 0, "out": out.getvalue(), "err": err.getvalue()}
    raise AssertionError("main returned without SystemExit")


if __name__ == "__main__":
    given = json.loads(sys.argv[1])
    sys.meta_path.insert(0, _Hiding(given["hidden"]))
    from kurt2rt.cli.command_line import command_line

    command_line()
    print(json.dumps([_run(words) for words in given["commands"]]))
