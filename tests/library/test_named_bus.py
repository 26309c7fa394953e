"""A simulated robot on a named bus: other programs hear its frames, and no real bus gets them."""

from pathlib import Path

import pytest

import kurt2rt
from hal.kurt2_settings import load_kurt2
from kurt2rt.library.named_bus import NoVcanError, require_bus


@pytest.mark.parametrize(
    ("name", "content", "error", "message"),
    [
        ("vcan7", {}, NoVcanError, "no such interface; sudo modprobe vcan"),
        ("vcan7", {"type": "280", "flags": "0xc0"}, NoVcanError, "is down; sudo ip link set vcan7 up"),
        ("vcan7", {"type": "1", "flags": "0xc1"}, kurt2rt.Error, "not of CAN"),
        ("vcan7", {"type": "280", "flags": "0xc1", "device": ""}, kurt2rt.Error, "not a virtual CAN interface"),
        ("can0", {"type": "280", "flags": "0xc1"}, kurt2rt.Error, "not a virtual CAN interface"),
        ("radio:mine", {}, kurt2rt.Error, "no such kind"),
    ],
)
def test_named_bus_wrong_one_is_refused(
    name: str, content: dict[str, str], error: type[kurt2rt.Error], message: str, tmp_path: Path
) -> None:
    for file, text in content.items():
        (tmp_path / name).mkdir(exist_ok=True)
        (tmp_path / name / file).write_text(text)
    with pytest.raises(error, match=message):
        require_bus(name, load_kurt2(), net=tmp_path)
