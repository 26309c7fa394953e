"""One colour for each action: what turns left is blue, what turns right is orange, ahead is green."""

from collections.abc import Iterable, Mapping

ASKS = "#c2304b"
"""Robot that stands and asks."""
STANDS = "#b9bfc6"
"""Robot that stands for another reason."""
TEACHER = "#7a4fa3"
"""Robot that a teacher drives."""
INK, PALE_INK, PAPER = "#20262d", "#68727d", "#ffffff"

_FAMILIES: tuple[tuple[str, tuple[str, ...]], ...] = (
    ("left", ("#9ecae9", "#5da5da", "#2b7bba", "#0b4f8a", "#06305a")),
    ("right", ("#fdd0a2", "#fdae6b", "#f58518", "#c85a0a", "#853a05")),
    ("forward", ("#3f9b5c", "#7cc48f", "#1f6b3a")),
    ("straight", ("#3f9b5c", "#7cc48f", "#1f6b3a")),
    ("ahead", ("#3f9b5c", "#7cc48f", "#1f6b3a")),
    ("back", ("#8c6d46", "#b79a73")),
)
_OTHERS = ("#4c9a9a", "#8f5f8f", "#a9a13c", "#5d7a8c", "#b06a7a", "#6a8f3c")
_SHARPNESS = ("bear", "curve", "sharp", "spin")


def colours_of(actions: Iterable[str]) -> Mapping[str, str]:
    """Return a colour for each action, darker for sharper turns, in any order of the actions.

    Colours repeat only if there are more actions than colours.
    """
    colours: dict[str, str] = {}
    for action in sorted(set(actions), key=lambda each: (_sharpness(each), each)):
        palette = next((row for word, row in _FAMILIES if word in action), _OTHERS)
        place = _sharpness(action)
        fitting = palette[place : place + 1] if place < len(_SHARPNESS) else ()
        taken = set(colours.values())
        free = (colour for colour in (*fitting, *palette, *_OTHERS) if colour not in taken)
        colours[action] = next(free, palette[len(colours) % len(palette)])
    return colours


def ink_on(colour: str) -> str:
    """Return black or white, whichever has more contrast on the colour."""
    red, green, blue = (int(colour[place : place + 2], 16) for place in (1, 3, 5))
    return PAPER if 0.30 * red + 0.59 * green + 0.11 * blue < 140 else INK


def _sharpness(action: str) -> int:
    return next((place for place, word in enumerate(_SHARPNESS) if action.startswith(word)), len(_SHARPNESS))
