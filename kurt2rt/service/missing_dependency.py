"""Dependency that the start of the program waits for; `kurt2rt.service.startup` has the texts."""

from dataclasses import dataclass
from enum import StrEnum


class DependencyName(StrEnum):
    """Thing that the program cannot start without."""

    BUS = "bus"
    KNOWLEDGE = "knowledge"
    KEYS = "teachers' keys"
    NETWORK = "network"
    RECORDINGS = "recordings"


class WaitReason(StrEnum):
    """Kind of error that keeps a dependency missing; each is tried again."""

    FOLDER = "folder"
    BUS = "bus"
    KNOWLEDGE = "knowledge"
    CHANNEL = "channel"
    KEYS = "keys"
    RECORDING = "recording"
    SYSTEM = "system"
    """Error of the operating system."""


@dataclass(frozen=True, slots=True)
class MissingDependency:
    """Dependency that is not there yet."""

    name: DependencyName
    reason: WaitReason | None = None
    """None until its first check is over."""
    says: str = ""
    """Error in words."""
