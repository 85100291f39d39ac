"""What `rtphys collect` can be told. A new option is a field here and a line in `plans`."""

from dataclasses import dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from rtphys.cli.options import domain_of, expand, split
from rtphys.core.errors import BadValue

if TYPE_CHECKING:
    from rtphys.studies.collect import CollectPlan


BESIDE_MANIFEST = ("manifest", "estimate", "out", "workers", "runner", "address", "shard")
BESIDE_MANIFEST += ("resume", "shader", "assets", "fallback")
OPTIONS = {"held": "--set", "texture_split": "--split"}  # those not named after their field


@dataclass(frozen=True)
class CollectOptions:
    """One command line, not yet checked."""

    task: Annotated[
        list[str] | None, typer.Option(help="Tasks or patterns, by commas or repeated.")
    ] = None
    manifest: Annotated[
        str, typer.Option(help="A file that says what to collect, or its name in a library.")
    ] = ""
    estimate: Annotated[
        bool, typer.Option("--estimate", help="Only say what it will take, after a short probe.")
    ] = False
    episodes: Annotated[int, typer.Option(help="How many, of each task.")] = 10
    seed: Annotated[int, typer.Option(help="The first seed; attempts go upward from it.")] = 0
    protocol: Annotated[str, typer.Option(help="What varies between episodes.")] = "clean"
    out: Annotated[Path, typer.Option(help="The dataset's folder.")] = Path("data")
    workers: Annotated[int | None, typer.Option(help="Processes; default one a core.")] = None
    runner: Annotated[str, typer.Option(help="local, or ray: on a Ray cluster.")] = "local"
    address: Annotated[
        str | None, typer.Option(help="Of the Ray cluster; `local` makes a private one.")
    ] = None
    cameras: Annotated[str, typer.Option(help="Of head, left, right, front.")] = "head,left,right"
    layout: Annotated[str, typer.Option(help="native or legacy.")] = "native"
    only: Annotated[str, typer.Option(help="Vary these attributes alone (comma-separated).")] = ""
    held: Annotated[
        list[str] | None,
        typer.Option("--set", help="key=value of an attribute; repeatable."),
    ] = None
    domain: Annotated[
        str, typer.Option(help="Draw from this domain (name or file), not from the task's own.")
    ] = ""
    sweep: Annotated[
        str, typer.Option(help="key=value,value: the same seeds under each of these.")
    ] = ""
    twin: Annotated[
        str | None,
        typer.Option(help="A second protocol: record each seed under both, keep only pairs."),
    ] = None
    texture_split: Annotated[
        str, typer.Option("--split", help="seen or unseen pictures on table and wall.")
    ] = "seen"
    recovery: Annotated[
        bool, typer.Option(help="Keep episodes in which a load was lost and taken again.")
    ] = True
    assets: Annotated[Path | None, typer.Option(help="An asset pack, such as RoboTwin's own.")] = (
        None
    )
    fallback: Annotated[
        str, typer.Option(help="`builtin`: it stands in for what --assets lacks.")
    ] = ""
    shard: Annotated[str, typer.Option(help="i/n: one part of n, for `rtphys merge` to join.")] = ""
    resume: Annotated[bool, typer.Option(help="Continue what is in the folder.")] = True
    shader: Annotated[str, typer.Option(help="slim, default, minimal or rt.")] = "slim"
    max_attempts: Annotated[
        int | None, typer.Option(help="Of each task, those of earlier runs included.")
    ] = None

    def plans(self) -> tuple["CollectPlan", ...]:
        """One run each.

        Raises:
            UnknownName, BadValue: an option that cannot be; names the nearest match.
        """
        # Names first: what is wrong should be refused before the simulator is loaded.
        if self.manifest:
            self._check_with_manifest()
        elif not self.task:
            told = "name at least one task, or a --manifest; `rtphys tasks` lists them"
            raise BadValue("--task", None, told)
        names = expand(self.task or [])
        from rtphys.physics.overrides import parse_overrides
        from rtphys.studies.collect import CollectPlan, dealt, find_collection, plans_of, swept

        plan = CollectPlan(
            tasks=names,
            episodes=self.episodes,
            out=self.out,
            first_seed=self.seed,
            protocol=self.protocol,
            only=split(self.only) or None,
            overrides=parse_overrides(self.held or []),
            ranges=domain_of(self.domain),
            cameras=split(self.cameras),
            layout=self.layout,
            split=self.texture_split,
            recovery=self.recovery,
            twin=self.twin,
            assets=self.assets,
            fallback=self.fallback,
            shader=self.shader,
            workers=self.workers,
            runner=self.runner,
            address=self.address,
            resume=self.resume,
            most_attempts=self.max_attempts,
        )
        if self.manifest:
            plans = plans_of(find_collection(self.manifest), plan)
        else:
            plans = swept(plan, self.sweep) if self.sweep else (plan,)
        return dealt(plans, self.shard) if self.shard else plans

    def _check_with_manifest(self) -> None:
        """Raises `BadValue`: what a manifest says cannot be said beside it."""
        for one in fields(self):
            value = getattr(self, one.name)
            if one.name not in BESIDE_MANIFEST and value != one.default:
                told = "the manifest says that; edit a copy of it, or leave out --manifest"
                raise BadValue(
                    OPTIONS.get(one.name, f"--{one.name.replace('_', '-')}"), value, told
                )
