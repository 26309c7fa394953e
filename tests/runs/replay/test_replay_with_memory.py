"""Recorded run of a robot whose critic remembers its turning: replayed bit for bit."""

from pathlib import Path

from kurt2rt.core.critic.settings import CirclingSettings, load_critic
from kurt2rt.core.rla.rla import Phase
from kurt2rt.core.task_settings import load_task
from kurt2rt.core.teaching.commands import Appraise, Resume, SetPhase, Teach, Watch
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.runs.replay.comparison import compare
from kurt2rt.runs.replay.reader import read_run
from kurt2rt.runs.replay.replay import Replay
from simbridge.contracts.simulation import Pose
from tests.runs.replay.stories import NAME, Scene, record_story


def circles(scene: Scene, record: TickRecord) -> None:
    """Teach one curve to the left; appraise it as good in the first round and as bad later; then reposition."""
    inbox, tick = scene.runtime.inbox, record.tick
    if tick == 1:
        scene.simulation.put(Pose(2.0, 2.0, 0.0))
        inbox.put(Resume("go", NAME))
    inbox.put(Watch(NAME, tick))
    match tick:
        case 20:
            inbox.put(Teach("curve", NAME, "sharp_left"))
        case 30:
            inbox.put(SetPhase("phase 4", NAME, Phase.CRITIC))
        case 150:
            inbox.put(Appraise("first", NAME, "good", tick))
        case 600:
            inbox.put(Appraise("again", NAME, "bad", tick))
        case 700:
            scene.runtime.reposition()


def test_run_with_circling_is_replayed_bit_for_bit(tmp_path: Path) -> None:
    critic = load_critic()
    circling = CirclingSettings(round_rad=2.0, reversal_rad=0.6)
    weights = critic.learning.weights.model_copy(update={"circling": 4.0})
    critic = critic.model_copy(
        update={
            "perception": critic.perception.model_copy(update={"circling": circling}),
            "learning": critic.learning.model_copy(update={"weights": weights}),
        }
    )
    task = load_task("wall_following").model_copy(update={"critic": critic})
    run = read_run(record_story("walls", tmp_path, seconds=9, other=circles, task=task))
    opinions: dict[float, set[int | None]] = {0.0: set(), 1.0: set()}
    for entry, record in Replay(run):
        assert compare(entry, record) == []
        if record.tick > 610 and record.appraisal_features is not None and record.opinion is not None:
            opinions[record.appraisal_features.circling].add(record.opinion.said)
    assert opinions == {0.0: {1}, 1.0: {-1}}
