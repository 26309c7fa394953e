"""A circle, counter-clockwise, round an object that is smaller than the distance between two sensors."""

from behaviors.policies.distances import LEFT_FRONT_TO_BACK, Distance, Distances
from behaviors.policies.policy import PolicySettings, ReferencePolicy
from hal.robot_settings import InfraredSettings


class CircleSettings(PolicySettings):
    """What the teacher looks for; distances from the sensor's face."""

    near_m: Distance
    """An object on the left nearer than this makes the robot drive straight on."""
    far_m: Distance
    """Farther than this the object may only be ahead of abeam a little: the robot curves in sooner."""
    lost_m: Distance
    """What is farther on the left than this is not seen."""

    def build(self, infrared: InfraredSettings) -> ReferencePolicy:
        """The policy."""
        return Circle(self, infrared)


class Circle:
    """With the object on the left it curves, less while that is ahead of abeam.

    Whatever else it sees, or where it sees nothing, it turns on the spot until the object is on the left: one answer to
    all that looks different and asks for the same, and no way on which the object passes by on the wrong side. Not for
    where walls are in reach: it would follow one, and never looks ahead.
    """

    def __init__(self, settings: CircleSettings, infrared: InfraredSettings) -> None:
        self._settings = settings
        self._left = Distances(infrared).of(*LEFT_FRONT_TO_BACK)

    def choose(self, infrared_counts: tuple[int, ...], behaviour: str) -> str:  # noqa: ARG002 - it knows only one
        """Name of the action."""
        want = self._settings
        left = self._left(infrared_counts)
        nearest = min(left)
        if nearest >= want.lost_m:
            return "spin_left"
        if nearest < want.near_m:
            return "forward"
        ahead = left[:1] if nearest > want.far_m else left[:2]
        return "bear_left" if min(ahead) <= nearest else "curve_left"
