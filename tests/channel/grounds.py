"""A world that notes what is done to it (simbridge.contracts.simulation.SimulatedWorld)."""

from simbridge.contracts.simulation import SimulatedPlace, SimulatedPost, Wall, WorldPlan
from simbridge.contracts.world_refusal import WorldRefusal, WorldRefusedError


class Yard:
    """A box and a post, and a robot at (1, 2)."""

    def __init__(self, *, start_blocked: bool = False) -> None:
        self.changes: list[tuple[object, ...]] = []
        self.start_blocked = start_blocked

    def place(self) -> SimulatedPlace:
        return SimulatedPlace(1.0, 2.0, 0.5, 0.25, 3, len(self.changes))

    def world(self) -> WorldPlan:
        outline = ((0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0), (0.0, 0.0))
        box = Wall("box", ((1.0, 1.0), (2.0, 1.0), (2.0, 2.0)))
        return WorldPlan(
            len(self.changes), "yard", (4.0, 4.0), outline, (box,), (SimulatedPost("post", 3.0, 3.0, 0.1),)
        )

    def move_wall(self, name: str, dx_m: float, dy_m: float) -> None:
        if name == "post":
            raise WorldRefusedError(WorldRefusal.WALL_ON_ROBOT, name=name)
        if name != "box":
            raise WorldRefusedError(WorldRefusal.NO_WALL, world="yard", name=name, known=("box", "post"))
        self.changes.append((name, dx_m, dy_m))

    def put_robot(self, x_m: float, y_m: float, heading_rad: float) -> None:
        if x_m > 4.0:
            raise WorldRefusedError(WorldRefusal.NO_ROOM)
        self.changes.append((x_m, y_m, heading_rad))

    def put_robot_back(self) -> None:
        if self.start_blocked:
            raise WorldRefusedError(WorldRefusal.START_BLOCKED)
        self.changes.append(("start",))
