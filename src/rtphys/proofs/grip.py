"""Pulls a gripped block out of the fingers: its acceleration tells what friction takes away."""

import numpy as np

from rtphys.proofs.lab import Lab, floating, record, slope
from rtphys.proofs.proof import Company, number
from rtphys.sim.engine import from_sapien
from rtphys.task.props import Box

HALF = 0.02  # [m] thickness between the fingers
LONG = 0.03  # [m] along the pull: stays between the pads while it is pulled
CLOSE, PULL = 250, 15  # [steps] until the grip is steady; pulling


def finger_friction(lab: Lab, values: Company) -> float:
    """Coefficient between finger pad and block [1].

    A block floats between the left fingers, which close on it. It is then pulled along the
    gripper's z (across approach and closing) by F: m a = F - 2 mu N. Two pulls of different
    strength would give the same mu; one strong enough to slip at any mu is used.
    """
    empty = lab.world([], values)  # kept alive: its robot dies with it
    tcp = empty.robot.left.tcp()
    block = Box(name="block", pose=tcp, half_size=(LONG, HALF, LONG), resting=False)
    world = lab.world([block], values)
    body, arm = floating(world, "block"), world.robot.left
    arm.grip(0.0)
    for _ in range(CLOSE):
        world.step()
    normal = _squeeze(world)
    along = from_sapien(arm.ee_link.entity_pose).R[:, 2]
    mass, mu = body.mass, number(values["friction"])
    force = 2 * mu * normal + mass * 2.0  # [N] leaves 2 m/s² if the label is true
    push = (force * along).tolist()
    t, v = record(
        world,
        PULL,
        lambda: body.component.linear_velocity @ along,
        lambda: body.component.add_force_torque(push, [0, 0, 0]),
    )
    return (force - mass * slope(t, v)) / (2 * normal)


def _squeeze(world) -> float:
    """Force [N] of one finger on the block: what its servo exerts at rest."""
    effort = world.robot.effort()
    return float(np.abs(effort[world.robot.left.finger_index]).mean())
