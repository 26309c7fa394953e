"""Count the lessons of a file without write permission: `python -m tests.knowledge.read_without_rights FILE`.

Root may write anywhere, so root becomes an unprivileged user.
"""

import os
import sys
from pathlib import Path

from kurt2rt.knowledge.journal.journal import Journal

_UNPRIVILEGED = 65534

if __name__ == "__main__":
    if os.getuid() == 0:
        os.setuid(_UNPRIVILEGED)
    with Journal.read_only(Path(sys.argv[1])) as journal:
        print(len(journal.events()))
