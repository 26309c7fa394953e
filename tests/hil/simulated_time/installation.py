"""An installation for everybody, as docs/run-as-a-service.md asks for one: of what runs the tests, but in no home."""

import subprocess
import sys
from pathlib import Path

from config import CONFIG_DIR

_PLACE = Path("/opt/kurt2rt")
_PARTS = Path("/opt/kurt2rt-parts")
_BYTECODE = Path("/opt/kurt2rt-bytecode")
_ONCE = ("run", "--seconds", "0.1", "--no-record", "--teacher", "none")
"""Compiles what a start takes, which the service's own user could not keep."""
_SCRIPT = "#!{python}\nimport sys\n\nfrom kurt2rt.cli.main import main\n\nsys.exit(main())\n"


def install_for_everybody() -> Path:
    """Make one in a machine that is thrown away; returns its kurt2rt. Raises subprocess.CalledProcessError, OSError.

    The interpreter and the packages are where they are, which may be in a home; here they are in /opt as well.
    """
    python = _in_parts("python", Path(sys.base_prefix)) / "bin" / f"python3.{sys.version_info.minor}"
    packages = _in_parts("environment", Path(sys.prefix)) / "lib" / python.name / "site-packages"
    project = _in_parts("project", CONFIG_DIR.parent)
    # A shared libpython would be found where it was built for; and each start would compile all files again.
    given = {"LD_LIBRARY_PATH": f"{python.parents[1]}/lib", "PYTHONPYCACHEPREFIX": str(_BYTECODE)}
    words = [f"{name}={value}" for name, value in given.items()]
    _do("systemctl", "set-environment", *words)
    _do("env", *words, str(python), "-m", "venv", "--without-pip", str(_PLACE))
    (_PLACE / "lib" / python.name / "site-packages" / "parts.pth").write_text(f"{project}\n{packages}\n", "utf-8")
    script = _PLACE / "bin" / "kurt2rt"
    script.write_text(_SCRIPT.format(python=_PLACE / "bin" / "python"), encoding="utf-8")
    script.chmod(0o755)
    once = (*_ONCE, "--knowledge", f"{_PARTS}/once.knowledge")
    _do("env", "--unset=PYTHONDONTWRITEBYTECODE", *words, str(script), *once)
    return script


def _in_parts(name: str, folder: Path) -> Path:
    place = _PARTS / name
    place.mkdir(parents=True)
    _do("mount", "--bind", str(folder), str(place))
    return place


def _do(*words: str) -> None:
    subprocess.run(words, check=True, capture_output=True, text=True)
