"""Readings of the sectors of a scan."""

import math

from kurt2rt.robots.turtlebot.settings import TurtlebotSettings
from kurt2rt.ros.laser_scan import SectorReduction
from kurt2rt.ros.messages import LaserScan


class Sectors:
    """Converter of laser scans to readings in counts, one for each sector of the sensor table."""

    def __init__(self, settings: TurtlebotSettings) -> None:
        headings = [sensor.heading_deg for sensor in settings.infrared.sensors]
        self._reduction = SectorReduction(headings, zero_is_far=settings.lidar.zero_is_far)
        self._infrared = settings.infrared

    def counts(self, scan: LaserScan) -> list[int | None]:
        """Return the reading of each sector in counts; None where no ray measured anything.

        Raises kurt2rt.ros.messages.InvalidMessageError.
        """
        nearest = self._reduction.distances_m(scan)
        return [None if math.isnan(each) else round(self._infrared.counts_at(each)) for each in nearest]
