"""Measure at which push the pack's objects slide on the table, and write docs/results/slip.json.

`scripts/slip.py` takes some minutes. `scripts/tables.py` derives the table in docs/physics.md.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

import results
from rtphys.assets.pack import Pack, default_pack
from rtphys.core.poses import Array, Pose
from rtphys.laws.lab import Lab, bears, pose_of
from rtphys.physics.handles import GRAVITY
from rtphys.sim.body import SimBody
from rtphys.sim.engine import RATE, TIME_STEP
from rtphys.sim.feet import FLAT, has_feet
from rtphys.sim.room import TOP_HALF
from rtphys.sim.world import World
from rtphys.task.props import TABLE_TOP, Box, Mesh, Prop

LOW, HIGH, RATE_OF_PUSH = 0.7, 1.1, 0.2  # push [mu m g] where slip is looked for, its end; [1/s]
EASE = 0.5  # [s] in which the push grows to LOW: a blow would rock what is tall
AFTER = 0.1  # [s] from the slip until it is noticed
WINDOW = 5  # [steps] over which a speed is measured
REST = RATE // 2  # [steps] until the objects stand
GAP = 0.06  # [m] between two copies: they slide by less than half of that
CLEAR = 0.15  # [m] y of the copies' row: the hands at home are nearer to the robot


@dataclass(frozen=True)
class Slip:
    """What one pushed object did."""

    share: float  # push at which it slid [mu m g]; Coulomb says 1
    turned: float  # [deg] until the ramp's end; Coulomb says 0
    on_feet: bool


def slips(lab: Lab, prop: Prop, mu: float, offsets: Sequence[Array]) -> list[Slip | None]:
    """Push copies of one object along x at their centres of mass, which `offsets` (3,) [m] move.

    None stands for a copy that does not stand by itself, or that would tip before it slides.
    """
    alone = lab.world([prop.at(Pose((0, CLEAR, 0), prop.pose.q))], {"friction": mu})
    body = alone.bodies[0]
    # What topples would hit its neighbours, so only what stands is built.
    standing = [i for i, offset in enumerate(offsets) if _stands(_moved(body, offset), mu)]
    size = float(np.ptp((pose_of(body) @ body.hull)[:, :2], axis=0).max())
    pitch, room = size + GAP, 2 * TOP_HALF[0] - size - GAP
    row = 1 + int(room / pitch)
    found: list[Slip | None] = [None] * len(offsets)
    for start in range(0, len(standing), row):
        some = standing[start : start + row]
        copies = [
            replace(prop, name=f"copy{i}", pose=Pose((pitch * k - room / 2, CLEAR, 0), prop.pose.q))
            for k, i in enumerate(some)
        ]
        world = lab.world(copies, {"friction": mu})
        for i, copy in zip(some, world.bodies, strict=True):
            _moved(copy, offsets[i])
        for i, slip in zip(some, _pushed(world, mu), strict=True):
            found[i] = slip
    return found


def _moved(body: SimBody, offset: Array) -> SimBody:
    """The body, its centre of mass `offset` (3,) [m] (world axes) from where it belongs."""
    body.set_com(body.nominal_com + pose_of(body).R.T @ offset)
    return body


def _pushed(world: World, mu: float) -> list[Slip | None]:
    """What each body does; None for one that fell while they came to rest."""
    for _ in range(REST):
        world.step()
    tried = [i for i, body in enumerate(world.bodies) if _stands(body, mu)]
    before = [pose_of(body) for body in world.bodies]
    shares, slips = _ramp(world, tried, mu), list[Slip | None]()
    for i, (body, X) in enumerate(zip(world.bodies, before, strict=True)):
        turned = float(np.degrees(X.angle_to(pose_of(body))))
        slip = Slip(shares.get(i, HIGH), turned, has_feet(body.component))
        slips.append(slip if i in tried else None)
    return slips


def _ramp(world: World, tried: list[int], mu: float) -> dict[int, float]:
    """Body -> push [mu m g] at which it began to slide, found from its speed AFTER seconds.

    The speed is that of the positions: PhysX states some millimetres a second for what is tall and
    stands still.
    """
    fast = RATE_OF_PUSH * mu * GRAVITY * AFTER**2 / 2
    grow = np.arange(LOW, HIGH, RATE_OF_PUSH * TIME_STEP)
    pushes = [*np.linspace(0, LOW, int(EASE * RATE), endpoint=False), *grow]
    shares: dict[int, float] = {}
    last = dict.fromkeys(tried, 0.0)
    for step, share in enumerate(pushes):
        for i in tried:
            body = world.bodies[i]
            push = share * mu * body.mass * GRAVITY
            body.component.add_force_torque([push, 0.0, 0.0], [0.0, 0.0, 0.0])
        world.step()
        if step % WINDOW:
            continue
        for i in tried:
            x = float((pose_of(world.bodies[i]) @ world.bodies[i].com)[0])
            slid = (x - last[i]) / (WINDOW * TIME_STEP) > fast
            last[i] = x
            if share >= LOW and i not in shares and slid:
                shares[i] = share - RATE_OF_PUSH * (AFTER + WINDOW * TIME_STEP / 2)
    return shares


def _face(body: SimBody) -> Array:
    """Points (n, 2) of the face on which a body stands, world frame [m]."""
    points = pose_of(body) @ body.hull
    return points[points[:, 2] < points[:, 2].min() + FLAT][:, :2]


def _stands(body: SimBody, mu: float) -> bool:
    """Whether a body rests on a face within which its weight and the strongest push act."""
    com = pose_of(body) @ body.com
    ahead = np.array([HIGH * mu * (com[2] - TABLE_TOP), 0.0])
    return bears(_face(body), np.array([com[:2], com[:2] + ahead]))


UPRIGHT = Pose((0, 0, 0), (0.5**0.5, 0.5**0.5, 0, 0))
ASIDE = (0.005, 0.010, 0.015)  # [m]
AZIMUTHS = (0, 90, 180, 270)  # [deg] from the push
FRICTIONS = (0.1, 0.5)


def objects(pack: Pack) -> list[Prop]:
    """A block, a plate, and the first model of every rigid category, upright."""
    plain = Pose((0, 0, 0))
    boxes = {"block": (0.025, 0.025, 0.025), "plate": (0.05, 0.05, 0.01)}
    rigid = [name for name in pack.names if not pack.is_articulated(name)]
    return [
        *(Box(name=name, pose=plain, half_size=half) for name, half in boxes.items()),
        *(Mesh(name=n, pose=UPRIGHT, category=n, model=pack.indices(n)[0]) for n in rigid),
    ]


def offsets() -> dict[str, list[np.ndarray]]:
    """Offset in mm -> centres of mass (3,) [m] that far aside."""
    turns = np.radians(AZIMUTHS)
    directions = [np.array([np.cos(a), np.sin(a), 0.0]) for a in turns]
    return {"0": [np.zeros(3)]} | {f"{1000 * r:g}": [r * d for d in directions] for r in ASIDE}


def extremes(some: list[Slip]) -> list[float]:
    """Least and largest push of several."""
    shares = [round(float(slip.share), 3) for slip in some]
    return [min(shares), max(shares)]


def main() -> None:
    """Measure every object; an object that never stands is left out."""
    lab = Lab(default_pack())
    report: dict[str, dict[str, object]] = {}
    for prop in objects(lab.pack):
        found: dict[str, list[Slip]] = {}
        cases = [(aside, offset) for aside, some in offsets().items() for offset in some]
        for mu in FRICTIONS:
            measured = slips(lab, prop, mu, [offset for _, offset in cases])
            for (aside, _), slip in zip(cases, measured, strict=True):
                if slip is not None:
                    found.setdefault(aside, []).append(slip)
        if not found:
            continue
        everything = [slip for some in found.values() for slip in some]
        report[prop.name] = {
            "feet": all(slip.on_feet for slip in everything),
            "slip": {aside: extremes(some) for aside, some in found.items()},
            "turned_deg": round(max(slip.turned for slip in everything), 1),
            "cases": len(everything),
        }
        print(prop.name, report[prop.name], flush=True)
    results.save("slip", report)


if __name__ == "__main__":
    main()
