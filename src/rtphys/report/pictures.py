"""An episode as still pictures: its cameras in a contact sheet, its joints in a plot."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from io import StringIO
from itertools import pairwise
from textwrap import fill

import cv2
import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from rtphys.assets.action_layout import SIDES
from rtphys.assets.embodiment import ALOHA_OPENING
from rtphys.data.dataset import Episode
from rtphys.data.episode import Floats, Frames

# ---- the contact sheet ---------------------------------------------------------------------------

COLUMNS = 8
GAP = 4  # [px]
CAPTION = 16  # [px] of the line above each picture
WHITE = 255


def contact_sheet(episode: Episode, columns: int = COLUMNS) -> NDArray[np.uint8]:
    """Picture (H, W, 3) RGB with one row per camera: `columns` frames, evenly spaced in time."""
    picked = np.linspace(0, len(episode) - 1, min(columns, len(episode))).round().astype(int)
    times = [f"{episode.frames.time[t]:.2f} s" for t in picked]
    rows = {c: [episode.image(c, int(t)) for t in picked] for c in episode.cameras}
    return captioned(rows, times)


def captioned(
    rows: Mapping[str, Sequence[NDArray[np.uint8]]], moments: Sequence[str]
) -> NDArray[np.uint8]:
    """One row per camera, one column per moment; above each picture the names of both."""
    lines: list[NDArray[np.uint8]] = []
    for camera, pictures in rows.items():
        tiles: list[NDArray[np.uint8]] = []
        for picture, moment in zip(pictures, moments, strict=True):
            tile = np.pad(picture, ((CAPTION, GAP), (0, GAP), (0, 0)), constant_values=WHITE)
            at, font, text = (2, CAPTION - 5), cv2.FONT_HERSHEY_SIMPLEX, f"{camera}, {moment}"
            cv2.putText(tile, text, at, font, 0.35, (0, 0, 0), 1, cv2.LINE_AA)
            tiles.append(tile)
        lines.append(np.concatenate(tiles, axis=1))
    width = max(line.shape[1] for line in lines)
    sheet = np.full((sum(map(len, lines)), width, 3), WHITE, np.uint8)
    for line, end in zip(lines, np.cumsum([*map(len, lines)]), strict=True):
        sheet[end - len(line) : end, : line.shape[1]] = line
    return sheet


# ---- the plot of the joints ----------------------------------------------------------------------

SIZE = (11.0, 9.0)  # [inch] of the whole plot
NAMES_WIDTH = 160  # characters of a line of stage names
NO_BREAK = "\u00a0"  # a space that does not end a line
COMMANDED, MEASURED = "#d1495b", "#1f7a8c"
INK, SOFT, LINE = "#1d2733", "#66727f", "#d8dee5"  # as on the report page
BANDS = ("#eef2f6", "#ffffff")
SMALLEST = 0.02  # [rad or m] that a panel spans, so that a joint at rest is a flat line

STYLE = {
    "axes.edgecolor": LINE,
    "axes.labelcolor": INK,
    "font.family": "sans-serif",
    "font.size": 8,
    "path.simplify": False,  # draw every frame
    "svg.fonttype": "none",  # text stays text
    "svg.hashsalt": "rtphys",  # the same bytes on every run
    "text.color": INK,
    "text.parse_math": False,  # a dollar in a name is a dollar
    "xtick.color": SOFT,
    "ytick.color": SOFT,
}


@dataclass(frozen=True)
class Panel:
    """One joint."""

    title: str
    target: Floats  # (T,)
    measured: Floats | None  # (T,), None where no joint of that name was recorded


def panels(frames: Frames) -> list[Panel]:
    """The joints and the gripper of each arm, left arm first."""
    prefixes = list(dict.fromkeys(name.partition("_")[0] for name in frames.joint_names))
    arms = [[n for n in frames.joint_names if n.partition("_")[0] == p] for p in prefixes]
    aloha, (closed, opened) = "fl" in prefixes, ALOHA_OPENING
    shown: list[Panel] = []
    # The recorded joints of an arm share a prefix and lie in order, base to fingers.
    for side, names in zip(SIDES, arms if len(arms) == len(SIDES) else ([], []), strict=True):
        angles, opening = getattr(frames, f"{side}_arm"), getattr(frames, f"{side}_gripper")
        measured = [frames.qpos[:, frames.joint_names.index(name)] for name in names]
        measured += [None] * (angles.shape[1] + 1 - len(measured))
        for k, target in enumerate(angles.T):
            shown.append(Panel(f"{side} {k + 1} [rad]", target, measured[k]))
        if aloha:
            finger, target = measured[angles.shape[1]], closed + opening * (opened - closed)
            shown.append(Panel(f"{side} finger [m]", target, finger))
        else:  # no file tells the stroke of another robot: the command
            shown.append(Panel(f"{side} opening [1]", opening, None))
    return shown


def joint_plot(episode: Episode) -> str:
    """An SVG document: left arm in the left column, right arm in the right one."""
    frames = episode.frames
    changes = (np.flatnonzero(np.diff(frames.stage)) + 1).tolist()
    stages = [*pairwise([0, *changes, len(frames) - 1])]  # first frames of each and of the next
    with matplotlib.rc_context(STYLE):  # pyright: ignore[reportArgumentType] - str is fine
        figure = Figure(figsize=SIZE, layout="constrained")
        title = f"{episode.task} {episode.number}, seed {episode.seed}, {episode.protocol}"
        figure.suptitle(title, x=0.01, ha="left", fontweight="bold")
        arms = [[p for p in panels(frames) if p.title.startswith(side)] for side in SIDES]
        columns = figure.subplots(max(map(len, arms)), 2, sharex=True).T
        for column, (*joints, gripper) in zip(columns, arms, strict=True):
            for axes in column[len(joints) : -1]:  # the other arm has more joints
                axes.set_axis_off()
            used = [*column[: len(joints)], column[-1]]
            for axes, panel in zip(used, [*joints, gripper], strict=True):
                for n, (first, last) in enumerate(stages):
                    axes.axvspan(frames.time[first], frames.time[last], color=BANDS[n % 2], lw=0)
                _draw_panel(axes, panel, frames)
            for number, (first, last) in enumerate(stages, start=1):
                middle = float(frames.time[first] + frames.time[last]) / 2
                above = column[0].get_xaxis_transform()
                column[0].text(middle, 1.04, str(number), transform=above, color=SOFT, ha="center")
            column[-1].set_xlabel("time [s]")
        names = (frames.stages[int(frames.stage[first])] for first, _ in stages)
        numbered = (f"{n} {name}".replace(" ", NO_BREAK) for n, name in enumerate(names, start=1))
        figure.supxlabel(fill(" · ".join(numbered), NAMES_WIDTH), size="medium", color=SOFT)
        handles, labels = columns[0, 0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside upper right", ncols=2, frameon=False)
        text = StringIO()
        figure.savefig(text, format="svg", metadata={"Date": None})
    return text.getvalue()


def _draw_panel(axes: Axes, panel: Panel, frames: Frames) -> None:
    known = {"commanded": panel.target}
    if panel.measured is not None:
        known["measured"] = panel.measured
    for (label, values), colour in zip(known.items(), (COMMANDED, MEASURED), strict=False):
        (line,) = axes.plot(frames.time, values, color=colour, lw=1.2, label=label)
        line.set_gid(f"{label} {panel.title}")
    low = min(float(values.min()) for values in known.values())
    high = max(float(values.max()) for values in known.values())
    half = max(high - low, SMALLEST) / 2
    axes.set_ylim((low + high) / 2 - 1.1 * half, (low + high) / 2 + 1.1 * half)
    axes.set_xlim(frames.time[0], frames.time[-1])
    axes.set_ylabel(panel.title)
    axes.tick_params(length=2)
