"""World of the fault drill: a corridor with a long straight wall on the left."""

from simbridge.world_settings import StartPoseSettings, WorldSettings

_LENGTH_M, _WIDTH_M = 10.0, 4.0
_WALL_AT_M = 0.22
_HALF_WIDTH_M = 0.165

CORRIDOR_WORLD = WorldSettings(
    name="hall",
    size_m=(_LENGTH_M, _WIDTH_M),
    infrared_rays=1,
    outline=((0.0, 0.0), (_LENGTH_M, 0.0), (_LENGTH_M, _WIDTH_M), (0.0, _WIDTH_M), (0.0, 0.0)),
    start_poses=(StartPoseSettings(x_m=1.5, y_m=_WIDTH_M - _HALF_WIDTH_M - _WALL_AT_M, heading_deg=0.0),),
)
"""Corridor with one constant situation, so that a standstill is due to the fault."""
