"""Fingerprints of what decides a result, so that results of other settings are never mixed in."""

import hashlib
import json
import platform
from collections.abc import Collection, Iterable
from functools import lru_cache
from importlib.metadata import version
from importlib.resources import files
from pathlib import Path

from behaviors.repertoire_settings import RepertoireSettings
from config.plugin_source import source_hash_of
from config.plugins import OWN_PACKAGES
from config.settings import Settings, content_of, load_settings
from config.settings_files import find_config
from hal.robot_settings import RobotSettings
from kurt2rt.core.task_settings import TaskSettings
from simbridge.contracts.simulation import SimulationFactory

_COMPUTE = ("numpy", "pymunk", "shapely")


class Provenance(Settings):
    """Hashes of all that decides a result: settings, worlds, source and versions of packages.

    Results of another provenance are refused in the same folder; error texts name the fields that differ.
    """

    task: str
    robot: str
    worlds: str
    source: str
    versions: str
    plugins: str = ""
    """Hash of the plug-ins that the task names; empty without any."""
    learner: str = ""
    """Hash of a learner's name, gate and source, and of the packages that it computes with; empty for RLAs."""

    def differences(self, other: "Provenance") -> list[str]:
        """Return the names of the fields that differ."""
        return [name for name in type(self).model_fields if getattr(self, name) != getattr(other, name)]


def versions() -> str:
    """Return the versions of the computing packages; each Python computes the same (docs/how-it-decides.md)."""
    return ", ".join(f"{name} {version(name)}" for name in _COMPUTE)


def versions_with_python() -> str:
    """Return the versions of Python and of the computing packages."""
    return f"Python {platform.python_version()}, {versions()}"


@lru_cache
def program_hash(*suffixes: str) -> str:
    """Return the hash of all files of the program with these suffixes, such as `.py`, byte for byte.

    A hash of the syntax tree would leave comments out, but Python 3.12 has other trees than Python 3.11.
    """
    digest = hashlib.sha256()
    for package in OWN_PACKAGES:
        folder = Path(str(files(package)))
        for path in sorted(path for path in folder.rglob("*") if path.suffix in suffixes):
            digest.update(f"{package}/{path.relative_to(folder).as_posix()}\0".encode())
            digest.update(hashlib.sha256(path.read_bytes()).digest())
    return digest.hexdigest()[:16]


def source_hash() -> str:
    """Return the hash of the program's source, which decides all results."""
    return program_hash(".py")


def settings_hash(*settings: str) -> str:
    """Return the hash of all texts, in their order: the first 16 hexadecimal digits of their SHA-256."""
    return hashlib.sha256("\0".join(settings).encode()).hexdigest()[:16]


class Fingerprints:
    """Maker of the provenance of a study's jobs; it hashes what they share only once."""

    def __init__(
        self,
        factory: SimulationFactory,
        robot: RobotSettings,
        leave_out: Collection[str] = ("paper", "paper_defaults", "phases"),
    ) -> None:
        """`leave_out`: parts of a task that change nothing in these experiments.

        The task's own numbers of the paper, and the reading that is not taken, never do; nor does its sentence to the
        teacher, which is always left out.
        """
        self._leave_out = {*leave_out, "description"}
        self._versions = versions()
        self._robot = settings_hash(robot.model_dump_json(serialize_as_any=True))
        self._stage = factory
        self._known: dict[tuple[str, str], str] = {}

    def of(self, task: TaskSettings, worlds: Iterable[str], *more: str, learner: str = "") -> Provenance:
        """Return the provenance of a job in these worlds.

        `more`: further texts that decide its result. `learner`: text that changes with the learner; empty for RLAs.
        Raises config.settings.SettingsError if settings of the task or a world cannot be loaded.
        """
        plugins = _plugin_sources(task)
        of_task = task.model_dump_json(exclude=self._leave_out, serialize_as_any=True)
        return Provenance(
            task=settings_hash(
                of_task,
                self._settings("situations", task.situation),
                self._settings("repertoires", task.repertoire),
                *([self._settings("mid_levels", task.mid)] if isinstance(task.mid, str) else ()),
                *more,
            ),
            robot=self._robot,
            worlds=settings_hash(*(self._settings("worlds", world) for world in sorted(set(worlds)))),
            source=source_hash(),
            versions=self._versions,
            plugins=settings_hash(*plugins) if plugins else "",
            learner=settings_hash(learner) if learner else "",
        )

    def _settings(self, kind: str, name: str) -> str:
        """All that a file or a generated world holds, in one way of writing it."""
        if (kind, name) not in self._known:
            if kind == "worlds":
                self._known[kind, name] = self._stage.settings_of(name)
            else:
                self._known[kind, name] = json.dumps(content_of(find_config(kind, name)))
        return self._known[kind, name]


def _plugin_sources(task: TaskSettings) -> list[str]:
    """Return the hash of each plug-in's source that a task names; the program's own source has a field of its own."""
    actions = load_settings(find_config("repertoires", task.repertoire), RepertoireSettings).actions
    hashes = map(source_hash_of, (task.policy, task.metric, task.judge, *actions))
    return [each for each in dict.fromkeys(hashes) if each]
