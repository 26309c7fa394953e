"""Skeleton of a plug-in: a folder that installs, with tests that it passes."""

import re
import sys
from enum import StrEnum
from importlib.resources import files
from importlib.util import find_spec
from pathlib import Path
from string import Template

from kurt2rt.checks.plugins.kinds import KINDS, NoPluginError

_NAME = re.compile(r"[a-z][a-z0-9_]{0,39}")


class SkeletonKind(StrEnum):
    """Kind of plug-in that is begun, on the command line; one of another kind is a single file."""

    LEARNERS = "learners"
    ROBOTS = "robots"


_USES = {
    SkeletonKind.LEARNERS: "\n`kurt2rt study compare --learner $name` teaches it and compares it with others.\n",
    SkeletonKind.ROBOTS: "\n`kurt2rt demo --task $name/fleeing` teaches it, once it is installed.\n"
    "`docs/other-robots.md` of kurt2rt explains its files.\n",
}
_FILES = {
    SkeletonKind.LEARNERS: {"test_{name}.py": "test_learner.py", "src/{name}/__init__.py": "learners.py"},
    SkeletonKind.ROBOTS: {
        "test_{name}.py": "test_robot.py",
        "src/{name}/__init__.py": "robots/__init__.py",
        "src/{name}/link.py": "robots/link.py",
        "src/{name}/simulated.py": "robots/simulated.py",
        "src/{name}/data/robots/{name}.yaml": "robots/robot.yaml",
        "src/{name}/data/situations/basic.yaml": "robots/situation.yaml",
        "src/{name}/data/repertoires/basic.yaml": "robots/repertoire.yaml",
        "src/{name}/data/tasks/fleeing.yaml": "robots/fleeing.yaml",
    },
}
"""Templates by the files that are made of them.

Modules are within src: Python would take the outer folder for the package where it is started above it.
"""


def write_skeleton(kind: SkeletonKind, name: str, folder: Path) -> list[Path]:
    """Write a plug-in to `folder`/`name`; return its files.

    Raises NoPluginError for a name that is none or taken, and for a folder that is there already.
    """
    _require_free(kind, name)
    folder = folder / name
    if folder.exists():
        raise NoPluginError("is there already", where=folder, do="give another name or --out, or remove it")
    class_name = "".join(each.capitalize() for each in name.split("_"))
    part = name.upper() if kind is SkeletonKind.ROBOTS else class_name
    values = {"name": name, "group": kind.value, "part": part, "class_name": class_name}
    values |= {"distribution": name.replace("_", "-"), "use": Template(_USES[kind]).substitute(name=name)}
    made = {"pyproject.toml": "pyproject.toml", "README.md": "README.md", **_FILES[kind]}
    for path, template in made.items():
        target = folder / path.format(name=name)
        target.parent.mkdir(parents=True, exist_ok=True)
        text = files("kurt2rt.checks.plugins").joinpath("templates", f"{template}.txt").read_text(encoding="utf-8")
        target.write_text(Template(text).substitute(values), encoding="utf-8")
    return [folder / path.format(name=name) for path in made]


def _require_free(kind: SkeletonKind, name: str) -> None:
    if not _NAME.fullmatch(name):
        raise NoPluginError(
            f"cannot name a plug-in (got {name!r}, allowed are a-z, 0-9 and _, a letter first, 40 at most)",
            where="NAME",
            do="give one such as wandering",
        )
    if name in KINDS[kind].shipped() or name in sys.stdlib_module_names or find_spec(name) is not None:
        raise NoPluginError(f"{name!r} is the name of a shipped part or a module", where="NAME", do="give another name")
