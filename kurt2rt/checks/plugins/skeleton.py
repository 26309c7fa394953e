"""Skeleton of a plug-in: a folder that installs, and that passes its own check."""

import re
import sys
from importlib.resources import files
from importlib.util import find_spec
from pathlib import Path
from string import Template

from behaviors.registry import JUDGES, METRICS, POLICIES
from behaviors.repertoire_settings import BEHAVIOURS
from hal.robot_plugins import ROBOTS
from hal.settings_files import TASKS, WORLDS
from kurt2rt.checks.plugins.kinds import KINDS, NoPluginError
from kurt2rt.core.learner.learners import LEARNERS

_NAME = re.compile(r"[a-z][a-z0-9_]{0,39}")
_PART_OF_A_TASK = (
    "\nA task takes it in its file: `{key}: {{kind: $name}}` with its settings.\n"
    "`docs/add-a-task.md` of kurt2rt explains the file.\n"
)
_USES = {
    LEARNERS.group: "\n`kurt2rt study compare --learner $name` teaches it and compares it with others.\n",
    POLICIES.group: _PART_OF_A_TASK.format(key="policy"),
    JUDGES.group: _PART_OF_A_TASK.format(key="judge"),
    METRICS.group: _PART_OF_A_TASK.format(key="course"),
    BEHAVIOURS.group: "\nA repertoire takes it in its file: `{kind: $name, name: my_action}` with its settings.\n",
    TASKS.group: "\n`kurt2rt demo --task $name` teaches it.\n",
    WORLDS.group: "\n`kurt2rt run --world $name` drives in it.\n",
    ROBOTS.group: "\n`kurt2rt demo --task $name/fleeing` teaches it, once it is installed.\n"
    "`docs/teach-another-robot.md` of kurt2rt explains its files.\n",
}
_FILES_OF_A_ROBOT = {
    "__init__.py": "__init__.py",
    "link.py": "link.py",
    "simulated.py": "simulated.py",
    "data/robots/{name}.yaml": "robot.yaml",
    "data/situations/basic.yaml": "situation.yaml",
    "data/repertoires/basic.yaml": "repertoire.yaml",
    "data/tasks/fleeing.yaml": "fleeing.yaml",
}
"""Templates in the folder of robots by the files that are made of them."""


def write_skeleton(group: str, name: str, folder: Path) -> list[Path]:
    """Write a plug-in of a kind to `folder`/`name`; return its files.

    `group`: the kind, such as policies. Raises NoPluginError for a name that is none or taken, and for a folder that
    is there already.
    """
    _require_free(group, name)
    folder = folder / name
    if folder.exists():
        raise NoPluginError("is there already", where=folder, do="give another name or --out, or remove it")
    class_name = "".join(each.capitalize() for each in name.split("_"))
    part = {TASKS.group: "TASK", WORLDS.group: "world", ROBOTS.group: name.upper()}.get(group, class_name)
    values = {"name": name, "group": group, "part": part, "distribution": name.replace("_", "-")}
    values["use"] = Template(_USES[group]).substitute(values)
    templates = {
        folder / "pyproject.toml": "pyproject.toml.txt",
        folder / "README.md": "README.md.txt",
        folder / f"test_{name}.py": "test.py.txt",
    }
    if group == ROBOTS.group:
        parts = {path.format(name=name): f"{group}/{template}.txt" for path, template in _FILES_OF_A_ROBOT.items()}
    else:
        parts = {"__init__.py": f"{group}.py.txt"}
    if group == TASKS.group:
        parts[f"{name}.yaml"] = "task.yaml.txt"
    # Within src: Python would take the outer folder for the package where it is started above it.
    templates |= {folder / "src" / name / path: template for path, template in parts.items()}
    for path, template in templates.items():
        path.parent.mkdir(parents=True, exist_ok=True)
        text = files("kurt2rt.checks.plugins").joinpath("templates", template).read_text(encoding="utf-8")
        path.write_text(Template(text).substitute(values), encoding="utf-8")
    return list(templates)


def _require_free(group: str, name: str) -> None:
    if not _NAME.fullmatch(name):
        raise NoPluginError(
            f"is no name of a plug-in (got {name!r}, allowed are a-z, 0-9 and _, a letter first, 40 at most)",
            where="NAME",
            do="give one such as wandering",
        )
    if name in KINDS[group].shipped() or name in sys.stdlib_module_names or find_spec(name) is not None:
        raise NoPluginError(f"{name!r} is the name of a shipped part or a module", where="NAME", do="give another name")
