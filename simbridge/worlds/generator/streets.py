"""Random street grids with varying widths and numbers of blocks, and squares instead of missing blocks."""

from itertools import accumulate, chain, product

from simbridge.worlds.generator.seeded_random import SeededRandom
from simbridge.worlds.geometry import Point
from simbridge.worlds.obstacle_settings import PolygonObstacleSettings
from simbridge.worlds.world_settings import StartPoseSettings, StreetSettings, WorldSettings

_NARROWEST_M, _WIDEST_M = 0.7, 1.1
"""Street widths. In narrower ones the robot cannot turn with 6 cm to spare; in wider ones it loses the corners."""

Block = tuple[int, int]
"""Column from the left, row from below."""


def streets(seed: int) -> WorldSettings:
    """Return the street grid of a seed: 3 to 5 streets per direction, including those at the border."""
    name = f"streets-{seed}"
    rng = SeededRandom(name)
    columns, rows = _Axis(2 + rng.integer(3), rng), _Axis(2 + rng.integer(3), rng)
    blocks = list(product(range(columns.blocks), range(rows.blocks)))
    # Corner blocks stay: without one, two streets at the border would vanish.
    inner = [block for block in blocks if 0 < block[0] < columns.blocks - 1 or 0 < block[1] < rows.blocks - 1]
    for _ in range(rng.integer(2 + len(inner) // 4) if inner else 0):
        inner.remove(missing := rng.choice(inner))
        blocks.remove(missing)
    width_m, height_m = columns.length_m, rows.length_m
    built = set(blocks)
    sections = [
        *_sections(built, columns, rows, upright=True),
        *_sections({(row, column) for column, row in built}, rows, columns, upright=False),
    ]
    return WorldSettings(
        name=name,
        size_m=(width_m, height_m),
        infrared_rays=1,
        outline=((0.0, 0.0), (width_m, 0.0), (width_m, height_m), (0.0, height_m), (0.0, 0.0)),
        polygon_obstacles=tuple(
            PolygonObstacleSettings(
                name=f"block-{column}{row}",
                corners=(
                    (columns.begin_m(column), rows.begin_m(row)),
                    (columns.end_m(column), rows.begin_m(row)),
                    (columns.end_m(column), rows.end_m(row)),
                    (columns.begin_m(column), rows.end_m(row)),
                ),
            )
            for column, row in blocks
        ),
        streets=_joined(sections),
        start_poses=tuple(_start(each, rng) for each in sections),
    )


class _Axis:
    """Widths along one axis: alternating streets and blocks, with streets at both ends."""

    def __init__(self, blocks: int, rng: SeededRandom) -> None:
        self.blocks = blocks
        self.widths_m = [rng.length_m(_NARROWEST_M, _WIDEST_M) for _ in range(blocks + 1)]
        """Widths of the streets."""
        block_widths_m = [rng.length_m(0.6, 1.3) for _ in range(blocks)]
        both = chain.from_iterable(zip(self.widths_m, [*block_widths_m, 0.0], strict=True))
        self._edges_m = [0.0, *(round(edge_m, 2) for edge_m in accumulate(both))]

    @property
    def length_m(self) -> float:
        return self._edges_m[-1]

    def begin_m(self, block: int) -> float:
        return self._edges_m[2 * block + 1]

    def end_m(self, block: int) -> float:
        return self._edges_m[2 * block + 2]

    def middle_m(self, street: int) -> float:
        return round((self._edges_m[2 * street] + self._edges_m[2 * street + 1]) / 2, 3)


def _sections(
    built: frozenset[Block] | set[Block], across: _Axis, along: _Axis, *, upright: bool
) -> list[StreetSettings]:
    """Return the street sections between junctions that have blocks on both sides."""

    def place(across_m: float, along_m: float) -> Point:
        return (across_m, along_m) if upright else (along_m, across_m)

    return [
        StreetSettings(
            from_m=place(across.middle_m(street), along.middle_m(k)),
            to_m=place(across.middle_m(street), along.middle_m(k + 1)),
            width_m=across.widths_m[street],
        )
        for street in range(across.blocks + 1)
        for k in range(along.blocks)
        if all((block, k) in built for block in (street - 1, street) if 0 <= block < across.blocks)
    ]


def _joined(sections: list[StreetSettings]) -> tuple[StreetSettings, ...]:
    """Return the sections merged to straight streets, so that streets meet at junctions only."""
    joined: list[StreetSettings] = []
    for each in sections:
        if joined and joined[-1].to_m == each.from_m and _is_upright(joined[-1]) == _is_upright(each):
            each = joined.pop().model_copy(update={"to_m": each.to_m})
        joined.append(each)
    return tuple(joined)


def _is_upright(street: StreetSettings) -> bool:
    return street.from_m[0] == street.to_m[0]


def _start(street: StreetSettings, rng: SeededRandom) -> StartPoseSettings:
    """Return a start pose halfway between two junctions, in one of both directions."""
    (ax, ay), (bx, by) = street.from_m, street.to_m
    heading_deg = rng.choice((90.0, -90.0)) if _is_upright(street) else rng.choice((0.0, 180.0))
    return StartPoseSettings(x_m=round((ax + bx) / 2, 3), y_m=round((ay + by) / 2, 3), heading_deg=heading_deg)
