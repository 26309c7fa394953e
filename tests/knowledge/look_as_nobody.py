"""Counts the lessons of a file as somebody without rights: `python -m tests.knowledge.look_as_nobody FILE`.

Root may write anywhere, so root looks as nobody.
"""

import os
import sys
from pathlib import Path

from kurt2rt.knowledge.journal.journal import Journal

_NOBODY = 65534

if __name__ == "__main__":
    if os.getuid() == 0:
        os.setuid(_NOBODY)
    with Journal.read_only(Path(sys.argv[1])) as journal:
        print(len(journal.events()))
