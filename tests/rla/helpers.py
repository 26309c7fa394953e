"""Teaching events in one line each."""

from kurt2rt.rla.rla import ActionReplaced, Origin, Phase, Rla, RlaCreated, RlaDeleted


def origin(command_id: str = "lesson-1", tick: int = 1) -> Origin:
    return Origin(command_id, "Ann", Phase.SUPERVISED, tick)


def created(
    rla_id: int, condition: tuple[float, ...], action: str = "forward", radius: float | None = None
) -> RlaCreated:
    return RlaCreated(Rla(rla_id, condition, action, radius, origin(f"lesson-{rla_id}", rla_id)))


def replaced(rla_id: int, action: str, instead_of: str) -> ActionReplaced:
    return ActionReplaced(rla_id, action, instead_of, origin(f"correction-{rla_id}", 1000 + rla_id))


def deleted(rla_id: int) -> RlaDeleted:
    return RlaDeleted(rla_id, origin(f"deletion-{rla_id}", 2000 + rla_id))
