"""The teacher's side: commands, questions, lessons, a scripted teacher, and `TeacherClient` for a teacher's device."""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from kurt2rt.teaching.client import TeacherClient

__all__ = ["TeacherClient"]


def __getattr__(name: str) -> Any:
    # Only who asks for the client pays for its network library.
    if name == "TeacherClient":
        from kurt2rt.teaching.client import TeacherClient

        return TeacherClient
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
