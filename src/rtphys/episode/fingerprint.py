"""Certification fingerprint of a task, as it is on this machine now."""

import hashlib

from rtphys.assets.pack import Pack
from rtphys.data.json_text import compact
from rtphys.data.schema import DATASET_VERSION
from rtphys.episode.assemble import versions
from rtphys.results.instances import Fingerprint
from rtphys.setting.setting import Setting
from rtphys.task.spec import Task


def fingerprint_of(task: Task, protocol: str, pack: Pack) -> Fingerprint:
    """Fingerprint of a task under a protocol: rules, assets and versions that decide feasibility.

    Raises:
        UnknownName: no such protocol.
    """
    setting = Setting(task.name, protocol)
    domain, visual = setting.domain, setting.visual()
    look = hashlib.sha256(compact(visual.to_json())).hexdigest() if visual else ""
    found = {**versions(task), "dataset": DATASET_VERSION}
    return Fingerprint(domain.name, domain.digest, look, pack.digest, found)
