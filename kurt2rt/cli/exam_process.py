"""Process of a live exam: `python -m kurt2rt.cli.exam_process KNOWLEDGE PICTURE ROBOT TASK SEED`.

Prints the exam's standing as lines of JSON (kurt2rt.channel.protocol.exam_status), the verdict last.
"""

import json
import os
import sys
from pathlib import Path

from config.settings import SettingsError
from hal.robot_settings import load_robot
from kurt2rt.channel.protocol.simulation import EXAM, ExamStatus, WorldVerdict
from kurt2rt.cli.with_parent import end_with_parent
from kurt2rt.core.task_settings import load_task
from kurt2rt.experiments.lockstep.drawing import exams_figure
from kurt2rt.experiments.lockstep.drive_row import label_of
from kurt2rt.experiments.study.exam_tables import verdict_text
from kurt2rt.experiments.study.examination import examine_file
from kurt2rt.knowledge.knowledge_error import KnowledgeError
from kurt2rt.platform.save_figure import save_figure
from simbridge.contracts.robot_kind import simulations_of

NICENESS = 10
"""The robot's loop, and the page, come first."""
_TELL_EACH_SHARE = 0.01


def main(arguments: list[str]) -> None:
    """Examine the knowledge, draw the drives and print the status as lines of JSON.

    `arguments`: knowledge file, picture to write, robot, task and seed, as texts. An error of file or settings is
    printed as the status. Raises ValueError for a seed that is no number.
    """
    knowledge, picture, robot_name, task_name, seed = arguments
    os.nice(NICENESS)
    end_with_parent()  # without the robot's program no process reads the verdict
    try:
        _examine(Path(knowledge), Path(picture), robot_name, task_name, int(seed))
    except (KnowledgeError, SettingsError, OSError) as error:
        _tell(ExamStatus(False, 0.0, "", trouble=" ".join(str(error).split())))


def _examine(knowledge: Path, picture: Path, robot_name: str, task_name: str, seed: int) -> None:
    robot, task = load_robot(robot_name), load_task(task_name)
    drives: dict[str, None] = {}
    told = -1.0

    def report(what: str, done_s: float, whole_s: float) -> None:
        nonlocal told
        drives[what] = None
        share = min(1.0, (len(drives) - 1 + done_s / whole_s) / (2 * len(task.exam.worlds)))
        if share - told >= _TELL_EACH_SHARE:
            told = share
            _tell(ExamStatus(True, share, what))

    results = examine_file(knowledge, robot, task, seed, report)
    unborn = picture.with_name(f".unborn.{picture.name}")
    save_figure(exams_figure(results, simulations_of(robot)), unborn)
    unborn.rename(picture)
    verdicts = tuple(
        WorldVerdict(label_of(each.world), each.passed, verdict_text(each), each.judged) for each in results
    )
    passed, judged = (sum(counts) for counts in zip(*((each.passed, each.judged) for each in verdicts), strict=True))
    unjudged = f"; {len(verdicts) - judged} not judged" if judged < len(verdicts) else ""
    _tell(ExamStatus(False, 1.0, f"Passed in {passed} of {judged} worlds{unjudged}.", verdicts))


def _tell(standing: ExamStatus) -> None:
    print(json.dumps(EXAM.plain_of(standing)), flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
