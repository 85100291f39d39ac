"""Labels of instances as a dataset would hold them, for the tests of the audit."""

from dataclasses import asdict
from pathlib import Path

from rtphys.assets.pack import Pack
from rtphys.data.schema import PhysMeta
from rtphys.episode.assemble import label
from rtphys.episode.audit import Audit, audit_episode
from rtphys.episode.generate import Instance
from rtphys.sim.strain import Strain
from rtphys.spec.stored import stored as as_stored

PATH = Path("phys_meta/episode_0.json")


def stored(instance: Instance, **changed: object) -> PhysMeta:
    """The label that an episode of this instance would have."""
    camera = instance.world.head_camera.pose
    where = {"position": camera.p.tolist(), "quaternion_wxyz": camera.q.tolist()}
    raw = {
        **label(instance),
        "episode": 0,
        "cameras": {"head_camera": where},
        "verdict": {"accepted": True, "strain": asdict(Strain())},
        "recipe": as_stored(instance.recipe),
        "versions": {},
        "state_hash": "",
    }
    raw["attributes"] = {
        key: {**told, "value": list(v) if isinstance(v := told["value"], tuple) else v}
        for key, told in raw["attributes"].items()
    }
    draws = raw["draws"].items()
    raw["draws"] = {key: list(v) if isinstance(v, tuple) else v for key, v in draws}
    return PhysMeta.model_validate({**raw, **changed})


def audited(instance: Instance, pack: Pack, **changed: object) -> Audit:
    """The audit of the label that an episode of this instance would have."""
    return audit_episode(stored(instance, **changed), instance.physics, pack, PATH)


def unsound(audit: Audit) -> list[object]:
    return [*audit.problems, *audit.deviations]
