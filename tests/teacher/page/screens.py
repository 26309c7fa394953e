"""Rules of each screen: readable in the sun, touched with a thumb, STOP and GO in reach."""

from collections.abc import Callable

from tests.teacher.page.phone import LANDSCAPE, LAPTOP, PORTRAIT, SMALL, Phone

LEAST_TARGET_PX = 48
LEAST_CONTRAST = 7.0
TEXTS = """
const luminance = (rgb) => {
  const [r, g, b] = rgb.map((v) => (v /= 255) <= 0.03928 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4);
  return 0.2126 * r + 0.7152 * g + 0.0722 * b;
};
const colour = (text) => text.match(/[\\d.]+/g).map(Number);
const ground = (e) => {
  for (; e; e = e.parentElement) {
    const [r, g, b, a] = colour(getComputedStyle(e).backgroundColor);
    if (a === undefined || a > 0.8) return [r, g, b];
  }
  return [255, 255, 255];
};
return [...document.querySelectorAll("body *")]
  .filter((e) => e.checkVisibility() && [...e.childNodes].some((n) => n.nodeType === 3 && n.data.trim()))
  .map((e) => {
    const [a, b] = [luminance(colour(getComputedStyle(e).color).slice(0, 3)), luminance(ground(e))];
    return [e.textContent.trim().slice(0, 30), (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05)];
  });
"""
_TARGETS = """
return [...document.querySelectorAll("button, input, #stick")].filter((e) => e.checkVisibility()).map((e) => {
  const b = e.getBoundingClientRect();
  return [e.id || e.textContent.trim(), b.width, b.height, b.left, b.right];
});
"""


def on_each_screen(phone: Phone, name: str, also: Callable[[], None] = lambda: None) -> None:
    """Assert on each screen what `assert_handy` and `also` do; `name` is that of its pictures."""
    for size in (SMALL, LANDSCAPE, LAPTOP, PORTRAIT):
        phone.turn(size, touch=size != LAPTOP)
        phone.show(f"{name}-{size[0]}x{size[1]}")
        assert_handy(phone, size, name)
        also()


def assert_handy(phone: Phone, size: tuple[int, int], what: str) -> None:
    """Assert contrast, target size and position of the visible elements."""
    for text, contrast in phone.run(TEXTS):
        assert contrast >= LEAST_CONTRAST, f"{what}: {text!r} has a contrast of {contrast:.1f}"
    for name, width, height, left, right in phone.run(_TARGETS):
        assert width >= LEAST_TARGET_PX, f"{what}: {name} is {width} wide"
        assert height >= LEAST_TARGET_PX, f"{what}: {name} is {height} high"
        assert left >= 0, f"{what}: {name} begins at {left}"
        assert right <= size[0], f"{what}: {name} ends at {right}"
    for name in ("#stop", "#go", "#rewind-says" if phone.shows("#rewind-bar") else "#sentence", "#link"):
        box = phone.run("return document.querySelector(arguments[0]).getBoundingClientRect().toJSON();", name)
        assert 0 <= box["top"] < box["bottom"] <= size[1], f"{what}: {name} lies at {box}"
        assert 0 <= box["left"] < box["right"] <= size[0], f"{what}: {name} lies at {box}"
