"""The blocking teacher against the robot's own program in another process, and against a robot that is not there."""

import signal
import threading
from collections.abc import Callable, Iterator
from typing import TypeVar

import anyio
import anyio.to_thread
import pytest

import kurt2rt.teacher
from kurt2rt.channel.protocol.schema import ChannelError
from kurt2rt.channel.security.context_folder import CredentialsError
from kurt2rt.channel.security.pairing import ONLOOKER, Pairing
from kurt2rt.core.outcome import Outcome, RefusalCode, ResultCode
from kurt2rt.core.teaching.commands import Correct, Resume, Take, Teach, Undo, Watch
from kurt2rt.teacher import RobotProcess, Teacher
from kurt2rt.teacher.client.answer import Answer, NoAnswerError
from tests.forked_robot import fork_robots
from tests.patience import PATIENCE_S
from tests.teacher.stand_in_robot import stand_in_robot

_Result = TypeVar("_Result")


@pytest.fixture(scope="module")
def robot(tmp_path_factory: pytest.TempPathFactory) -> Iterator[RobotProcess]:
    with pytest.MonkeyPatch.context() as monkeypatch:
        fork_robots(monkeypatch)
        with RobotProcess(tmp_path_factory.mktemp("robot")) as robot:
            yield robot


async def in_a_thread(call: Callable[[], _Result]) -> _Result:
    return await anyio.to_thread.run_sync(call)


async def test_teacher_in_a_running_loop_teaches(robot: RobotProcess) -> None:
    # As in a notebook: this test's loop runs, and each call blocks it.
    with Teacher(robot.device) as teacher:
        hello = teacher.hello()
        assert hello.simulated
        assert "forward" in hello.actions
        assert teacher.world() is not None
        assert teacher.send(Take).accepted
        teacher.send(Resume)
        asking = teacher.wait_for_question()
        assert teacher.send(Teach, action="forward", decision_tick=asking.tick).outcome == Outcome.of(
            ResultCode.RLA_TAUGHT, rla=1, action="forward"
        )
        drives = teacher.wait_until(lambda state: state.cause == "rla")
        assert (drives.rla, drives.teacher) == (1, "local")
        refused = teacher.send(Correct, action="fly")
        assert (refused.accepted, refused.why) == (False, "refused")
        (line,) = teacher.lessons()
        assert "RLA 1 " in line.text
        assert teacher.send(Undo).accepted
        assert teacher.wait_for_question().rlas == 0
    assert robot.knowledge.is_file()


def test_drive_interrupted_by_ctrl_c_stops_the_robot(robot: RobotProcess) -> None:
    with Teacher(robot.device, patience_s=10.0) as teacher:
        teacher.send(Take)
        # A device that stalls for a quarter of a second is silent: the robot ends its press.
        while teacher.drive(0.1, 0.1, seconds=0.1) != "":
            assert teacher.wait_until(lambda state: not state.by_hand).left_m_s == 0.0
        assert teacher.wait_until(lambda state: not state.by_hand).left_m_s == 0.0
        main = threading.main_thread().ident
        assert main is not None

        def interrupt_once_it_drives() -> None:
            with looker:
                looker.wait_until(lambda state: state.by_hand)
            signal.pthread_kill(main, signal.SIGINT)

        looker = Teacher(robot.device.with_name(ONLOOKER), patience_s=10.0)
        interrupting = threading.Thread(target=interrupt_once_it_drives)
        interrupting.start()
        with pytest.raises(KeyboardInterrupt):
            drive_for_ever(teacher)
        interrupting.join()
        stands = teacher.wait_until(lambda state: not state.by_hand)
        assert (stands.left_m_s, stands.right_m_s) == (0.0, 0.0)


def drive_for_ever(teacher: Teacher) -> None:
    """Drive on also after a press that the robot ended because this program stalled."""
    while True:
        teacher.drive(0.1, 0.1, seconds=600.0)


def hold_forward(teacher: Teacher) -> Answer:
    """Hold from a question, with nothing taught; again if the robot ended the press because this program stalled."""
    while True:
        teacher.send(Resume)
        while rlas := teacher.state.rlas:
            assert teacher.send(Undo).accepted
            teacher.wait_until(lambda state: state.rlas < rlas)
        teacher.wait_for_question()
        answer = teacher.hold_for("forward", seconds=0.3)
        if answer.code is ResultCode.HOLD_RELEASED:
            return answer


def test_hold_teaches_for_its_time_and_tells_how_many(robot: RobotProcess) -> None:
    with Teacher(robot.device, patience_s=10.0) as teacher:
        teacher.send(Take)
        answer = hold_forward(teacher)
        assert answer.outcome is not None
        assert answer.outcome.fields["lessons"] == 1
        teacher.wait_until(lambda state: state.cause == "rla")
        assert "forward" in teacher.lessons()[0].text
        assert teacher.send(Undo).accepted
        teacher.wait_until(lambda state: not state.rlas)
        teacher.stop()
        refused = teacher.hold_for("forward", seconds=10.0)
        while refused.code is RefusalCode.PICTURE_LOST:  # this program stalled before the robot could refuse the press
            refused = teacher.hold_for("forward", seconds=10.0)
        assert refused.code is RefusalCode.ROBOT_STOPPED
        assert teacher.send(Resume).accepted


async def test_attention_ends_after_the_last_call(pairing: Pairing) -> None:
    async with stand_in_robot(pairing.teacher.parent) as robot:
        robot.show(teacher="phone")
        teacher = Teacher(pairing.device.folder, port=robot.port, attention_s=0.1)
        await in_a_thread(teacher.open)
        await in_a_thread(lambda: teacher.wait_until(lambda state: state.teacher == "phone"))
        await robot.hears(Watch)
        with anyio.fail_after(PATIENCE_S):
            heard = -1
            while heard != (heard := len(robot.all_of(Watch))):  # noqa: ASYNC110
                await anyio.sleep(0.2)  # ten messages, if attention lasted
        await in_a_thread(lambda: teacher.state)
        await robot.hears(Watch, heard + 1)
        await in_a_thread(teacher.close)
        await in_a_thread(teacher.close)


def test_no_robot_is_one_line_that_says_what_to_do(pairing: Pairing) -> None:
    with pytest.raises(NoAnswerError) as caught:
        Teacher(pairing.device.folder, port=1, connect_s=0.2).open()
    assert "\n" not in str(caught.value)
    assert "0.2 s" in str(caught.value)
    assert str(caught.value).endswith("kurt2rt run")
    with pytest.raises(CredentialsError, match="nothing"):
        Teacher(pairing.device.folder.with_name("nothing")).open()


def test_a_teacher_that_is_not_open_says_how_to_open_it() -> None:
    with pytest.raises(RuntimeError, match="with Teacher"):
        Teacher("nothing").stop()


def test_wait_until_ends_with_the_newest_cause(robot: RobotProcess) -> None:
    with Teacher(robot.device) as teacher, pytest.raises(TimeoutError, match=r"\b0 s\b"):
        teacher.wait_until(lambda _: False, timeout_s=0.0)


def test_a_robot_that_cannot_start_says_why(monkeypatch: pytest.MonkeyPatch) -> None:
    fork_robots(monkeypatch)
    robot = RobotProcess(world="nowhere")
    with pytest.raises(ChannelError, match=r"code 2: .*nowhere"):
        robot.start()
    with pytest.raises(RuntimeError):
        robot.device.exists()


def test_the_package_names_what_it_has() -> None:
    assert kurt2rt.teacher.Teacher is Teacher
    with pytest.raises(AttributeError, match="'Missing'"):
        assert kurt2rt.teacher.Missing
