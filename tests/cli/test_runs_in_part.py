"""`kurt2rt why` and `kurt2rt replay` of runs of which not all is there."""

import json
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
    assert json.loads(kurt2rt("why", late, "--json").out)["trouble"]
    for words in (("why", late, "--at", "3"), ("replay", late)):
        assert late.name in kurt2rt.refused(*words)


def test_run_without_a_tick_is_refused_and_never_the_newest(kurt2rt: CommandLine, tmp_path: Path) -> None:
    assert NAME in kurt2rt.refused("replay", empty_run(tmp_path))
    knowledge = tmp_path / "some.knowledge"
    open_knowledge(knowledge, load_robot(), load_task("wall_following")).close()
    assert NAME in kurt2rt.refused("replay", tmp_path / NAME, "--compare", knowledge)
    assert NAME not in kurt2rt.refused("replay", "--runs", tmp_path)
