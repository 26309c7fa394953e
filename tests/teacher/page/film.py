"""The README's moving picture: the robot asks, a thumb answers, it drives.

`python -m tests.teacher.page.film` teaches a simulated robot by the page on a phone and writes `docs/teach.webp`.
"""

import io
import tempfile
from pathlib import Path

from PIL import Image, ImageDraw

from hal.robot_settings import load_robot
from kurt2rt.core.task_settings import load_task
from tests.teacher.page.classroom import classroom
from tests.teacher.page.phone import PORTRAIT, Phone, phone

TARGET = Path("docs/teach.webp")
_WIDTH_PX = 300
_FRAME_S = 0.2
_THUMB_PX = 56
_QUALITY = 55
_ANSWERS = 5


class Film:
    """Frames of the page on a phone, with the thumb that touches it."""

    def __init__(self, phone: Phone) -> None:
        self._phone = phone
        self._thumb: tuple[float, float] | None = None
        self._pressed = False
        self.frames: list[Image.Image] = []

    def watch(self, seconds: float) -> None:
        """Let time pass."""
        for _ in range(round(seconds / _FRAME_S)):
            self._phone.pass_time(_FRAME_S)
            self._take()

    def pause(self, seconds: float) -> None:
        """Show the same for a while, to be read; no time passes for the robot."""
        for _ in range(round(seconds / _FRAME_S)):
            self._take()

    def press(self, selector: str, seconds: float) -> None:
        """Touch an element for so long."""
        self._thumb = self._phone.middle(selector)
        self.pause(0.6)
        self._pressed = True
        self._phone.finger_down(*self._thumb)
        self.watch(seconds)
        self._phone.finger_up()
        self._pressed = False
        self.watch(_FRAME_S)
        self._thumb = None

    def until_asked(self, most_s: float) -> None:
        """Let time pass until the robot asks, or so much time has passed."""
        for _ in range(round(most_s / _FRAME_S)):
            if self._phone.has("#why.asks"):
                return
            self.watch(_FRAME_S)

    def save(self, target: Path) -> None:
        """Write the moving picture."""
        first, *others = self.frames
        first.save(
            target,
            save_all=True,
            append_images=others,
            duration=round(1000 * _FRAME_S),
            loop=0,
            quality=_QUALITY,
            method=6,
        )

    def _take(self) -> None:
        image = Image.open(io.BytesIO(self._phone.driver.get_screenshot_as_png())).convert("RGB")
        if self._thumb is not None:
            scale = image.width / PORTRAIT[0]
            x, y = (scale * each for each in self._thumb)
            layer = Image.new("RGBA", image.size)
            reach = scale * _THUMB_PX / (3 if self._pressed else 2)
            box = (x - reach, y - reach, x + reach, y + reach)
            ImageDraw.Draw(layer).ellipse(box, fill=(30, 30, 40, 150 if self._pressed else 90))
            image = Image.alpha_composite(image.convert("RGBA"), layer).convert("RGB")
        height = round(image.height * _WIDTH_PX / image.width)
        self.frames.append(image.resize((_WIDTH_PX, height), Image.Resampling.LANCZOS))


def film(target: Path = TARGET) -> None:
    """Teach a robot in a folder of its own, and write the moving picture of its page."""
    policy = load_task("wall_following").policy.build(load_robot().infrared)
    with tempfile.TemporaryDirectory() as folder:
        shots = Path(folder) / "shots"
        with phone(shots) as opened, classroom(Path(folder), opened) as room:
            opened.open(room.address)
            opened.wait(lambda: opened.text("#sentence").startswith("I know nothing"), "the robot asks")
            opened.touch("#claim-button")
            opened.wait(lambda: not opened.shows("#claim"), "this page has control")
            taken = Film(opened)
            for _ in range(_ANSWERS):
                taken.until_asked(3.0)
                taken.pause(1.0)
                state = room.state()
                taken.press(f"[data-action={policy.choose(state.infrared_counts, state.behaviour)}]", 0.2)
            taken.watch(2.0)
        taken.save(target)


if __name__ == "__main__":
    film()
