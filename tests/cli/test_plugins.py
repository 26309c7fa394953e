"""Plug-ins on the command line."""

import re
import sys
from pathlib import Path

from config import plugins
from kurt2rt import SimulatedRobot
from kurt2rt.runs.recording.run_folder import runs_in
from kurt2rt.runs.replay.reader import read_run
from tests.cli.helpers import CommandLine
from tests.plugin_packages import write_parts, write_repertoire, write_task


def test_run_names_its_plugins_and_a_replay_imports_none(kurt2rt: CommandLine, plugin_folder: Path) -> None:
    write_parts(plugin_folder, "parts_run")
    write_task(plugin_folder, policy={"kind": "parts_run:Turning"})
    said = kurt2rt("run", "--task", "mine.yaml", "--seconds", "0.3", "--teacher", "none", "--knowledge", "k.knowledge")
    assert said.exit_code == 0, said.err
    file = str(plugin_folder / "parts_run.py")
    assert re.search(rf"plug-in of policies parts_run:Turning from {re.escape(file)}, hash [0-9a-f]{{8}}\n", said.out)
    assert "plug-in of robots" not in said.out  # kurt2 is the project's
    (run,) = runs_in(plugin_folder / "var" / "runs")
    assert read_run(run).head.plugins == {"policies parts_run:Turning": file}
    plugins._LOADED.clear()
    del sys.modules["parts_run"]
    replayed = kurt2rt("replay")
    assert replayed.exit_code == 0, replayed.err
    assert "parts_run" not in sys.modules


def test_robot_stands_and_asks_once_an_action_failed(plugin_folder: Path) -> None:
    write_parts(plugin_folder, "parts_dizzy")
    wiggle = {"kind": "parts_dizzy:Wiggling", "name": "wiggle", "fails_at_tick": 30}
    task = write_task(plugin_folder, repertoire=str(write_repertoire(plugin_folder, wiggle)))
    with SimulatedRobot(task=str(task), world="a", seed=1) as robot:
        robot.teach("wiggle")
        robot.run(seconds=0.2)
        assert str(robot.why()).startswith("wiggle\n")
        robot.run(seconds=0.5)
        assert str(robot.why()).startswith("stands and asks: ")
