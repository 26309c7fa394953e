"""Lines of the school robot: what one end writes the other one reads, and damage is only counted."""

from hypothesis import given
from hypothesis import strategies as st

from hal.byte_port import MemoryPort
from kurt2rt.robots.school.lines import Lines, encode

NUMBER = st.integers(-9_999_999_999, 9_999_999_999)


def test_encode_is_the_line_of_the_documentation() -> None:
    assert encode("drive", 17, 80, -80) == b"drive 17 80 -80*D5CC\n"


@given(st.from_regex(r"[a-z]{1,8}", fullmatch=True), st.lists(NUMBER, min_size=1, max_size=12), st.integers(1, 20))
def test_lines_in_any_pieces_are_read_as_written(word: str, numbers: list[int], piece: int) -> None:
    port, far_end = MemoryPort.pair()
    lines, line = Lines(port), encode(word, *numbers)
    got = []
    for begin in range(0, len(line), piece):
        far_end.write(line[begin : begin + piece])
        got += lines.read()
    assert got == [(word, tuple(numbers))]
    assert lines.junk == 0


@given(st.data())
def test_line_with_one_damaged_byte_is_junk(data: st.DataObject) -> None:
    line = bytearray(encode("sense", 3, 20, 1, -1, -1, 0, 0, 812, 40, 0, 0, 0))
    place = data.draw(st.integers(0, len(line) - 2))
    line[place] = data.draw(st.integers(0, 255).filter(lambda byte: byte not in (line[place], ord("\n"))))
    port, far_end = MemoryPort.pair()
    lines = Lines(port)
    far_end.write(bytes(line))
    assert lines.read() == []
    assert lines.junk == 1


def test_lines_after_noise_are_read_again() -> None:
    port, far_end = MemoryPort.pair()
    lines = Lines(port)
    far_end.write(bytes(range(256)) * 4)
    lines.read()
    far_end.write(b"\n" + encode("brake", 1))
    assert lines.read() == [("brake", (1,))]
    assert lines.junk > 0
