"""One HTML page about an evaluation: rates, what breaks the policy, its failures and videos."""

import base64
from collections.abc import Iterable, Sequence
from html import escape
from importlib.resources import files
from pathlib import Path
from urllib.parse import quote

import numpy as np

from rtphys.core.errors import counted
from rtphys.data.files import read, replace_file
from rtphys.results.evaluation import EpisodeRecord, Results, video_file
from rtphys.results.statistics import Rate
from rtphys.results.summary import summarise


def write_evaluation_report(results: Results) -> Path:
    """Writes `report.html` into a result folder, and returns its path. Links videos that are there.

    Raises `BadFile`, `CannotWrite`.
    """
    summary = summarise(results.records, results.lists)
    rates = [
        (row.protocol, row.task, _rate(row.counts.of_feasible), _rate(row.counts.of_tried),
         ", ".join(f"{name} {count}" for name, count in row.reasons.items()))
        for row in summary.tasks
    ]  # fmt: skip
    breaks = [
        (protocol, ", ".join([effect.key, *effect.same]), f"{effect.curve.low:.3g} to "
         f"{effect.curve.high:.3g} {effect.unit}", f"{effect.curve.slope:+.2f}",
         f"{effect.p_holm:.2g}")
        for protocol, effects in summary.breaks.items()
        for effect in effects
    ]  # fmt: skip
    parts = [
        f"<h1>{escape(results.policy)}</h1><p class=soft>{escape(results.robot)}</p>",
        _table(("protocol", "task", "success of benchmark instances", "of all seeds tried",
                "failures"), rates),
        "<h2>Which physics breaks the policy</h2>",
        _table(("protocol", "attribute", "range", "log-odds of success from lowest to highest",
                "p (Holm)"), breaks),
        *(
            f'<figure><img alt="{escape(path.stem)}" src="data:image/png;base64,'
            f'{base64.b64encode(read(path)).decode()}"></figure>'
            for path in sorted(results.path.glob("attributes_*.png"))
        ),
        "<h2>Failures</h2>",
        *(_failures(results, key) for key in results.records),
    ]  # fmt: skip
    style = (files("rtphys.report") / "page.html").read_text(encoding="utf-8")
    style = style.partition("<style>")[2].partition("</style>")[0]
    head = f"<!doctype html><meta charset=utf-8><title>rtphys evaluation</title><style>{style}"
    page = f"{head}figure img {{ max-width: 100%; }}</style><main>{''.join(parts)}</main>"
    replace_file(out := results.path / "report.html", page.encode())
    return out


def _failures(results: Results, key: tuple[str, str]) -> str:
    """Every failure of a task under a protocol: what was drawn, why, and its video if there is."""
    records = results.records[key]
    unusual = _unusual(records)
    boxes: list[str] = []
    for one in (record for record in records if not record.success):
        physics = "".join(
            f"<dt>{escape(name)}</dt><dd>{_number(one.physics[name])}</dd>"
            for name in sorted(unusual, key=lambda name: -abs(unusual[name].get(one.seed, 0.0)))
            if name in one.physics and name not in one.inert
        )
        video = video_file(results.path, *key, one.seed)
        where = quote(video.relative_to(results.path).as_posix())
        shown = f'<video controls preload=none src="{where}"></video>' if video.is_file() else ""
        why = escape(f"{one.reason}: {one.detail.strip()[-200:]}".removesuffix(": "))
        what = f"<h3>seed {one.seed}, {counted(one.steps, 'actions')}, {one.time:.1f} s</h3>"
        boxes.append(f"<div class=box>{what}{shown}<p>{why}</p><dl>{physics}</dl></div>")
    name = escape(f"{key[1]}, {key[0]}: {len(boxes)} of {len(records)}")
    return f"<h3>{name}</h3><div class=grid>{''.join(boxes)}</div>"


def _unusual(records: Sequence[EpisodeRecord]) -> dict[str, dict[int, float]]:
    """Attribute that varies -> seed -> how many standard deviations it lies from the mean."""
    found: dict[str, dict[int, float]] = {}
    for name in sorted({name for one in records for name in one.physics}):
        values = {one.seed: one.physics.get(name) for one in records}
        numbers = {s: float(v) for s, v in values.items() if isinstance(v, int | float)}
        x = np.array([*numbers.values()])
        if len(x) and np.ptp(x) > 0:
            found[name] = dict(zip(numbers, (x - x.mean()) / x.std(), strict=True))
    return found


def _number(value: object) -> str:
    return f"{value:.4g}" if isinstance(value, int | float) else escape(str(value))


def _rate(rate: Rate | None) -> str:
    if rate is None or rate.value is None:
        return "-"
    low, high = rate.interval
    ends = f"[{100 * low:.0f}, {100 * high:.0f}]"
    return f"{100 * rate.value:.1f} % {ends} {rate.successes}/{rate.trials}"


def _table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    def line(kind: str, cells: Sequence[str]) -> str:
        return f"<tr>{''.join(f'<{kind}>{escape(cell)}</{kind}>' for cell in cells)}</tr>"

    return f"<table>{line('th', heads)}{''.join(line('td', row) for row in rows)}</table>"
