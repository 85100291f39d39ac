"""Small episodes without a simulator: everything is a function of (seed, frames)."""

from collections.abc import Iterator
from dataclasses import asdict, fields, replace

import numpy as np

from rtphys.core.seeds import stream
from rtphys.data.episode import CameraFrames, Episode, Frames, Images
from rtphys.physics import after, attributes, could_act, load_domain
from rtphys.physics.values import REDRAWS
from rtphys.sim.strain import Strain
from rtphys.spec.collection import CollectionSpec, Resolved, TaskHeader
from rtphys.spec.episode import EpisodeSpec
from rtphys.spec.recording import RecordingSpec
from rtphys.spec.stored import stored

CAMERAS = ("head_camera", "left_camera", "right_camera")
DOMAIN = load_domain("global")
HEIGHT, WIDTH = 48, 64


def poses(rng: np.random.Generator, frames: int) -> np.ndarray:
    """(T, 7) xyz + unit wxyz, a smooth line."""
    turn = rng.normal(size=4)
    start, step = rng.normal(size=3), rng.normal(size=3) / 100
    line = start + np.arange(frames)[:, None] * step
    return np.column_stack([line, np.tile(turn / np.linalg.norm(turn), (frames, 1))])


def camera(rng: np.random.Generator, frames: int) -> CameraFrames:
    """A camera that moves along x, its three matrices in agreement."""
    K = np.array([[60.0, 0, WIDTH / 2], [0, 60.0, HEIGHT / 2], [0, 0, 1]])
    gl = np.tile(np.eye(4), (frames, 1, 1))
    gl[:, :3, 3] = rng.normal(size=3)
    gl[:, 0, 3] += np.arange(frames) / 100
    extrinsic = np.linalg.inv(gl @ np.diag([1.0, -1, -1, 1]))[:, :3]
    return CameraFrames(np.tile(K, (frames, 1, 1)), extrinsic, gl)


def frames_of(seed: int, frames: int = 8, joints: tuple[int, int] = (6, 6)) -> Frames:
    """Args: joints: of the left and of the right arm."""
    rng = stream(seed, "synthetic")
    names = tuple(
        f"f{side}_joint{k}"
        for side, n in zip("lr", joints, strict=True)
        for k in range(1, n + 3)  # its fingers' too
    )
    n = len(names)
    return Frames(
        time=np.arange(frames) * 0.06,
        left_arm=rng.normal(size=(frames, joints[0])),
        right_arm=rng.normal(size=(frames, joints[1])),
        left_gripper=np.linspace(1, 0, frames),
        right_gripper=np.linspace(0, 1, frames),
        left_endpose=poses(rng, frames),
        right_endpose=poses(rng, frames),
        qpos=rng.normal(size=(frames, n)),
        qvel=rng.normal(size=(frames, n)),
        effort=rng.normal(size=(frames, n)),
        joint_names=names,
        object_poses={"bell": poses(rng, frames)},
        contacts={"bell": rng.random((frames, 2)) > 0.5},
        stage=np.arange(frames) * 2 // frames,
        stages=("reach", "press"),
        cameras={name: camera(rng, frames) for name in CAMERAS},
    )


def pictures(seed: int, frames: int = 8) -> Iterator[Images]:
    """Red left, green middle, blue right, and a square that moves."""
    shade = 200 + seed % 50
    for t in range(frames):
        picture = np.zeros((HEIGHT, WIDTH, 3), np.uint8)
        for channel in range(3):
            first = channel * WIDTH // 3
            picture[:, first : first + WIDTH // 3, channel] = shade
        picture[8:16, 2 * t : 2 * t + 8] = 255
        yield {name: picture.copy() for name in CAMERAS}


def phys_meta(seed: int) -> dict[str, object]:
    rules = EpisodeSpec("click_bell", "phys_random").rules
    physics = rules.draw(seed, inside=after({REDRAWS: seed % 3}))
    acts = could_act(physics, {"thing": ("bodies", "joints", "surfaces")})
    return {
        "seed": seed,
        "task": "click_bell",
        "protocol": "phys_random",
        "domain": {"name": DOMAIN.name, "digest": DOMAIN.digest},
        "attributes": {
            key: {
                "value": physics[key],
                "unit": known.unit,
                "varied": key in physics.varied,
                "source": rules.source(key, physics),
                "could_act": key in acts,
                "acted": None if key in acts else False,
                "tolerance": known.deviation(physics[key]),
                "scope": known.scope,
            }
            for key, known in attributes().items()
        },
        "draws": {key: physics[key] for key in physics if key not in attributes()},
        "readback": {"bodies": {"bell": {"mass": np.float32(0.25), "inertia": [1e-4] * 3}}},
        "cameras": {"head_camera": {"position": [0, 0.5, 1.2], "quaternion_wxyz": [1, 0, 0, 0]}},
        "verdict": {
            "accepted": True,
            "first_success_time": 2.5,
            "held": True,
            "strain": asdict(Strain(12.34, "fl_link6 and bell", 0.0, 0.56, "fl_joint2", 0.0)),
            "stages": ["press"],
        },
        "versions": {"rtphys": "0.1.0"},
        "state_hash": f"{seed:064x}",
    }


def episode(seed: int, frames: int = 8, spec: EpisodeSpec | None = None) -> Episode:
    spec = spec or header().spec.episode
    return Episode(
        recipe=stored(spec.at(seed)),
        frames=frames_of(seed, frames),
        phys_meta={**phys_meta(seed), "task": spec.task, "protocol": spec.protocol},
        instructions={"seen": ["ring the bell", "läute die Glocke"], "unseen": ["press it"]},
        scene_info={"info": {"{A}": "050_bell/base0", "{a}": "left"}},
        images=pictures(seed, frames),
    )


def header(layout: str = "native", **changes: object) -> TaskHeader:
    """Of a task dataset of click_bell under phys_random. `changes`: fields of any of its parts."""

    def own(kind: type) -> dict[str, object]:
        return {one.name: changes[one.name] for one in fields(kind) if one.name in changes}

    spec = CollectionSpec(
        EpisodeSpec(**{"task": "click_bell", "protocol": "phys_random", **own(EpisodeSpec)}),
        RecordingSpec(layout=layout, **own(RecordingSpec)),
    )
    resolved = Resolved(
        domain=DOMAIN.to_json(),
        visual=None,
        versions={"rtphys": "0.1.0", "sapien": "3.0.3"},
        assets={"pack": "builtin", "digest": "a" * 64},
    )
    spec, resolved = replace(spec, **own(CollectionSpec)), replace(resolved, **own(Resolved))
    return TaskHeader(spec, resolved)
