"""Policies over sectors choose by headings, so they fit the school robot as well as KURT2."""

from typing import Any

import pytest

from behaviors.policies.sector_circle import SectorCircleSettings
from behaviors.policies.sector_fleeing import SectorFleeingSettings
from behaviors.policies.sector_wall_following import SectorWallFollowingSettings
from behaviors.policies.sectors import Sector
from config.settings import SettingsError
from hal.robot_settings import InfraredSettings, load_robot
from simbridge.contracts.simulation import WallSide

SCHOOL, KURT2 = load_robot("school").infrared, load_robot().infrared
AHEAD, LEFT, RIGHT = ((-25.0, 25.0), (30.0, 100.0), (-100.0, -30.0))


def sector(bounds: tuple[float, float]) -> Sector:
    return Sector(from_deg=bounds[0], to_deg=bounds[1])


def seen(infrared: InfraredSettings, **distances_m: float) -> tuple[int, ...]:
    """Return the counts of all sensors: nothing in view, except at the given distances by the heading's name."""
    bounds = {"front": AHEAD, "left": LEFT, "right": RIGHT}
    counts = [infrared.floor_counts] * len(infrared.sensors)
    for name, distance_m in distances_m.items():
        for place, sensor in enumerate(infrared.sensors):
            if sector(bounds[name]).covers(sensor.heading_deg):
                counts[place] = round(infrared.counts_at(distance_m))
    return tuple(counts)


def test_sector_without_a_sensor_names_the_headings() -> None:
    with pytest.raises(SettingsError, match=r"from 60 to 120 degrees.*-40, -20, 0, 20, 40, 180"):
        Sector(from_deg=60, to_deg=120).nearest(SCHOOL)


@pytest.mark.parametrize(("infrared", "unit_m"), [(SCHOOL, 0.01), (KURT2, 0.04)])
@pytest.mark.parametrize(
    ("distances", "action"),
    [
        ({}, "flee"),
        ({"front": 7}, "whirl_left"),
        ({"left": 4}, "whirl_left"),
        ({"left": 9}, "curve_right"),
        ({"right": 9}, "curve_left"),
        ({"right": 9, "left": 9.5}, "curve_left"),
    ],
)
def test_sector_fleeing_turns_away(
    infrared: InfraredSettings, unit_m: float, distances: dict[str, float], action: str
) -> None:
    numbers: dict[str, Any] = {"front_m": 8 * unit_m, "edge_m": 5 * unit_m, "wary_m": 10 * unit_m}
    sectors: dict[str, Any] = {"front": sector(AHEAD), "left": sector(LEFT), "right": sector(RIGHT)}
    policy = SectorFleeingSettings(kind="sector_fleeing", **sectors, **numbers).build(infrared)
    assert policy.choose(seen(infrared, **{each: d * unit_m for each, d in distances.items()}), "") == action


def wall_following(side: WallSide) -> SectorWallFollowingSettings:
    return SectorWallFollowingSettings(
        kind="sector_wall_following",
        side=side,
        front=sector(AHEAD),
        left=sector(LEFT),
        wanted_m=0.08,
        tolerance_m=0.01,
        front_m=0.06,
        lost_m=0.13,
    )


@pytest.mark.parametrize(
    ("distances", "action"),
    [
        ({}, "curve_left"),
        ({"front": 0.05, "left": 0.08}, "spin_right"),
        ({"left": 0.08}, "forward"),
        ({"left": 0.095}, "bear_left"),
        ({"left": 0.12}, "curve_left"),
        ({"left": 0.065}, "bear_right"),
        ({"left": 0.04}, "curve_right"),
    ],
)
def test_sector_wall_following_holds_the_distance(distances: dict[str, float], action: str) -> None:
    assert wall_following("left").build(SCHOOL).choose(seen(SCHOOL, **distances), "") == action
    on_the_right = {"right" if side == "left" else side: distance_m for side, distance_m in distances.items()}
    turned = action.replace("left", "RIGHT").replace("right", "left").lower()
    assert wall_following("right").build(SCHOOL).choose(seen(SCHOOL, **on_the_right), "") == turned


def test_sector_wall_following_needs_the_actions_of_its_side() -> None:
    assert "spin_right" in wall_following("left").required_actions
    assert "spin_left" in wall_following("right").required_actions
    assert "spin_right" not in wall_following("right").required_actions


@pytest.mark.parametrize(
    ("distances", "action"),
    [
        ({}, "sharp_left"),
        ({"left": 0.10}, "forward"),
        ({"left": 0.05}, "curve_right"),
        ({"left": 0.10, "front": 0.04}, "spin_right"),
    ],
)
def test_sector_circle_leads_back_to_the_post(distances: dict[str, float], action: str) -> None:
    policy = SectorCircleSettings(
        kind="sector_circle", front=sector(AHEAD), left=sector(LEFT), front_m=0.05, near_m=0.08, far_m=0.13
    ).build(SCHOOL)
    assert policy.choose(seen(SCHOOL, **distances), "") == action
