"""The docs' picture of the teacher's page: a phone on which the robot asks, and what each part of the page is.

`python -m tests.teacher.page.picture` teaches a simulated robot a little and writes `docs/page.png`.
"""

import tempfile
from pathlib import Path

from matplotlib.font_manager import findfont
from PIL import Image, ImageDraw, ImageFont

from tests.teacher.page.classroom import Classroom, classroom
from tests.teacher.page.phone import PORTRAIT, Phone, phone

PICTURE = Path("docs/page.png")
_PARTS = {
    "#bar": "the task, and how much\nit drove by itself",
    "#stage": "the room, the robot, its\nsensors; red where it asked",
    "#why": "it asks: what it sees now,\nand what the nearest rule saw",
    "#actions": "touch what is right here;\ndashed: what that rule does",
    "#rewards": "wrong and right, undo,\nlook back",
    "#stop-bar": "STOP is always there;\nGO lets it drive on",
}
_SIZE, _PHONE_PX, _MARGIN_PX, _TEXT_PX = (1280, 1360), 610, 20, 34
_GROUND, _LINE, _INK = (233, 237, 242), (120, 132, 148), (16, 21, 28)
_MIDDLE = "const box = document.querySelector(arguments[0]).getBoundingClientRect(); return box.y + box.height / 2;"


def picture(target: Path = PICTURE) -> None:
    """Teach a robot in a folder of its own, and write the picture of its page."""
    with tempfile.TemporaryDirectory() as folder:
        shots = Path(folder) / "shots"
        with phone(shots) as opened, classroom(Path(folder), opened) as room:
            _teach(opened, room)
            middles = [float(opened.run(_MIDDLE, part)) for part in _PARTS]
        _annotated(shots / "asks.png", middles).quantize(256, Image.Quantize.FASTOCTREE).save(target, optimize=True)


def _teach(phone: Phone, room: Classroom) -> None:
    phone.open(room.address)
    phone.wait(lambda: phone.text("#sentence").startswith("I know nothing"), "the robot asks")
    phone.touch("#claim-button")
    phone.wait(lambda: not phone.shows("#claim"), "this page has control")
    for action in ("along_left_wall", "spin_right"):
        phone.touch(f"[data-action={action}]")
        phone.wait(lambda: phone.text("#sentence").startswith("RLA "), "it drives")
        phone.pass_time(0.5)
        phone.wait(lambda: phone.has("#why.asks.drawn"), "it asks")
    phone.pass_time(0.5)
    phone.show("asks")


def _annotated(shot: Path, middles: list[float]) -> Image.Image:
    """Return the phone with a text for each part, at its height in pixels of the page."""
    image = Image.open(shot).convert("RGB")
    scale = _PHONE_PX / PORTRAIT[0]
    small = image.resize((_PHONE_PX, round(scale * PORTRAIT[1])), Image.Resampling.LANCZOS)
    drawn = Image.new("RGB", _SIZE, _GROUND)
    drawn.paste(small, (_MARGIN_PX, _MARGIN_PX))
    draw, right = ImageDraw.Draw(drawn), _MARGIN_PX + _PHONE_PX
    for text, middle in zip(_PARTS.values(), middles, strict=True):
        y = _MARGIN_PX + scale * middle
        draw.line((right, y, right + 2 * _MARGIN_PX, y), fill=_LINE, width=3)
        font = ImageFont.truetype(findfont("DejaVu Sans"), _TEXT_PX)
        draw.multiline_text((right + 2.5 * _MARGIN_PX, y), text, fill=_INK, font=font, anchor="lm", spacing=8)
    return drawn


if __name__ == "__main__":
    picture()
