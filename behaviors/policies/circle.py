"""Counter-clockwise circle round an object smaller than the gap between two sensors."""

from behaviors.policies.distances import LEFT_FRONT_TO_BACK, Distance, Distances
from behaviors.policies.policy import PolicySettings, ReferencePolicy
from hal.robot_settings import InfraredSettings


class CircleSettings(PolicySettings):
    """Thresholds; distances from the sensors' faces."""

    near_m: Distance
    """Distance to the object on the left below which the robot drives straight on."""
    far_m: Distance
    """Distance above which the robot narrows the curve earlier."""
    lost_m: Distance
    """Distance on the left above which an object counts as not seen."""

    def build(self, infrared: InfraredSettings) -> ReferencePolicy:
        """Return a policy with these thresholds. Raises KeyError if the robot lacks one of its sensors."""
        return Circle(self, infrared)


class Circle:
    """Curve left round an object on the left, less while it is ahead of abeam; else spin left until it is there.

    Not for places with walls in range: the robot would follow a wall, and the policy ignores the front sensors.
    """

    def __init__(self, settings: CircleSettings, infrared: InfraredSettings) -> None:
        self._settings = settings
        self._left = Distances(infrared).of(*LEFT_FRONT_TO_BACK)

    def choose(self, infrared_counts: tuple[int, ...], behaviour: str) -> str:  # noqa: ARG002 - it knows only one
        """Return the name of the action for the counts of all sensors; `behaviour` is not used."""
        want = self._settings
        left = self._left(infrared_counts)
        nearest = min(left)
        if nearest >= want.lost_m:
            return "spin_left"
        if nearest < want.near_m:
            return "forward"
        ahead = left[:1] if nearest > want.far_m else left[:2]
        return "bear_left" if min(ahead) <= nearest else "curve_left"
