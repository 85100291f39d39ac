"""How fast bodies move, by where they were 20 ms ago.

The solver's own velocities are no measure of rest: a pressed rocker had 18.7 rad/s and a can
30 mm/s while neither moved.
"""

from collections.abc import Iterable
from math import atan2, sqrt
from struct import unpack_from

from rtphys.sim.body import SimBody
from rtphys.sim.engine import TIME_STEP, PackedRows

STRIDE = 5  # [steps] between two poses that are kept: 20 ms
Row = tuple[int, tuple[float, float, float]]  # first byte in the packed poses, centre of mass [m]


class Past:
    """The packed poses of a world at its last two multiples of STRIDE."""

    def __init__(self) -> None:
        self._kept: list[tuple[int, bytes]] = []

    def keep(self, step: int, packed: bytes) -> None:
        """The poses of a multiple of STRIDE."""
        self._kept = [*self._kept[-1:], (step, packed)]

    def before(self, step: int) -> tuple[int, bytes] | None:
        """Step and poses of 20 to 36 ms before, or the earliest there are."""
        return self._kept[0] if self._kept and self._kept[0][0] < step else None


def rows_of(bodies: Iterable[SimBody], rows: PackedRows) -> list[Row]:
    """Where to find bodies in packed poses."""
    found = []
    for body in bodies:
        x, y, z = body.com.tolist()
        found.append((rows.bytes_of(body.component).start, (x, y, z)))
    return found


def speeds(row: Row, before: tuple[int, bytes], now: tuple[int, bytes]) -> tuple[float, float]:
    """Speed of a centre of mass [m/s] and of its body's turning [rad/s] between two instants."""
    start, com = row
    w, x, y, z, *p = unpack_from("<7f", before[1], start)
    v, i, j, k, *r = unpack_from("<7f", now[1], start)
    seconds = (now[0] - before[0]) * TIME_STEP
    a, b = _placed((w, x, y, z), p, com), _placed((v, i, j, k), r, com)
    way = sqrt((b[0] - a[0]) ** 2 + (b[1] - a[1]) ** 2 + (b[2] - a[2]) ** 2)
    # The vector part of the turn from the one orientation to the other, and its scalar part.
    e = w * i - v * x - (y * k - z * j)
    f = w * j - v * y - (z * i - x * k)
    g = w * k - v * z - (x * j - y * i)
    turn = 2 * atan2(sqrt(e * e + f * f + g * g), abs(w * v + x * i + y * j + z * k))
    return way / seconds, turn / seconds


def _placed(
    q: tuple[float, float, float, float], p: list[float], c: tuple[float, float, float]
) -> tuple[float, float, float]:
    """A point of a body's frame in the world."""
    w, x, y, z = q
    i, j, k = 2 * (y * c[2] - z * c[1]), 2 * (z * c[0] - x * c[2]), 2 * (x * c[1] - y * c[0])
    return (
        p[0] + c[0] + w * i + y * k - z * j,
        p[1] + c[1] + w * j + z * i - x * k,
        p[2] + c[2] + w * k + x * j - y * i,
    )
