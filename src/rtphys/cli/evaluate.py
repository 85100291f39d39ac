"""`rtphys evaluate`: a policy on certified instances."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from rtphys.campaign.workers.local import cores
from rtphys.cli.options import expand, split, taking
from rtphys.cli.progress import progress_bar
from rtphys.cli.stopping import resumable
from rtphys.core.errors import BadValue

if TYPE_CHECKING:
    from rtphys.results.summary import Summary
    from rtphys.studies.evaluate import EvaluatePlan, Table


@dataclass(frozen=True)
class EvaluateOptions:
    """One command line, not yet checked."""

    policy: Annotated[str, typer.Option(help="idle, random, expert, replay:DATASET, ...")]
    protocol: Annotated[str, typer.Option(help="clean, phys_random; several with commas.")]
    task: Annotated[list[str], typer.Option(help="Tasks or patterns, by commas or repeated.")]
    episodes: Annotated[
        int | None, typer.Option(help="Of each task and protocol; default: all that are certified.")
    ] = None
    out: Annotated[Path | None, typer.Option(help="Default: eval/<policy>.")] = None
    instances: Annotated[
        Path | None,
        typer.Option(help="Certified lists, or a dataset; default: those of rtphys."),
    ] = None
    texts: Annotated[
        str, typer.Option("--split", help="Of sentences and pictures: seen or unseen.")
    ] = "unseen"
    seed: Annotated[int, typer.Option(help="Of the policy's own chance.")] = 0
    options: Annotated[
        list[str] | None,
        typer.Option("--set", help="key=value for the policy; repeatable."),
    ] = None
    video: Annotated[bool, typer.Option(help="Also write each episode as an MP4.")] = False
    resume: Annotated[bool, typer.Option(help="Continue what is in the folder.")] = True
    accept_changes: Annotated[
        bool, typer.Option("--accept-changes", help="Run on lists certified on other ground.")
    ] = False
    timeout: Annotated[float, typer.Option(help="Seconds of an episode before it is lost.")] = 1800
    workers: Annotated[int | None, typer.Option(help="Processes; default one a core.")] = None

    def plan(self) -> "EvaluatePlan":
        """Raises UnknownName, BadValue: an option that cannot be; names the nearest match."""
        names = expand(self.task)
        from dataclasses import replace

        from rtphys.results.folder import short_name
        from rtphys.studies.evaluate import EvaluatePlan
        from rtphys.studies.evaluate.plan import WATCHDOG

        return EvaluatePlan(
            policy=self.policy,
            tasks=names,
            protocols=split(self.protocol),
            out=self.out or Path("eval") / short_name(self.policy),
            episodes=self.episodes,
            instances=self.instances,
            split=self.texts,
            seed=self.seed,
            options=dict(map(_pair, self.options or [])),
            video=self.video,
            resume=self.resume,
            accept_changes=self.accept_changes,
            workers=cores() if self.workers is None else self.workers,
            limits=replace(WATCHDOG, seconds=self.timeout),
        )


def _pair(text: str) -> tuple[str, str]:
    key, equals, value = text.partition("=")
    if not key or not equals:
        raise BadValue("--set", text, "write key=value")
    return key, value


@taking(EvaluateOptions)
def evaluate(options: EvaluateOptions) -> None:
    """Run a policy on certified instances and say how often it succeeds.

    Nothing is searched for: the instances are those of a list that `rtphys certify` has made. The
    same policy gives the same records, with any number of workers. It may be interrupted: the
    same command goes on where it stopped.
    """
    plan = options.plan()
    plan.check()
    summary = _run(plan)
    from rtphys.cli.evaluate_tables import show

    show(summary)
    typer.echo(f"records, summary and figures are in {plan.out}")


def _run(plan: "EvaluatePlan") -> "Summary":
    from rtphys.assets.pack import default_pack
    from rtphys.cli.assets import BuildBar
    from rtphys.studies.evaluate import evaluate

    with BuildBar() as building:
        pack = default_pack(building)
    with resumable(), progress_bar() as shown:

        def told(tables: "list[Table]") -> None:
            done = sum(len(table.records) for table in tables)
            wins = sum(table.successes for table in tables)
            shown(done, sum(len(table.seeds) for table in tables), f"{wins} of {done} succeed")

        return evaluate(plan, pack, told)
