"""What to collect, and all that can be refused before any work is done."""

import math
import shutil
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path

from rtphys.assets.pack import FALLBACKS, STAMP, Pack
from rtphys.campaign.workers.pool import Limits
from rtphys.core.errors import (
    BadValue,
    Infeasible,
    MissingAsset,
    NoRenderer,
    RtphysError,
    UnknownName,
)
from rtphys.data.conditions import Conditions
from rtphys.data.layout import LAYOUTS, TaskDataset
from rtphys.doctor import PROBE, check_disk, check_renderer
from rtphys.episode.assemble import versions
from rtphys.physics.domain import Domain
from rtphys.physics.values import Value
from rtphys.setting.protocol import load_protocol, protocols
from rtphys.setting.recipe import SPLITS, Recipe, check_varies
from rtphys.sim.camera import SHORT, camera_specs
from rtphys.sim.renderer import SHADERS
from rtphys.studies.collect.shard import Shard
from rtphys.task.instructions import check_templates
from rtphys.task.props import Articulated, Mesh
from rtphys.task.spec import Task, load_task

CAMERAS = ("head", "left", "right")
EPISODE_BYTES = 2e6  # [bytes] a camera; measured: 9 kB a picture, 60 to 250 pictures
DRAWN = 20  # of a task that are searched for models that the pack may lack
RUNNERS = ("local", "ray")
BARREN = 200  # rejections in a row after which a task is given up
MOST_WORKERS = 1000  # processes of 0.5 GB; more is a slip of the finger


class NoRoom(RtphysError):
    """Less disk space than the episodes will need."""


@dataclass(frozen=True)
class CollectPlan:
    """One run of `collect`."""

    tasks: tuple[str, ...]
    episodes: int  # of each task
    out: Path
    first_seed: int = 0
    protocol: str = "clean"
    only: tuple[str, ...] | None = None
    overrides: Mapping[str, Value] = field(default_factory=dict)
    ranges: Domain | None = None  # drawn from instead of each task's own domain
    cameras: tuple[str, ...] = CAMERAS  # short or official names
    layout: str = "native"
    split: str = "seen"  # of the pictures on table and wall
    recovery: bool = True  # keep episodes in which a load was lost and taken again
    config: str | None = None  # name of the leaf; None: the protocol's
    twin: str | None = None  # protocol of the same seeds' second recording
    twin_of: str | None = None  # config of the leaf whose twin this plan describes
    assets: Path | None = None  # an asset pack; None: the one in use
    fallback: str = ""  # "builtin": it stands in for what `assets` lacks
    shader: str = "slim"
    workers: int | None = 1  # None: as many as there are CPUs
    runner: str = "local"
    address: str | None = None  # of a Ray cluster; None: the one at hand
    shard: Shard | None = None
    resume: bool = True
    most_attempts: int | None = None  # of each task, earlier runs included
    limits: Limits = field(default_factory=Limits)

    def recipe(self, task: str, seed: int) -> Recipe:
        return Recipe(
            task,
            seed,
            self.protocol,
            self.only,
            self.overrides,
            split=self.split,
            ranges=self.ranges,
            recovery=self.recovery,
        )

    @property
    def twin_plan(self) -> "CollectPlan | None":
        """The same under the twin's protocol; without physics nothing is held or picked."""
        if self.twin is None:
            return None
        own = self.config or self.protocol
        physics = load_protocol(self.twin).physics
        return replace(
            self,
            protocol=self.twin,
            only=self.only if physics else None,
            overrides=self.overrides if physics else {},
            ranges=self.ranges if physics else None,
            config=f"{own}.twin={self.twin}",
            twin=None,
            twin_of=own,
        )

    def recipes(self, task: str, seed: int) -> tuple[Recipe, ...]:
        """Of one seed: its own, and its twin's if there is one."""
        twin = self.twin_plan
        return tuple(side.recipe(task, seed) for side in (self, twin) if side is not None)

    @property
    def stride(self) -> tuple[int, int]:
        """First attempt and step."""
        return (0, 1) if self.shard is None else self.shard.stride

    @property
    def share(self) -> int:
        """Episodes to collect of each task: all, or a shard's part of them, rounded up."""
        return math.ceil(self.episodes / self.stride[1])

    def leaf_name(self, task: str) -> str:
        """The folder of a task's episodes, below `out`."""
        return TaskDataset(self.out, self.config or self.protocol, task, layout=self.layout).name

    def conditions(self, task: Task, pack: Pack) -> Conditions:
        """What makes two runs continue each other."""
        recipe = self.recipe(task.name, self.first_seed)
        domain = recipe.domain()
        specs = camera_specs(pack.embodiment(recipe.embodiment), self.cameras)
        builtin = (pack.root / STAMP).is_file()
        return Conditions(
            task=task.name,
            protocol=self.protocol,
            first_seed=self.first_seed,
            domain_name=domain.name,
            domain_digest=domain.digest,
            domain=domain.to_json(),
            cameras=tuple(spec.name for spec in specs),
            versions=versions(task),
            assets={"pack": "builtin" if builtin else pack.root.name, "digest": pack.digest},
            only=self.only,
            overrides=self.overrides,
            layout=self.layout,
            visual=None if (rules := recipe.visual()) is None else rules.to_json(),
            split=None if rules is None else recipe.split,
            recovery=None if self.recovery else False,
            config=self.config,
            twin=None if (twin := self.twin_plan) is None else twin.config,
            twin_of=self.twin_of,
            stride=self.stride if self.stride[1] > 1 else None,
        )

    def check(self) -> dict[str, Task]:
        """The tasks by name; refuses everything that cannot work, in less than a second or two.

        Raises:
            UnknownName, BadValue, BadFile: names the nearest match, or the place.
            NoRoom, NoRenderer: with the cure.
        """
        self._check_numbers()
        self._check_names()
        tasks = {name: load_task(name) for name in self.tasks}
        for task in tasks.values():
            self._check_physics(task)
            check_templates(task.sentences(), task.info, str(task.source))
        self._check_disk()
        finding = check_renderer((*PROBE, self.shader))
        if finding.status == "fail":
            cure = f"; cure: {finding.cure}" if finding.cure else ""
            raise NoRenderer(f"no pictures can be drawn: {finding.detail}{cure}")
        return tasks

    def check_assets(self, tasks: Mapping[str, Task], pack: Pack) -> None:
        """Every model of each task's first layouts is in the pack.

        Raises:
            MissingAsset, UnknownName, BadFile: from the pack.
        """
        for task in tasks.values():
            for seed in range(self.first_seed, self.first_seed + DRAWN):
                with suppress(Infeasible):
                    _check_models(task, seed, pack)

    def _check_numbers(self) -> None:
        if self.workers is not None and self.workers > MOST_WORKERS:
            raise BadValue("--workers", self.workers, f"at most {MOST_WORKERS}")
        least = {"episodes": 1, "workers": 1, "first_seed": 0, "most_attempts": 1}
        for key, bound in least.items():
            value = getattr(self, key)
            if value is not None and value < bound:
                raise BadValue(f"--{key.replace('_', '-')}", value, f"at least {bound}")
        if not self.tasks:
            raise BadValue("--task", None, "name at least one task; `rtphys tasks` lists them")

    def _check_names(self) -> None:
        if self.ranges is not None:
            check_varies(self.ranges, (self.protocol,))
        load_protocol(self.protocol)
        own, *twins = self.recipes("", 0)
        if own in twins:
            raise BadValue("--twin", self.twin, "it is the protocol itself; name another")
        if self.fallback and self.assets is None:
            raise BadValue("--fallback", self.fallback, "it needs --assets, the pack that lacks")
        named = {
            "texture split": ((self.split,), SPLITS),
            "fallback": ((self.fallback,), FALLBACKS),
            "layout": ((self.layout,), LAYOUTS),
            "shader": ((self.shader,), SHADERS),
            "runner": ((self.runner,), RUNNERS),
            "camera": (self.cameras, {**SHORT, **{v: v for v in SHORT.values()}}),
        }
        for kind, (names, known) in named.items():
            for name in names:
                if name not in known:
                    raise UnknownName(kind, name, SHORT if kind == "camera" else known)
        if self.address is not None and self.runner != "ray":
            raise BadValue("--address", self.address, "it belongs to `--runner ray`")
        official = [SHORT.get(name, name) for name in self.cameras]
        if "head_camera" not in official:
            raise BadValue("--cameras", ",".join(self.cameras), "head is needed, for the video")
        if len(set(official)) < len(official):
            raise BadValue("--cameras", ",".join(self.cameras), "name each camera once")

    def _check_physics(self, task: Task) -> None:
        domain = self.recipe(task.name, 0).domain()
        if set(self.only or ()) - self.overrides.keys() and not domain.rules:
            varying = ", ".join(row.name for row in protocols().values() if row.physics)
            told = f"protocol {self.protocol!r} varies no physics; use {varying}"
            raise BadValue("--only", ",".join(self.only or ()), told)
        domain.sample(0, self.only, self.overrides)

    def _check_disk(self) -> None:
        finding = check_disk("space for data", self.out)
        if finding.status == "fail":
            raise NoRoom(f"{self.out}: {finding.detail}; {finding.cure}")
        place = self.out.absolute()
        while not place.exists():
            place = place.parent
        episodes = self.episodes * len(self.tasks) * (2 if self.twin else 1)
        needed = episodes * len(self.cameras) * EPISODE_BYTES
        free = shutil.disk_usage(place).free
        if free < needed:
            told = f"about {needed / 1e9:.1f} GB are needed and {free / 1e9:.1f} GB are free"
            raise NoRoom(f"{self.out}: {told}; free some space, or ask for fewer episodes")


def _check_models(task: Task, seed: int, pack: Pack) -> None:
    for prop in task.props(seed):
        try:
            if isinstance(prop, Articulated):
                pack.articulation(prop.category, prop.model)
            elif isinstance(prop, Mesh):
                pack.model(prop.category, prop.model)
        except MissingAsset as error:
            raise MissingAsset(error.what, error.where, task.name) from error
