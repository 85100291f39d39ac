"""The instant at which an attempt went wrong, found in its states and contacts.

* slip: an object slid or turned in the closed hand that held it. First frame beyond 1 cm or 20 deg,
  counted from the start of the slide that ended in the loss; if it is lost sooner, the first frame
  without contact. A person marks it there: a slide begins with millimetres, which nobody sees. If
  it swung by 50 deg within half a second before, then there.
* drop: a closed hand lost an object that had not slid before. First frame without contact.
* miss: a hand closed on nothing, where something had to be taken. First frame in which its fingers
  are closed.
* tip_over: an object tipped that no hand held, nor carried later. First frame beyond 45 deg.
* moved: an object moved that no hand held, nor carried later, nor let go of within half a second
  before. First frame beyond 2 cm or 20 deg. What lies in a carried object is carried.
* misplaced: a hand let go of it, and the attempt failed later. First frame without contact, or with
  the hand opening. What had slid by 3 cm or turned by 45 deg in the hand is a slip, and what it
  does later is no news.
* stuck: there was no way on for the arms. Last frame.
* end: none of these. Last frame.

Only frames are looked at, so an instant is known to 60 ms. Of several events one is chosen: where
the reason names a lost or missed grasp, the first loss or the last miss; else what happened last to
the objects that a failed condition names, or to any object. What led to it in half a second, to
whichever object, counts instead. If a grasp missed an object that had tipped over or moved before,
or did not pick it up, then this is the instant.
"""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from operator import attrgetter

import numpy as np
from numpy.typing import NDArray

from rtphys.core.poses import Array, quat_to_matrix
from rtphys.data.episode import ARMS, Frames
from rtphys.data.schema import Event, Side

Flags = NDArray[np.bool_]

FAR = 0.02  # [m] as much as a piece of clutter may move undisturbed
WITHIN = 0.05  # [m] by which the contents of a carried object may shift
BRIEF = 3  # frames without contact, or without sliding, that interrupt neither
OPENED = 0.05  # of the gripper's stroke: less is no opening and no closing
TIPPED, TURNED, SWING = np.radians(45), np.radians(20), np.radians(50)
SEEN = (0.01, TURNED)  # [m], [rad] in the hand: enough to be seen
SPOILT = (0.03, np.radians(45))  # likewise: enough to be put down wrong
SLIDING = 0.002  # [m] between two frames, 33 mm/s
JUST = 40  # frames, 2.4 s, before the end in which a hand missed what the attempt ends for
SOON = 8  # frames, half a second, in which what was let go of is still on its way
CLOSED = 0.5  # of the stroke that fingers have to close at once for a grasp

LOST, UPSET = ("slip", "drop"), ("tip_over", "moved")
# Reasons whose detail names the conditions that fail: of the expert, and of policies.
CHECK = ("failed_check", "not_held", "gave_up", "step_limit")
GRASP = ("grasp_missed", "slipped", "recovered")  # reasons that name a lost or missed grasp
STUCK = ("no_path", "unreachable", "retime_failed", "ungraspable", "stalled", "too_slow")


@dataclass(frozen=True)
class Instant:
    """One thing that went wrong."""

    event: Event
    frame: int
    object: str = ""  # empty: nothing in particular
    side: Side = ""  # hand


_frame = attrgetter("frame")


def went_wrong(frames: Frames, reason: str, detail: str, scenery: Sequence[str] = ()) -> Instant:
    """When a failed attempt went wrong.

    Args:
        reason: of the rejection, or of a policy's failure.
        detail: likewise; it begins with the name of the object that a grasp lost or missed.
        scenery: objects that the task is not about, such as clutter.
    """
    objects = [name for name in frames.object_poses if name not in scenery]
    holds = [hold for name in objects for side in ARMS for hold in _holds(frames, name, side)]
    holds.sort(key=lambda hold: hold.last)
    found = [instant for name in objects for instant in _of_object(frames, name, holds)]
    misses = [instant for side in ARMS for instant in _misses(frames, side)]
    end = Instant("stuck" if reason in STUCK else "end", len(frames) - 1)
    if reason not in GRASP:
        # Where the arms have no way on, what was put down before may well be in its place.
        candidates = [one for one in found if not (reason in STUCK and one.event == "misplaced")]
        if reason in CHECK:
            candidates = [one for one in candidates if _names(detail, one.object)] or candidates
        if not candidates:
            closed = reason in CHECK and _wants_closed_hands(detail)
            return end if closed else max(misses, key=_frame, default=end)
        last = max(candidates, key=_frame)
        if last.event == "misplaced":  # every load is let go of, but few tip over for good
            last = max((one for one in candidates if one.event in UPSET), key=_frame, default=last)
        # The first of the events that led to it, each soon after the one before.
        before = [one for one in found if one.event != "misplaced" and one.frame < last.frame]
        for one in sorted(before, key=_frame, reverse=True):
            last = one if last.frame - one.frame <= SOON else last
        return last
    about = next((name for name in objects if detail.startswith(f"{name} ")), "")
    lost = [one for one in found if one.event in LOST and about in ("", one.object)]
    # A hand that shut long ago had shut on its way, and the one that missed has not shut yet.
    recent = [one for one in misses if end.frame - one.frame <= JUST]
    last = max([*lost, *recent], key=_frame, default=end)
    if last not in lost:
        return _cause(last, about, found)
    # What was lost, picked up and lost again went wrong the first time.
    hold = next((hold for hold in holds if hold.lost and about in ("", hold.object)), None)
    if hold is None:
        return last
    first = next(_of_hold(frames, hold))
    picked_up = _is_carried(frames, hold.object, hold.first, hold.last)
    return first if picked_up else _cause(first, hold.object, found)


def _names(detail: str, name: str) -> bool:
    """Whether conditions that do not hold are about an object, alone or as one of several."""
    # Of a joint the poses say nothing: what moved it is rather what another object did.
    texts = [text for text in detail.split("; ") if " joint " not in text]
    words = set(re.findall(r"\w+", " ".join(texts)))
    return name in words or f"{name.rstrip('0123456789')}s" in words


def _wants_closed_hands(detail: str) -> bool:
    """Whether all that is not true is about pressing and pushing, for which a hand is closed."""
    texts = detail.split("; ")
    return all(" pressed at " in text or " joint " in text for text in texts)


def _cause(late: Instant, about: str, found: Sequence[Instant]) -> Instant:
    """What had upset the object before a grasp failed, if anything; else the late instant."""
    late = replace(late, object=about) if late.event == "miss" else late
    upset = [one for one in found if one.event in UPSET and one.frame < late.frame]
    own = [one for one in upset if about in ("", one.object)]
    return min(own, key=_frame, default=late)


# ---- holds: a closed hand on an object -----------------------------------------------------------


@dataclass(frozen=True)
class Hold:
    """A closed hand touches an object from frame `first` to frame `last`."""

    object: str
    side: Side
    first: int
    last: int
    released: bool  # it ends because the hand opens
    lost: bool  # it ends although the hand stays closed


def _holds(frames: Frames, name: str, side: Side) -> Iterator[Hold]:
    """Runs of contact while the hand is as closed as it was, short gaps bridged."""
    opening = _opening(frames, side)
    touched = np.asarray(frames.contacts[name])[:, ARMS.index(side)]
    held = touched & ~_loose(opening)
    t, T = 0, len(frames)
    while t < T:
        if not held[t]:
            t += 1
            continue
        first = last = t
        least = opening[t]
        while t + 1 < T and t - last < BRIEF and opening[t + 1] <= least + OPENED:
            t += 1
            least = min(least, opening[t])
            last = t if touched[t] else last
        released = bool(t + 1 < T and opening[t + 1] > least + OPENED)
        yield Hold(name, side, first, last, released, last + 1 < T and not released)
        t += 1


def _opening(frames: Frames, side: Side) -> Array:
    return np.asarray(getattr(frames, f"{side}_gripper"), float)


def _loose(opening: Array) -> Flags:
    """Whether a hand has opened, and not closed since: what it touches then, it does not hold."""
    loose = np.zeros(len(opening), bool)
    now, turned = bool(opening[0] > 1 - OPENED), opening[0]  # `turned`: the extreme since then
    for t, width in enumerate(opening):
        turned = max(turned, width) if now else min(turned, width)
        if abs(width - turned) > OPENED:
            now, turned = not now, width
        loose[t] = now
    return loose


def _place(frames: Frames, name: str) -> Array:
    return np.asarray(frames.object_poses[name], float)[:, :3]


def _is_carried(frames: Frames, name: str, first: int, last: int) -> bool:
    """Whether the object went with the hand; one that a hand only touches was not picked up."""
    place = _place(frames, name)[first : last + 1]
    return bool((np.linalg.norm(place - place[:1], axis=1) > FAR).any())


def _last_along(frames: Frames, name: str, hold: Hold) -> int:
    """Last frame in which an object is carried in or on a held one; before the hold if in none."""
    span = slice(hold.first, hold.last + 1)
    here = _place(frames, name)[span]
    away = np.linalg.norm(here - _place(frames, hold.object)[span], axis=1)
    end = int(np.append(away > away[0] + WITHIN, True).argmax())
    rises = (here[:end, 2] - here[0, 2] > FAR).any()  # what is only pushed does not
    return hold.first + end - 1 if rises else hold.first - 1


def _angles(turns: Array, start: Array) -> Array:
    """Angles [rad] of rotations (T, 3, 3) from one (3, 3), or from others (T, 3, 3)."""
    trace = np.einsum("tij,tij->t", turns, np.broadcast_to(start, turns.shape))
    return np.arccos(np.clip((trace - 1) / 2, -1, 1))


# ---- one object ----------------------------------------------------------------------------------


def _of_object(frames: Frames, name: str, holds: Sequence[Hold]) -> Iterator[Instant]:
    """What went wrong with an object, given the holds of all objects."""
    held, taken, let_go, spoilt = np.zeros(len(frames), bool), 0, -SOON - 1, False
    for hold in holds:
        own = hold.object == name
        last = hold.last if own else _last_along(frames, name, hold)
        held[hold.first : last + 1 + BRIEF] |= last >= hold.first
        carried = _is_carried(frames, name, hold.first, last)
        taken = max(taken, hold.first) if carried else taken
        if own:
            instants = list(_of_hold(frames, hold))
            yield from instants
            let_go = max(let_go, hold.last) if hold.released else let_go
            well = any(one.event == "misplaced" for one in instants)
            spoilt = carried and hold.released and not well
    if spoilt:
        return  # it was put down wrong, so what it does later is no news
    seen: set[str] = set()  # what lies on its side may roll on: the first time counts
    for instant in _upset(np.asarray(frames.object_poses[name], float), name, held):
        # What rolls or falls away when it is let go of was misplaced.
        soon = instant.event == "moved" and 0 <= instant.frame - let_go <= SOON
        if instant.frame > taken and instant.event not in seen and not soon:
            seen.add(instant.event)
            yield instant


def _of_hold(frames: Frames, hold: Hold) -> Iterator[Instant]:
    """How an object shifted in a hand, and how the hold ended."""
    name, side, last = hold.object, hold.side, hold.last
    opening = _opening(frames, side)[hold.first : last + 1]
    closed = hold.first + int((opening <= opening.min() + 1e-9).argmax())
    hand = np.asarray(getattr(frames, f"{side}_endpose"), float)
    pose = np.asarray(frames.object_poses[name], float)
    R_WH = np.array([quat_to_matrix(q) for q in hand[:, 3:]])
    R_WO = np.array([quat_to_matrix(q) for q in pose[:, 3:]])
    place = np.einsum("tji,tj->ti", R_WH, pose[:, :3] - hand[:, :3])  # in the hand's frame
    turn = np.einsum("tji,tjk->tik", R_WH, R_WO)

    def shifted(first: int, beyond: tuple[float, float]) -> Flags:
        """Whether it is further [m], or turned further [rad], than this from frame `first`."""
        slid = np.linalg.norm(place[first : last + 1] - place[first], axis=1) > beyond[0]
        return slid | (_angles(turn[first : last + 1], turn[first]) > beyond[1])

    if hold.lost:
        steps = np.linalg.norm(np.diff(place[closed : last + 2], axis=0), axis=1)
        onset = closed + _last_run(steps > SLIDING)
        if onset > last:
            yield Instant("drop", last + 1, name, side)
            return
        # A load that sags slowly may be carried for long; one that swings round is seen to slip.
        own = turn[closed : last + 1]
        before = own[np.maximum(np.arange(len(own)) - SOON, 0)]
        swings = closed + np.flatnonzero(_angles(own, before) > SWING)
        seen = onset + np.flatnonzero(shifted(onset, SEEN))
        yield Instant("slip", int(min([*swings[:1], *seen[:1]], default=last + 1)), name, side)
        return
    if (slid := shifted(closed, SEEN)).any():
        yield Instant("slip", closed + int(slid.argmax()), name, side)
    carried = _is_carried(frames, name, hold.first, last)
    if hold.released and carried and not shifted(closed, SPOILT).any():
        yield Instant("misplaced", min(last + 1, len(frames) - 1), name, side)


def _last_run(flags: Flags) -> int:
    """Index at which the last run of true flags begins that reaches the end, short gaps bridged.

    Without one: their number.
    """
    start, gap = len(flags), 0
    for t in range(len(flags) - 1, -1, -1):
        gap = 0 if flags[t] else gap + 1
        if gap > BRIEF:
            break
        start = t if flags[t] else start
    return start


def _upset(pose: Array, name: str, held: Flags) -> Iterator[Instant]:
    """Where an object that no hand holds tips or moves, once for each time that it lies free."""
    turn = np.array([quat_to_matrix(q) for q in pose[:, 3:]])
    up = turn[:, 2]  # the world's z, in the body's axes
    edges = np.flatnonzero(np.diff(held.astype(int), prepend=1, append=1))
    for first, end in zip(edges[::2], edges[1::2], strict=True):
        free = slice(int(first), int(end))
        way = np.linalg.norm(pose[free, :3] - pose[first, :3], axis=1)
        angle = np.arccos(np.clip(up[free] @ up[first], -1, 1))
        if (angle > TIPPED).any():
            yield Instant("tip_over", int(first + (angle > TIPPED).argmax()), name)
        moved = (way > FAR) | (_angles(turn[free], turn[first]) > TURNED)
        if moved.any():
            yield Instant("moved", int(first + moved.argmax()), name)


# ---- a hand that closes on nothing ---------------------------------------------------------------


def _misses(frames: Frames, side: Side) -> Iterator[Instant]:
    opening = _opening(frames, side)
    touched = np.any([np.asarray(t)[:, ARMS.index(side)] for t in frames.contacts.values()], axis=0)
    falling = np.diff(opening, prepend=opening[0]) < 0
    t, T = 0, len(frames)
    while t < T:
        first = t
        while t < T and falling[t]:
            t += 1
        shut = t - 1
        stroke = opening[first - 1] - opening[shut] if t > first else 0.0
        if stroke > CLOSED and not touched[shut : shut + BRIEF].any():
            yield Instant("miss", shut, "", side)
        t += 1
