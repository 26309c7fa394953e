"""The README's picture of the teacher's page: five moments of a lesson on a phone, one next to the other.

`python -m tests.teacher.page.picture` teaches a simulated robot for a minute and writes `docs/page.png`.
"""

import tempfile
from pathlib import Path

from PIL import Image

from tests.teacher.page.classroom import Classroom, classroom
from tests.teacher.page.phone import Phone, phone

PICTURE = Path("docs/page.png")
_MARGIN_PX, _GROUND = 20, (200, 204, 222)
_WIDTH_PX = 390
_COLOURS = 256
_SLOW = """
const speed = document.querySelector('#lesson-speed');
speed.value = '60';
speed.dispatchEvent(new Event('input'));
"""
_LOOK_BACK = """
const time = document.querySelector('#rewind-time');
time.value = arguments[0];
time.dispatchEvent(new Event('input'));
"""


def picture(target: Path = PICTURE) -> None:
    """Teach a robot in a folder of its own, and write the picture of its page."""
    with tempfile.TemporaryDirectory() as folder:
        shots = Path(folder) / "shots"
        with phone(shots) as opened, classroom(Path(folder), opened) as room:
            _teach(opened, room)
        _join([shots / f"{number}.png" for number in range(1, 6)], target)


def _teach(phone: Phone, room: Classroom) -> None:
    phone.open(room.address)
    phone.wait(lambda: phone.text("#sentence").startswith("I know nothing"), "the robot asks")
    phone.touch("#claim-button")
    phone.wait(lambda: not phone.shows("#claim"), "this page has control")
    phone.run(_SLOW)
    slow = "return document.querySelector('#phase').textContent.includes('slow, 60 %');"
    phone.wait(lambda: phone.run(slow), "lessons are slow")
    phone.touch("[data-action=along_left_wall]")
    phone.wait(lambda: phone.text("#sentence").startswith("RLA 1 "), "it drives")
    phone.pass_time(0.5)
    phone.wait(lambda: phone.has("#why.asks.drawn"), "it asks")
    phone.show("1")
    phone.finger_down(*phone.middle("[data-action=spin_right]"))
    phone.wait(lambda: "lessons: 1" in phone.text("#said"), "the hold has taught")
    phone.pass_time(0.5)
    phone.show("2")
    phone.finger_up()
    phone.pass_time(3.0)
    phone.touch("#rewind")
    phone.touch("#rewind-go")
    phone.run(_LOOK_BACK, -2.4)
    phone.pass_time(0.5)
    phone.show("3")
    phone.touch("#rewind-close")
    phone.touch("#tab-drive")
    _drive(phone)
    phone.wait(lambda: phone.shows("#shown"), "the drive is shown")
    phone.pass_time(0.5)
    phone.show("4")
    with phone.in_the_dark():
        phone.touch("#tab-more")
        phone.pass_time(0.5)
        phone.show("5")


def _drive(phone: Phone) -> None:
    """Drive by hand: forward, a turn to the right, and forward."""
    x, y = phone.middle("#stick")
    phone.finger_down(x, y)
    for dx, dy, seconds in ((0, -70, 1.0), (70, 0, 0.8), (0, -70, 0.8)):
        phone.finger_to(x + dx, y + dy)
        phone.pass_time(seconds)
    phone.finger_up()


def _join(shots: list[Path], target: Path) -> None:
    images = [Image.open(each).convert("RGB") for each in shots]
    height = round(images[0].height * _WIDTH_PX / images[0].width)
    joined = Image.new("RGB", (len(images) * (_WIDTH_PX + _MARGIN_PX) + _MARGIN_PX, height + 2 * _MARGIN_PX), _GROUND)
    for place, image in enumerate(images):
        small = image.resize((_WIDTH_PX, height), Image.Resampling.LANCZOS)
        joined.paste(small, (_MARGIN_PX + place * (_WIDTH_PX + _MARGIN_PX), _MARGIN_PX))
    joined.quantize(_COLOURS).save(target, optimize=True)


if __name__ == "__main__":
    picture()
