"""Task, progress and differing sensors on the page."""

from dataclasses import replace

from hal.robot_settings import load_robot
from kurt2rt.core.decision.active_stop import ActiveStop, StopReason
from kurt2rt.core.perception.sensor_words import infrared_law, words_for
from kurt2rt.core.teaching.question import FeatureDifference
from tests.teacher.page.fake_robot import A_HELLO, A_PLACE, FakeRobot
from tests.teacher.page.lesson import Lesson
from tests.teacher.page.phone import Phone

QUESTION = (
    FeatureDifference("maximum front", 441.0, 108.0),
    FeatureDifference("s9", 441.0, 108.0),
    FeatureDifference("s14", 70.0, 400.0),
    FeatureDifference("s17", 160.0, 160.4),
)
ASKS = {"cause": "unknown", "action": None, "rla": None, "distance": 1100.0, "question": QUESTION}
# Orange, as in canvas.js: pixels of one canvas in that colour.
MARKED = """
const canvas = document.querySelector(arguments[0]);
const copy = new OffscreenCanvas(canvas.width, canvas.height); // Chromium warns of a canvas that is read repeatedly
const paint = copy.getContext("2d", { willReadFrequently: true });
paint.drawImage(canvas, 0, 0);
const { data } = paint.getImageData(0, 0, canvas.width, canvas.height);
let count = 0;
for (let i = 0; i < data.length; i += 4) count += data[i] === 0xd9 && data[i + 1] === 0x48 && data[i + 2] === 0x0f;
return count;
"""
CUT = """
return ["#sentence", "#why", "#said", "#what"].filter((name) => {
  const it = document.querySelector(name);
  return it.scrollHeight > it.clientHeight + 1 || it.scrollWidth > it.clientWidth + 1;
});
"""


WHAT = "Teach it to turn left at every junction"


def prepare(robot: FakeRobot) -> None:
    law = infrared_law(load_robot().infrared)
    robot.greeting = replace(A_HELLO, what=WHAT, law=law)


def test_page_says_the_task_and_what_the_phase_changes(a_lesson: Lesson) -> None:
    a_lesson.begin(prepare)
    phone = a_lesson.phone
    assert phone.text("h1") == WHAT
    phone.touch("#tab-more")
    told = []
    for phase in range(1, 6):
        a_lesson.show(phase=phase)
        a_lesson.reads("#phase", f"phase {phase}")
        told.append(phone.text("#phase-says"))
    assert len(set(told)) == 5
    assert all(each.endswith(".") for each in told)


def test_question_has_places_centimetres_and_marks(a_lesson: Lesson) -> None:
    a_lesson.begin(prepare)
    phone = a_lesson.phone
    assert phone.run(MARKED, "#robot-view") == 0
    a_lesson.show(**ASKS)
    a_lesson.reads("#differences", "front left")
    words = words_for(load_robot().infrared)
    # The nearest in front is that sensor, and the rear left edge reads the same to the centimetre.
    assert phone.texts("#differences li") == [
        words.difference(each.name, each.here, each.in_condition) for each in QUESTION[1:3]
    ]
    phone.wait(lambda: phone.run(MARKED, "#robot-view") > 0, "the sensors are marked")
    a_lesson.show(cause="rla", action="forward", rla=1, question=(), distance=300.0)
    phone.wait(lambda: phone.run(MARKED, "#robot-view") == 0, "they are not any more")


def test_world_view_shows_the_rays(a_lesson: Lesson) -> None:
    a_lesson.begin(prepare)
    phone = a_lesson.phone
    phone.touch("#view")
    assert phone.run(MARKED, "#world-view") == 0
    a_lesson.show(**ASKS)
    phone.wait(lambda: phone.run(MARKED, "#world-view") > 0, "the ray of the sensor that differs")
    phone.touch("#view")


def test_trail_outlives_a_reload_and_ends_with_the_robot_program(a_lesson: Lesson) -> None:
    a_lesson.begin(prepare)
    phone = a_lesson.phone
    for step in (1, 2):
        a_lesson.show(place=replace(A_PLACE, x_m=1.0 + step))
        stay(phone)
    reload(phone)
    assert {2.0, 3.0} <= xs(phone)
    a_lesson.begin(prepare)
    reload(phone)
    assert xs(phone) == {A_PLACE.x_m}


def stay(phone: Phone) -> None:
    """Send more states: the page stores ten places a second."""
    phone.pass_time(0.3)


def reload(phone: Phone) -> None:
    phone.reload()
    phone.wait(lambda: phone.text("#claim") == "", "the page has control")
    phone.wait(lambda: phone.text("h1").startswith("Teach it"), "the page is there again")


def xs(phone: Phone) -> set[float]:
    """Return the x of each stored point of the trail, in metres."""
    return {x for _, x, _ in phone.run("return JSON.parse(sessionStorage.getItem('kurt2rt.trail')).points;")}


def test_important_sentences_are_never_cut(a_lesson: Lesson) -> None:
    a_lesson.begin(prepare)
    phone = a_lesson.phone
    long = "the second guard braked, because no tick ran for 0.1 s; look whether other programs keep this computer busy"
    a_lesson.show(cause="stopped", action=None, rla=None, stopped=ActiveStop(StopReason.GUARD, long))
    a_lesson.reads("#sentence", long[:40])
    for size in ((390, 844), (360, 600), (844, 390), (1280, 800)):
        phone.turn(size)
        cut = phone.run(CUT)
        assert cut == [], size
        assert long in phone.text("#sentence")
