"""The laboratory of the law tests: a World with a few simple props and chosen physics."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.spatial import Delaunay, QhullError

from rtphys.assets.embodiment import DEFAULT
from rtphys.assets.pack import Pack
from rtphys.core.poses import Array, Pose
from rtphys.physics.attribute import attributes
from rtphys.physics.domain import AUXILIARY
from rtphys.physics.enforce import enforce
from rtphys.physics.handles import Blueprint
from rtphys.physics.pair import of_two
from rtphys.physics.reach import MARK
from rtphys.physics.values import Physics, Value
from rtphys.sim.body import SimBody
from rtphys.sim.engine import TIME_STEP, from_sapien
from rtphys.sim.world import World, WorldPlan
from rtphys.task.props import PINE, Box, Prop

NONE = [0.0, 0.0, 0.0]  # no force, or no torque


@dataclass(frozen=True)
class Lab:
    """Builds worlds whose physics is nominal except for a few values.

    Args:
        pack: the asset pack with the robot and the articulated objects.
        visuals: whether there is a renderer, for experiments with pictures.
        embodiment: the robot.
        elsewhere: attribute -> value of all that is no prop; each prop has its own then, which the
            experiment sets for all.
    """

    pack: Pack
    visuals: bool = False
    embodiment: str = DEFAULT
    elsewhere: Mapping[str, Value] = field(default_factory=dict[str, Value])

    def physics(self, values: Mapping[str, Value], props: Sequence[Prop] = ()) -> Physics:
        """Nominal physics except for `values`."""
        nominal: dict[str, Value] = {key: a.nominal for key, a in attributes().items()}
        nominal |= dict.fromkeys(AUXILIARY) | dict(values)
        for key, value in self.elsewhere.items():
            nominal |= {f"{key}{MARK}{prop.name}": nominal[key] for prop in props}
            nominal[key] = value
        return Physics(nominal, values.keys() & attributes().keys())

    def between(self, key: str, label: float) -> float:
        """Coefficient of two props that have this label."""
        elsewhere = self.elsewhere.get(key, label)
        assert isinstance(elsewhere, int | float)
        return of_two(label, label, min(label, elsewhere))

    def world(self, props: Sequence[Prop], values: Mapping[str, Value], steps: int = 0) -> World:
        """A world whose physics is nominal except for `values`, after some steps."""
        physics, blueprint = self.physics(values, props), Blueprint()
        enforce(blueprint, physics)
        robot, visuals = self.embodiment, self.visuals
        plan = WorldPlan(self.pack, tuple(props), blueprint, embodiment=robot, visuals=visuals)
        world = World(plan)
        enforce(world, physics)
        wait(world, steps)
        return world


def wait(world: World, steps: int) -> None:
    """Let a world run."""
    for _ in range(steps):
        world.step()


def launch(body: SimBody, velocity: Sequence[float]) -> None:
    """Give a rigid body a velocity (3,) [m/s]."""
    rigid = body.component
    rigid.set_linear_velocity(list(velocity))  # pyright: ignore[reportAttributeAccessIssue]


def hold(component: Any, still: bool) -> None:  # SAPIEN's type of it lacks the method
    """Fix a rigid body where it is, or let it go."""
    component.set_locked_motion_axes([still] * 6)


INNER = 0.9  # of the face on which a body stands: what pushes harder tips it


def bears(face: Array, loads: Array) -> bool:
    """Whether points (n, 2) where loads act lie within the face (m, 2) on which a body stands."""
    middle = face.mean(axis=0)
    try:
        inner = Delaunay(middle + INNER * (face - middle))
    except (QhullError, ValueError):  # a point or a line
        return False
    return bool((inner.find_simplex(loads) >= 0).all())


def floating(world: World, name: str) -> SimBody:
    """The body of this name, with its gravity switched off: only the experiment moves it."""
    body = next(b for b in world.bodies if b.name == name)
    body.component.set_disable_gravity(True)
    return body


def record(
    world: World, steps: int, read: Callable[[], object], push: Callable[[], object] | None = None
) -> tuple[Array, Array]:
    """Times (n,) [s] and readings (n, ...) after each of `steps` steps; `push` runs before each."""
    readings = []
    for _ in range(steps):
        if push is not None:
            push()
        world.step()
        readings.append(np.array(read(), float))
    return np.arange(1, steps + 1, dtype=float) * TIME_STEP, np.array(readings)


def time_constants(q: Array, target: Array) -> Array:
    """Time constants (n,) [s] of servos from their positions (t, n), at rest first, and targets.

    d dq/dt = k lag - (inertia) d²q/dt², and a servo stands still before and, nearly, after: so
    d / k is the lag summed over time, over the way gone, whatever inertia a heavy arm adds.
    """
    lag = target - q
    area = (lag.sum(axis=0) - (lag[0] + lag[-1]) / 2) * TIME_STEP
    return area / (q[-1] - q[0])


def slope(t: Array, y: Array) -> float:
    """Slope of `y` (n,) over `t` (n,) by least squares."""
    return float(np.polyfit(t, y, 1)[0])


def pose_of(body: SimBody) -> Pose:
    """World pose of a body's frame, now."""
    return from_sapien(body.component.entity_pose)


def block(
    half: tuple[float, float, float], at: tuple[float, float, float], name: str = "block"
) -> Box:
    """A block floating in the air at a point of the world [m]."""
    return Box(name=name, pose=Pose(at), half_size=half, resting=False, on_table=False)


HALF = (0.03, 0.04, 0.05)  # [m] of the test block


def block_mass(scale: float = 1.0) -> float:
    """Mass [kg] of the test block: density times volume."""
    return float(PINE * 8 * np.prod(HALF) * scale**3)


def block_inertia(scale: float = 1.0) -> Array:
    """Principal moments (3,) [kg m²] of the test block: m (b² + c²) / 3 with half sizes b, c."""
    a, b, c = scale * np.array(HALF)
    return block_mass(scale) / 3 * np.array([b**2 + c**2, a**2 + c**2, a**2 + b**2])


def pushed_block(
    lab: Lab, values: Mapping[str, Value], steps: int, push: Callable[[SimBody], object]
) -> Array:
    """Accelerations (6,) [m/s²], [rad/s²] of the test block, floating, pushed at every step."""
    world = lab.world([block(HALF, (0, 0, 2))], values)
    body = floating(world, "block")
    c = body.component
    t, v = record(
        world, steps, lambda: [*c.linear_velocity, *c.angular_velocity], lambda: push(body)
    )
    return np.polyfit(t, v, 1)[0]


def puck(x: float = 0.15) -> Box:
    """A flat plate on the table, which slides but cannot tip over."""
    return Box(name="puck", pose=Pose((x, -0.05, 0)), half_size=(0.05, 0.05, 0.01))
