"""One HTML page about an evaluation: rates, what breaks the policy, its failures and videos."""

import base64
from collections.abc import Iterable, Sequence
from html import escape
from importlib.resources import files
from pathlib import Path
from urllib.parse import quote

from rtphys.core.errors import counted
from rtphys.data.files import replace_file
from rtphys.data.layout import REPORT
from rtphys.physics.attribute import attribute, is_attribute
from rtphys.report.figures import draw_breaks
from rtphys.results.breaks import TOGETHER, Break, drawn_together, without_evidence
from rtphys.results.evaluation import EpisodeRecord, Results, video_file
from rtphys.results.statistics import rate_text
from rtphys.results.summary import summarise

ORDER = (
    "The attributes of each failure are in the order of the table above, the smallest p of the "
    "protocol first; those that it does not have follow by name."
)


def write_evaluation_report(results: Results) -> Path:
    """Writes `report.html` into a result folder, and returns its path. Links videos that are there.

    Raises `BadFile`, `CannotWrite`.
    """
    known = {key: header.fingerprint for key, header in results.headers.items()}
    summary = summarise(results.records, results.lists, known)
    rates = [
        (row.protocol, row.task, *(rate_text(rate, bounds=True) for rate in
                                   (row.counts.of_feasible, row.counts.of_tried)),
         ", ".join(f"{name} {count}" for name, count in row.reasons.items()))
        for row in summary.tasks
    ]  # fmt: skip
    breaks = [
        (protocol, effect.names, effect.span, f"{effect.curve.slope:+.2f}", f"{effect.p_holm:.2g}")
        for protocol, effects in summary.breaks.items()
        for effect in effects
    ]  # fmt: skip
    shown = [effect for effects in summary.breaks.values() for effect in effects]
    actor = results.spec.short_actor
    unfinished = [
        f"{done} of {counted(wanted, 'episodes')} of {task}, {protocol}"
        for protocol, task in results.records
        for done, wanted in filter(None, [results.unfinished(protocol, task)])
    ]
    parts = [
        f"<h1>{escape(results.spec.actor)}</h1><p class=soft>{escape(results.robot)}</p>",
        _table(("protocol", "task", "success of " + ("benchmark instances" if summary.certified
                else "these seeds"), "of all seeds tried", "failures"), rates),
        f"<p>unfinished: {escape('; '.join(unfinished))}</p>" if unfinished else "",
        f"<p>{escape(summary.stale)}</p>" if summary.stale else "",
        "<h2>Which physics breaks the policy</h2>",
        _table(("protocol", "attribute", "range", "log-odds of success from lowest to highest",
                "p (Holm)"), breaks),
        *(f"<p class=soft>{escape(line)}</p>" for line in without_evidence(summary.breaks)),
        *(f"<p class=soft>drawn together: {escape(', '.join(keys))}; `rtphys sensitivity` "
          "of each tells them apart</p>" for keys in drawn_together(shown)),
        f"<p class=soft>{escape(TOGETHER)}</p>",
        *(
            f'<figure><img alt="attributes_{escape(protocol)}" src="data:image/png;base64,'
            f'{base64.b64encode(draw_breaks(effects, f"{actor} under {protocol}")).decode()}">'
            "</figure>"
            for protocol, effects in summary.breaks.items()
            if effects
        ),
        "<h2>Failures</h2>",
        f"<p class=soft>{ORDER}</p>",
        *(_failures(results, key, summary.breaks[key[0]]) for key in results.records),
    ]  # fmt: skip
    style = (files("rtphys.report") / "page.html").read_text(encoding="utf-8")
    style = style.partition("<style>")[2].partition("</style>")[0]
    head = f"<!doctype html><meta charset=utf-8><title>rtphys evaluation</title><style>{style}"
    page = f"{head}figure img {{ max-width: 100%; }}</style><main>{''.join(parts)}</main>"
    replace_file(out := results.path / REPORT, page.encode())
    return out


def _failures(results: Results, key: tuple[str, str], effects: Sequence[Break]) -> str:
    """Every failure of a task under a protocol: what was drawn, why, and its video if there is."""
    records = results.records[key]
    shown = _varied(records, effects)
    boxes: list[str] = []
    for one in (record for record in records if not record.success):
        physics = "".join(
            f"<dt>{escape(name)}</dt><dd>{_number(one.physics[name])}{_unit(name)}</dd>"
            for name in shown
            if name in one.physics and name not in one.inert
        )
        video = video_file(results.path, *key, one.seed, success=False)
        where = quote(video.relative_to(results.path).as_posix())
        player = f'<video controls preload=none src="{where}"></video>' if video.is_file() else ""
        why = escape(f"{one.reason}: {one.detail.strip()[-200:]}".removesuffix(": "))
        what = f"<h3>seed {one.seed}, {counted(one.steps, 'actions')}, {one.time:.1f} s</h3>"
        boxes.append(f"<div class=box>{what}{player}<p>{why}</p><dl>{physics}</dl></div>")
    name = escape(f"{key[1]}, {key[0]}: {len(boxes)} of {len(records)}")
    return f"<h3>{name}</h3><div class=grid>{''.join(boxes)}</div>"


def _varied(records: Sequence[EpisodeRecord], effects: Sequence[Break]) -> list[str]:
    """What is not always nominal: first those with an effect, by increasing p, others by name."""
    names = {
        name
        for one in records
        for name, value in one.physics.items()
        if is_attribute(name)
        and (tuple(value) if isinstance(value, list) else value) != attribute(name).nominal
    }
    first = [name for effect in effects for name in (effect.key, *effect.same)]
    order = [*first, *sorted(names.difference(first))]
    return [name for name in order if name in names]


def _number(value: object) -> str:
    """A number or a vector in few digits."""
    if isinstance(value, list | tuple):
        return ", ".join(map(_number, value))
    return f"{value:.4g}" if isinstance(value, int | float) else escape(str(value))


def _unit(name: str) -> str:
    """Behind a number; nothing for a plain one."""
    unit = attribute(name).unit
    return f" {escape(unit)}" if unit != "1" else ""


def _table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    def line(kind: str, cells: Sequence[str]) -> str:
        return f"<tr>{''.join(f'<{kind}>{escape(cell)}</{kind}>' for cell in cells)}</tr>"

    return f"<table>{line('th', heads)}{''.join(line('td', row) for row in rows)}</table>"
