"""What decides the feasible seeds of a task, as it is on this machine now."""

import hashlib

from rtphys.assets.pack import Pack
from rtphys.data.json_text import compact
from rtphys.data.schema import DATASET_VERSION
from rtphys.episode.assemble import versions
from rtphys.results.instances import Ground
from rtphys.setting.setting import Setting
from rtphys.task.spec import Task


def ground_of(task: Task, protocol: str, pack: Pack) -> Ground:
    """Of a task under a protocol.

    Raises:
        UnknownName: no such protocol.
    """
    recipe = Setting(task.name, protocol).at(0)
    domain, visual = recipe.setting.domain, recipe.setting.visual()
    look = hashlib.sha256(compact(visual.to_json())).hexdigest() if visual else ""
    found = {**versions(task), "dataset": DATASET_VERSION}
    return Ground(domain.name, domain.digest, look, pack.digest, found)
