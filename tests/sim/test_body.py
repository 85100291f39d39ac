"""What bodies weigh in the simulator against another computation: textbook formulas and trimesh."""

import xml.etree.ElementTree as ElementTree
from functools import cache

import numpy as np
import pytest
import trimesh

from rtphys.assets.asset_model import ArticulatedModel, Body
from rtphys.assets.material import density
from rtphys.assets.objects import catalogue
from rtphys.assets.pack import default_pack
from rtphys.core.poses import Pose
from rtphys.episode.generate import prepare
from rtphys.laws.lab import Lab
from rtphys.physics import readback
from rtphys.physics.handles import GRAVITY
from rtphys.sim.body import of_shapes
from rtphys.sim.engine import from_sapien, new_scene
from rtphys.spec.episode import EpisodeSpec
from rtphys.task import Ball, Box, Prop, load_task, task_names
from rtphys.task.props import Articulated, Mesh

pytestmark = pytest.mark.sim


def tensor(component) -> tuple[np.ndarray, np.ndarray]:
    """Inertia (3, 3) about the centre of mass in the body's axes, and that centre (3,)."""
    X = from_sapien(component.cmass_local_pose)
    return X.R @ np.diag(np.asarray(component.inertia, float)) @ X.R.T, X.p


def round_or_square(prop: Ball | Box, scale: float) -> np.ndarray:
    if isinstance(prop, Ball):
        r = prop.radius * scale
        mass = prop.density * 4 / 3 * np.pi * r**3
        return np.eye(3) * 2 / 5 * mass * r**2
    a, b, c = (scale * h for h in prop.half_size)
    mass = prop.density * 8 * a * b * c
    mass = mass if prop.mass_kg is None else prop.mass_kg * scale**3
    return mass / 3 * np.diag([b**2 + c**2, a**2 + c**2, a**2 + b**2])


@cache
def seen(category: str, index: int, link: str) -> tuple[float, np.ndarray]:
    """Mass and inertia of the visible meshes and their substances, by trimesh."""
    thing = catalogue()[category][index]()
    body: Body = thing.links[link] if isinstance(thing, ArticulatedModel) else thing.body
    parts = []
    for part in body.visual:
        mesh = trimesh.Trimesh(part.solid.vertices, part.solid.faces, process=False)
        mesh.density = density(part.material)
        parts.append(mesh.mass_properties)
    mass = sum(p.mass for p in parts)
    com = sum(p.mass * p.center_mass for p in parts) / mass
    inertia = np.zeros((3, 3))
    for p in parts:
        r = p.center_mass - com
        inertia += p.inertia + p.mass * ((r @ r) * np.eye(3) - np.outer(r, r))
    factor = 1.0 if body.mass_kg is None else body.mass_kg / mass
    return mass * factor, inertia * factor


def expected(prop: Prop, link: str, scale: float) -> np.ndarray:
    if isinstance(prop, Ball | Box):
        return round_or_square(prop, scale)
    assert isinstance(prop, Mesh | Articulated)
    mass, inertia = seen(prop.category, prop.model, link)
    factor = 1.0 if prop.mass_kg is None else prop.mass_kg / mass
    return inertia * factor * scale**5


@pytest.mark.parametrize("name", task_names())
@pytest.mark.parametrize("scale", [1.0, 0.85])
def test_every_body_turns_as_its_mesh_would(name: str, scale: float) -> None:
    recipe = EpisodeSpec(name, "clean", overrides={"object_scale": scale}).at(1)
    world = prepare(recipe, load_task(name), default_pack()).world
    for thing in world.objects.values():
        for body in thing.bodies:
            inertia, _ = tensor(body.component)
            law = expected(thing.prop, body.name.partition("/")[2], scale)
            assert np.abs(inertia - law).max() < 0.02 * np.trace(law), body.name
            moments = np.sort(body.nominal_inertia)
            np.testing.assert_allclose(moments, np.linalg.eigvalsh(law), rtol=0.02)


@pytest.mark.parametrize("scale", [1.0, 0.5])
def test_a_light_ball_rolls_down_as_the_textbook_says(scale: float) -> None:
    """5/7 g sin(tilt), whatever its size: SAPIEN's least inertia makes it a sixth of that."""
    tilt = np.deg2rad(2.0)
    ball = Ball(name="ball", radius=0.008, pose=Pose((0.15, -0.05, 0.0)))
    values = {"table_tilt": 2.0, "friction": 0.5, "object_scale": scale}
    world = Lab(default_pack()).world([ball], values)
    component = world.object("ball").bodies[0].component
    for _ in range(50):
        world.step()
    start, steps = np.array(component.linear_velocity, float), 100
    for _ in range(steps):
        world.step()
    gained = np.linalg.norm(np.array(component.linear_velocity, float) - start)
    law = 5 / 7 * GRAVITY * np.sin(tilt)
    assert gained / (steps * world.scene.timestep) == pytest.approx(law, rel=0.02)


def test_the_robots_links_weigh_what_their_file_states() -> None:
    world = Lab(default_pack()).world([], {})
    stated = {
        node.get("name"): node.find("inertial/inertia")
        for node in ElementTree.parse(world.robot.embodiment.urdf).getroot().iter("link")
    }
    for arm in world.robot.arms:
        for link in arm.links:
            node = stated[link.name]
            assert node is not None
            ixx, iyy, izz, ixy, ixz, iyz = (
                float(node.get(key, "nan")) for key in ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
            )
            law = np.linalg.eigvalsh([[ixx, ixy, ixz], [ixy, iyy, iyz], [ixz, iyz, izz]])
            np.testing.assert_allclose(np.sort(link.inertia), law, rtol=1e-3)


def test_turned_and_shifted_shapes_are_added_by_the_parallel_axis_theorem() -> None:
    """Against a sum over a million points."""
    import sapien

    builder = new_scene(False).create_actor_builder()
    turn = [0.9, 0.1, -0.3, 0.3]
    builder.add_box_collision(sapien.Pose([0.1, 0.02, 0], turn), (0.03, 0.02, 0.01), density=500)
    builder.add_sphere_collision(sapien.Pose([-0.05, 0, 0.04]), 0.02, density=2000)
    builder.add_cylinder_collision(sapien.Pose([0, 0.1, 0], turn), 0.01, 0.05, density=900)
    shapes = builder.build().components[0].collision_shapes  # pyright: ignore
    found = of_shapes(shapes)
    points, weights = np.vstack([sampled(s) for s in shapes]), []
    for shape in shapes:
        weights += [own_mass(shape) / len(sampled(shape))] * len(sampled(shape))
    w = np.array(weights)
    com = w @ points / w.sum()
    r = points - com
    second = np.einsum("n,ni,nj->ij", w, r, r)
    assert found.mass == pytest.approx(w.sum(), rel=1e-6)
    np.testing.assert_allclose(found.com, com, atol=1e-4)
    law = np.trace(second) * np.eye(3) - second
    assert np.abs(found.inertia - law).max() < 0.01 * np.trace(law)


def own_mass(shape) -> float:
    kind = type(shape).__name__
    if kind.endswith("Box"):
        return shape.density * 8 * float(np.prod(shape.half_size))
    if kind.endswith("Sphere"):
        return shape.density * 4 / 3 * np.pi * shape.radius**3
    return shape.density * 2 * np.pi * shape.radius**2 * shape.half_length


@cache
def lattice() -> np.ndarray:
    """Points (n, 3) of a grid that fills the cube from -1 to 1."""
    line = (np.arange(40) + 0.5) / 20 - 1
    return np.stack(np.meshgrid(line, line, line), axis=-1).reshape(-1, 3)


def sampled(shape) -> np.ndarray:
    """Points of a lattice inside a shape, in its body's frame [m]."""
    kind, u = type(shape).__name__, lattice()
    if kind.endswith("Box"):
        points = u * np.asarray(shape.half_size)
    elif kind.endswith("Sphere"):
        points = shape.radius * u[np.linalg.norm(u, axis=1) < 1]
    else:
        inside = u[np.linalg.norm(u[:, 1:], axis=1) < 1]
        points = inside * [shape.half_length, shape.radius, shape.radius]
    return from_sapien(shape.local_pose) @ points


def test_a_label_names_the_decay_of_a_balls_spin() -> None:
    instance = prepare(
        EpisodeSpec("dump_bin_bigbin", "clean").at(1), load_task("dump_bin_bigbin"), default_pack()
    )
    bodies = readback(instance.world)["bodies"]
    assert {name: body["spin_decay"] for name, body in bodies.items()} == {
        "bin": 0.0,
        **{f"ball{i}": 40.0 for i in range(5)},
    }


def test_only_what_is_light_takes_more_iterations() -> None:
    """It may become heavy again; a ball, which nobody holds, never does."""
    block = Box(name="block", pose=Pose((0, 0, 0.8)), half_size=(0.02, 0.02, 0.02))
    ball = Ball(name="ball", pose=Pose((0.2, 0, 0.8)), radius=0.02)
    world = Lab(default_pack()).world([block, ball], {})
    for kg in (0.0051, 0.0049, 0.0051):
        for body in world.bodies:
            body.set_mass(kg)
        found = [body.component.solver_position_iterations for body in world.bodies]
        assert found == ([40, 10] if kg < 0.005 else [10, 10])
