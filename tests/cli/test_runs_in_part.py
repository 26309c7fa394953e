"""`kurt2rt why` and `kurt2rt replay` of runs of which not all is there."""

from pathlib import Path

from hal.robot_settings import load_robot
from kurt2rt.core.task_settings import load_task
from kurt2rt.knowledge.journal.loading import open_knowledge
from tests.cli.helpers import CommandLine
from tests.runs.recording.desk_recording import NAME, empty_run, late_run


def test_why_of_a_run_without_beginning_shows_the_rest(kurt2rt: CommandLine, tmp_path: Path) -> None:
    late = late_run(tmp_path)
    said = kurt2rt("why", late)
    assert said.exit_code == 0, said.err
    assert "The recording: the first " in said.out
    assert "ticks not recorded" not in said.out
    refused = " ".join(kurt2rt.refused("why", late, "--at", "3").split())
    assert "so it can neither be replayed nor one of its decisions be explained" in refused
    assert "is there from its tick" in kurt2rt.refused("replay", late)


def test_run_without_a_tick_is_refused_and_never_the_newest(kurt2rt: CommandLine, tmp_path: Path) -> None:
    assert "holds no tick; the program ended before the first one" in kurt2rt.refused("replay", empty_run(tmp_path))
    knowledge = tmp_path / "some.knowledge"
    open_knowledge(knowledge, load_robot(), load_task("wall_following")).close()
    assert "holds no tick" in kurt2rt.refused("replay", tmp_path / NAME, "--with", knowledge)
    assert "no recorded run is there" in kurt2rt.refused("replay", "--runs", tmp_path)
