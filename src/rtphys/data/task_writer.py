"""Numbers the attempts of one task in seed order and moves accepted episodes into place."""

import os
import shutil
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, cast

from pydantic import JsonValue

from rtphys.core.errors import BadFile
from rtphys.data import files, staging
from rtphys.data.attempts import ATTEMPT, Accepted, KeptFailure, Rejected, Totals, read_attempts
from rtphys.data.faults import CannotWrite, DatasetMismatch
from rtphys.data.files import FileFacts
from rtphys.data.json_text import plain, pretty
from rtphys.data.layout import EPISODE_FOLDERS, EpisodePaths, TaskDataset, episode_number
from rtphys.data.ledger import Ledger
from rtphys.data.manifest import LedgerState, TaskEntry, task_entry
from rtphys.data.staging import StagedEpisode
from rtphys.spec.collection import TaskHeader


@dataclass(frozen=True)
class Rejection:
    """An attempt that gave no episode. `reason` is counted, so it comes from a short list."""

    seed: int
    reason: str
    detail: str = ""  # deterministic text: it enters the ledger
    physics: Mapping[str, object] = field(
        default_factory=dict
    )  # value of what could act, for reports
    kept: StagedEpisode | None = None  # its files, which lie with the failures if there is room

    def row(self) -> Rejected:
        """Without its files. Raises `BadValue` where JSON cannot hold it."""
        physics = cast(dict[str, JsonValue], plain(self.physics, "physics"))
        return Rejected(seed=self.seed, reason=self.reason, detail=self.detail, physics=physics)


class TaskWriter:
    """Commits the outcomes of one task dataset, in the order of the seeds.

    Raises:
        DatasetMismatch: what is there was collected otherwise; each field that differs is named.
        BadFile: its ledger is damaged, or a file that it lists is missing.
    """

    def __init__(self, out: Path, header: TaskHeader) -> None:
        self.task_dataset, self.header = TaskDataset.of(out, header.spec), header
        self.wanted = header.spec.episodes
        self.totals = Totals()
        self._listed = 0  # attempts that the side files cover
        place = self.task_dataset
        place.check_links()
        self._ledger = Ledger(place.ledger, header, ATTEMPT, self.totals.add)
        leftovers = self._unlisted()
        if not self._ledger.lines:
            if leftovers:  # somebody else's
                raise DatasetMismatch(place.folder, ["its episodes have no ledger"])
            self._ledger.start()
            return
        shutil.rmtree(place.staging, ignore_errors=True)
        for path in leftovers:
            with files.refusals(path):
                path.unlink()
        for path in place.folder.rglob(f".*{files.TEMPORARY}"):
            if path.is_file():
                path.unlink()

    @property
    def episodes(self) -> int:
        """Number of committed episodes."""
        return self.totals.episodes

    @property
    def attempts(self) -> int:
        """Number of committed attempts."""
        return self.totals.attempts

    @property
    def next_seed(self) -> int:
        """The lowest seed whose outcome is not committed."""
        if self.header.spec.made_by == "collect":
            return self.header.spec.seed(self.attempts)
        return self.totals.last_seed + 1

    @property
    def done(self) -> bool:
        return self.episodes >= self.wanted

    @property
    def wants_failures(self) -> bool:
        """Whether another failed attempt is kept: of what is copied, all that was."""
        spec = self.header.spec
        return spec.made_by != "collect" or self.totals.failures < spec.max_failures

    def accepted(self, seed: int) -> bool:
        """Whether a committed attempt gave an episode; reads the ledger."""
        rows = read_attempts(self.task_dataset.ledger)
        return next(isinstance(row, Accepted) for row in rows if row.seed == seed)

    def staging(self, seed: int) -> Path:
        """Folder into which a worker stages the attempt of a seed."""
        return self.task_dataset.staged(seed)

    def discard(self, seed: int) -> None:
        """Removes what a worker has staged that is done, and that nobody will number."""
        shutil.rmtree(self.staging(seed), ignore_errors=True)

    def _unlisted(self) -> list[Path]:
        """Files of episodes and failures beyond those that the ledger lists: of a killed run.

        Raises:
            BadFile: one that it lists is missing. What files hold is for `verify`.
        """
        found: list[Path] = []
        for place, count in (
            (self.task_dataset, self.episodes),
            (self.task_dataset.failures, self.totals.failures),
        ):
            stems = [place.episode(number).stem for number in range(count)]
            ends = {path.parent: path.suffix for path in place.episode(0).all()}
            for folder in (place.folder / name for name in EPISODE_FOLDERS):
                there = set(os.listdir(folder)) if folder.is_dir() else set[str]()  # noqa: PTH208
                listed = {f"{stem}{ends[folder]}" for stem in stems if folder in ends}
                if missing := listed - there:
                    problem = "the ledger lists it, but it is missing"
                    raise BadFile(folder / min(missing), problem)
                for path in (folder / name for name in sorted(there - listed)):
                    number = episode_number(path)
                    if number is not None and number >= count:
                        found.append(path)
        return found

    def record(self, outcome: StagedEpisode | Rejection) -> None:
        """Commits the outcome of `next_seed`.

        Raises:
            ValueError: it is another seed's.
            CannotWrite: the folder still is a valid prefix; the same run can be resumed.
        """
        later = self.header.spec.made_by != "collect" and outcome.seed > self.next_seed
        if outcome.seed != self.next_seed and not later:
            raise ValueError(f"the outcome of seed {outcome.seed} is not that of {self.next_seed}")
        self.check_there()
        staged = outcome.kept if isinstance(outcome, Rejection) else outcome
        if not isinstance(outcome, Rejection):
            row = self._accepted(outcome)
        elif staged is None or not self.wants_failures:
            row = outcome.row()
        else:
            row = outcome.row().model_copy(update={"kept": self._kept(staged)})
        self._ledger.append(row, durable=row.on_disk is not None)
        self.totals.add(row)
        if staged is not None:
            shutil.rmtree(staged.folder, ignore_errors=True)

    def check_there(self) -> None:
        """Raises `CannotWrite`: somebody has removed the folder meanwhile."""
        self._ledger.check_there()

    def _accepted(self, staged: StagedEpisode) -> Accepted:
        meta, number = cast(Mapping[str, Any], staged.phys_meta), self.episodes
        labels = meta["attributes"].items()
        return Accepted(
            seed=staged.seed,
            episode=number,
            frames=staged.frames,
            scene_info=cast(dict[str, JsonValue], staged.scene_info),
            physics={key: label["value"] for key, label in labels if label["could_act"]},
            recovered=bool(meta["verdict"].get("recovered")),
            files=self._place(staged, self.task_dataset.episode(number), number),
        )

    def _kept(self, staged: StagedEpisode) -> KeptFailure:
        failure, number = cast(Any, staged.phys_meta["failure"]), self.totals.failures
        return KeptFailure(
            number=number,
            frames=staged.frames,
            event=failure["event"],
            time=failure["time"],
            scene_info=cast(dict[str, JsonValue], staged.scene_info),
            files=self._place(staged, self.task_dataset.failures.episode(number), number),
        )

    def _place(
        self, staged: StagedEpisode, paths: EpisodePaths, number: int
    ) -> dict[str, FileFacts]:
        """Moves an episode's files to where they belong: all, or none."""
        meta = pretty({**staged.phys_meta, "episode": number})
        written = files.write_synced(staged.folder / staging.PHYS_META, meta)
        facts = {**staged.files, staging.PHYS_META: written}
        targets = staging.targets(paths)
        try:
            for name, target in targets.items():
                files.make_folder(target.parent)
                files.move(staged.folder / name, target)
                files.sync_folder(target.parent)
        except CannotWrite:
            for target in targets.values():
                with suppress(OSError):
                    target.unlink()
            raise
        folder = self.task_dataset.folder
        return {
            target.relative_to(folder).as_posix(): facts[name] for name, target in targets.items()
        }

    def write_side_files(self, last: bool) -> None:
        """Once, when all is there, since it takes seconds; or when the run ends (`last`)."""
        if last or (self.done and self._listed < self.attempts):
            write_side_files(self.task_dataset, self.totals.failures)
            self._listed = self.attempts

    def entry(self) -> TaskEntry:
        """The task dataset's part of the manifest."""
        ledger = self._ledger
        state = LedgerState(ledger.lines, ledger.end, ledger.check)
        return task_entry(self.header, self.totals, self._listed, state)


def write_side_files(place: TaskDataset, failures: int) -> None:
    """Derives seed.txt, seeds.txt and scene_info.json from the ledger. Raises `CannotWrite`."""
    for one in (place, place.failures) if failures else (place,):
        seeds: list[int] = []
        files.replace_pieces(one.scene_info, scene_pieces(one, seeds))
        for path, end in ((one.seed_txt, " "), (one.seeds_txt, "\n")):
            files.replace_file(path, "".join(f"{seed}{end}" for seed in seeds).encode())


def scene_pieces(place: TaskDataset, seeds: list[int]) -> Iterator[bytes]:
    """scene_info.json piece by piece, since a million scenes do not fit into memory.

    Args:
        place: of the episodes, or of the failures that were kept.
        seeds: gets the seed of each.
    """
    for row in read_attempts(place.ledger):
        if row.on_disk is not None and isinstance(row, Rejected) is place.failed:
            one = {f"episode_{len(seeds)}": row.on_disk.scene_info}
            text = pretty(one, ascii_only=place.layout == "legacy", indent=4, sort=False)
            yield (b",\n" if seeds else b"{\n") + text[2:-3]
            seeds.append(row.seed)
    yield b"\n}\n" if seeds else b"{}\n"
