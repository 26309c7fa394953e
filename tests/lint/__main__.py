"""Command line: `python -m tests.lint [--update | FOLDER ...]`."""

import argparse
import sys

from tests.lint.ratchet import ROOT, counted, differences, findings, load_allowed, write_allowed
from tests.lint.reader import help_findings


def main() -> int:
    """Return 1 if a number differs from the table, else 0; with folders, list their findings instead."""
    parser = argparse.ArgumentParser(prog="python -m tests.lint", description="Check the words of the project.")
    parser.add_argument("paths", nargs="*", metavar="PATH", help="list the findings below these folders or files")
    parser.add_argument("--update", action="store_true", help="write the numbers of today into the table")
    arguments = parser.parse_args()
    found = sorted([*findings(ROOT), *help_findings()])
    if arguments.paths:
        below = tuple(path.rstrip("/") for path in arguments.paths)
        listed = [
            each for each in found if any(each.path == path or each.path.startswith(f"{path}/") for path in below)
        ]
        print(*listed, sep="\n")
        return 0
    if arguments.update:  # without reading the table, which may hold the marks of a merge conflict
        write_allowed(counted(found))
        return 0
    lines = list(differences(counted(found), load_allowed()))
    if lines:
        print(*lines, sep="\n")
    return 1 if lines else 0


if __name__ == "__main__":
    sys.exit(main())
