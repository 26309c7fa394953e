"""Teaching events about appraisals, and circumstances that nothing is wrong with."""

from itertools import count

from behaviors.judges.judge import AppraisalFeatures
from kurt2rt.core.critic.settings import NAMES, load_critic
from kurt2rt.core.rla.events import RlaCreated
from kurt2rt.core.rla.rla import CRITIC, Origin, Phase, Rla

SETTINGS = load_critic()
FREE = AppraisalFeatures(0.6, 0.6, 0.6, 0.6, 0.6, 0.6, 0.0, 0.0, 0.3, 0.0, 0.0, 0.0, 0.0)

_numbers = count(1)


def origin(command_id: str | None = None, teacher: str = "ada", phase: Phase = Phase.CRITIC, tick: int = 0) -> Origin:
    """Return the origin of a new command, or of a named one."""
    return Origin(command_id or f"command-{next(_numbers)}", teacher, phase, tick)


def appraisal(
    rla_id: int, action: str, circumstances: AppraisalFeatures = FREE, said_by: Origin | None = None
) -> RlaCreated:
    return RlaCreated(Rla(rla_id, tuple(circumstances)[: len(NAMES)], action, None, said_by or origin(), level=CRITIC))
