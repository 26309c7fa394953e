"""Copy a knowledge file without end: the child of test_copy.py, which kills it.

Prints the name of each copy once it is there: `python -m tests.knowledge.copy_until_killed FILE FOLDER STAMP`.
"""

import sys
from itertools import count
from pathlib import Path

from kurt2rt.knowledge.files.backup import save_copy


def copy(path: Path, folder: Path, stamp: str) -> None:
    """Label the copies by their numbers."""
    for number in count():
        print(save_copy(path, folder, str(number), stamp).name, flush=True)


if __name__ == "__main__":
    copy(Path(sys.argv[1]), Path(sys.argv[2]), sys.argv[3])
