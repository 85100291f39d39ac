"""Hits every surface with tiny balls, and lowers balls onto the table: friction, bounce, plane."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice, product
from typing import Any

import numpy as np

from rtphys.core.poses import Array, Pose
from rtphys.laws.audit.specimen import Finding, Measurement, Specimen, Unmeasured
from rtphys.sim.body import AnyBody
from rtphys.sim.engine import to_sapien
from rtphys.sim.room import TOP_HALF
from rtphys.sim.world import World
from rtphys.task.props import TABLE_TOP

RADIUS, MASS = 0.002, 1e-8  # [m], [kg]: nothing that it hits yields
GAP = 1e-5  # [m] before the first step, in which it hits
INWARD, ALONG = 1.0, 4.0  # [m/s] fast enough to bounce, and to slide throughout the impact
MAX_THROWS = 24  # tries to hit a flat spot of a surface
AIMS = [(0.0, 0.0, 0.0), *product((-0.4, 0.4), repeat=3)]  # shares of half the box around a body
ALOOF = 1 << 30  # bit of the third word of collision groups: bodies that share one never collide
SAME = 1 - 1e-6  # cosine between normals of one face
REACH = 0.05  # [m] from which rays are cast, outside the box around a body
FREE = [False, False, False, True, True, True]  # the ball may move but not turn


Ball = Any  # a dynamic component of SAPIEN's; its type lacks half of its methods


@dataclass(frozen=True, eq=False)
class Spot:
    """A point of a surface, world frame."""

    body: AnyBody
    p: Array  # (3,) [m]
    normal: Array  # (3,) outward


def hit_surfaces(specimen: Specimen) -> list[Finding]:
    """Friction and restitution of every surface that the label is about."""
    world = specimen.world
    targets: dict[str, AnyBody] = {"table": world.room.table.components[0]}  # pyright: ignore[reportAssignmentType]
    for thing in world.scene_objects.values():
        for link, component in thing.links.items():
            if component.collision_shapes:
                name = f"{thing.name}/{link}" if len(thing.links) > 1 else thing.name
                targets[name] = component
    for arm in world.robot.arms:
        targets |= {f"{arm.side}_gripper/{link.name}": link for link in arm.finger_links}
    findings, shared = list[Finding](), {surface.name for surface in world.table_and_pads}
    for name in (surface.name for surface in world.surfaces):
        thrown = (_throw(world, spot) for spot in islice(_spots(world, targets[name]), MAX_THROWS))
        outcome = next((outcome for outcome in thrown if outcome is not None), None)
        for i, key in enumerate(("friction", "restitution")):
            own, smallest = specimen.key(key, name), specimen.smallest(key)
            if outcome is None:
                findings.append(Unmeasured(own, name, "no flat spot of it could be hit"))
            elif name in shared:
                findings.append(Measurement(own, name, smallest, outcome[i]))
            else:  # a label is that of the pair with table or pad
                pair = (outcome[i] + smallest) / 2
                findings.append(Measurement(own, name, specimen.number(own), pair))
    return findings


def _spots(world: World, body: AnyBody) -> Iterator[Spot]:
    """Where rays towards a body's middle, and beside it, meet its outside."""
    low, high = np.array(body.compute_global_aabb_tight(), float)
    middle, half = (low + high) / 2, (high - low) / 2
    far = float(np.linalg.norm(half)) + REACH
    directions = [d for axis in np.eye(3) for d in (axis, -axis)]
    directions += [np.array(d) / np.sqrt(3) for d in product((-1, 1), repeat=3)]
    for aim, direction in product(AIMS, directions):
        spot = cast(world, middle + np.array(aim) * half + far * direction, -direction)
        if spot is not None and spot.body is body:
            yield spot


def cast(world: World, start: Array, direction: Array) -> Spot | None:
    """What a ray from a point along a unit vector meets first, within 3 m."""
    hit = world.solver.raycast(start.tolist(), direction.tolist(), 3.0)
    if hit is None:
        return None
    body: Any = hit.component
    return Spot(body, np.array(hit.position, float), np.array(hit.normal, float))


def ball_at(world: World, spot: Spot, gap: float, velocity: Array) -> Ball:
    """A tiny ball without friction, bounce or weight, `gap` [m] before a spot, under way."""
    builder = world.scene.create_actor_builder()
    slippery = world.scene.create_physical_material(0.0, 0.0, 0.0)
    builder.add_sphere_collision(radius=RADIUS, material=slippery)
    builder.initial_pose = to_sapien(Pose(spot.p + (RADIUS + gap) * spot.normal))
    component: Ball = builder.build("ball").components[0]
    component.set_disable_gravity(True)
    component.set_mass(MASS)
    component.set_linear_damping(0.0)
    component.set_locked_motion_axes(FREE)
    for shape in component.collision_shapes:
        words = shape.get_collision_groups()
        words[2] |= ALOOF
        shape.set_collision_groups(words)
    component.set_linear_velocity(velocity.tolist())
    return component


def _throw(world: World, spot: Spot) -> tuple[float, float] | None:
    """(friction, restitution) that a ball feels at a spot; None where it hit anything else."""
    across = np.cross(spot.normal, [0.36, 0.48, 0.8])  # along no edge in particular
    if np.linalg.norm(across) < 0.1:
        across = np.cross(spot.normal, [0.8, -0.48, 0.36])
    before = ALONG * (across / np.linalg.norm(across)) - INWARD * spot.normal
    # One ball at a time. PhysX solves contacts by fours where it can, and there light bodies stick.
    ball = ball_at(world, spot, GAP, before)
    world.step()
    touched, normals = list[AnyBody](), list[Array]()
    for contact in world.scene.get_contacts():
        first, second = contact.bodies
        if ball in (first, second):
            touched.append(second if first is ball else first)
            normals += [np.array(point.normal, float) for point in contact.points]
    change = np.array(ball.linear_velocity, float) - before
    ball.entity.remove_from_scene()
    # It must have touched this body alone, and one face of it.
    alone = normals and all(body is spot.body for body in touched)
    if not alone or any(n @ normals[0] <= SAME for n in normals):
        return None
    normal = normals[0] * np.sign(change @ normals[0])
    gained, inward = float(change @ normal), -float(before @ normal)
    if inward < INWARD / 2 or gained < inward / 2:
        return None  # a graze, or a contact that was seen and not reached
    slowed = float(np.linalg.norm(change - gained * normal))
    return 2 * slowed / gained, 2 * (gained / inward - 1)


ABOVE = 0.5  # [m] over the nominal top, from where rays look for the table
DOWN = np.array([0.0, 0.0, -1.0])
START, SPEED, STEPS = 1e-3, 0.1, 20  # [m] above the table; [m/s] too slow to bounce; to touch it
PLACES = list(product((-0.9, -0.6, -0.3, 0.0, 0.3, 0.6, 0.9), (-0.9, -0.45, 0.0, 0.45, 0.9)))
ENOUGH = 6  # places that the robot leaves free


def survey(specimen: Specimen) -> list[Finding]:
    """Height, tilt and lean of the table."""
    world = specimen.world
    plan, table = world.plan.table, world.room.table.components[0]
    shift = np.array([*plan.shift, 0.0])
    high = np.array([0.0, 0.0, TABLE_TOP + ABOVE])
    starts = [shift + np.array([x, y, 0.0]) * TOP_HALF + high for x, y in PLACES]
    hits = [cast(world, start, DOWN) for start in starts]
    spots = [spot for spot in hits if spot is not None and spot.body is table]
    if len(spots) < ENOUGH:
        why = "the robot leaves too little of it free"
        return [Unmeasured(key, "table", why) for key in ("table_height", "table_tilt")]
    # Straight down, from a point straight above.
    above = [Spot(spot.body, spot.p, -DOWN) for spot in spots]
    balls = [ball_at(world, spot, START, SPEED * DOWN) for spot in above]
    for _ in range(STEPS):
        world.step()
    centres = np.array([ball.entity_pose.p for ball in balls], float)
    for ball in balls:
        ball.entity.remove_from_scene()
    # z = a + b x + c y through the balls' centres.
    a, b, c = np.linalg.lstsq(np.c_[np.ones(len(balls)), centres[:, :2]], centres[:, 2])[0]
    normal = np.array([-b, -c, 1.0]) / np.linalg.norm([b, c, 1.0])
    # The plane of the centres lies a radius above the table, along the normal.
    top = a + b * shift[0] + c * shift[1] - RADIUS / normal[2]
    height = float(top - TABLE_TOP + plan.drop)
    lean = (float(np.degrees(np.arctan2(n, normal[2]))) for n in (normal[1], normal[0]))
    tilt = specimen.number("table_tilt")
    return [
        Measurement("table_height", "table", specimen.number("table_height"), height),
        Measurement("table_tilt", "table", (tilt, 0.0), tuple(lean)),
    ]
