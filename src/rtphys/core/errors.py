"""The errors that several packages raise, their root, and the reasons to reject an attempt."""

from collections.abc import Iterable
from difflib import get_close_matches
from pathlib import Path
from reprlib import Repr

from rtphys.core.bounds import SHOWN_CHARACTERS


def shortened(text: str) -> str:
    """The text, or its beginning: a file can make it as long as it likes."""
    short = len(text) <= SHOWN_CHARACTERS
    return text if short else f"{text[:SHOWN_CHARACTERS]} ... ({len(text)} characters)"


_REPR = Repr()
_REPR.maxlevel = 3
_REPR.maxstring = _REPR.maxother = _REPR.maxlong = SHOWN_CHARACTERS
_REPR.maxdict = _REPR.maxlist = _REPR.maxtuple = _REPR.maxset = 16


def short_repr(value: object) -> str:
    """`repr`, cut where it is long, before a nest of aliases grows to gigabytes."""
    return shortened(_REPR.repr(value))


def counted(number: int, noun: str) -> str:
    """`"1 episode"`, `"2 episodes"`. `noun`: in the plural, by an s."""
    return f"{number} {noun.removesuffix('s') if number == 1 else noun}"


class RtphysError(Exception):
    """Root of all errors that rtphys raises on purpose; the command line prints the text alone.

    A text names an option by its field in backticks ("choose another `out`"), never by a flag:
    the command line puts the flag of the running command in its place.
    """

    exit_code = 2

    def __reduce__(self) -> tuple[object, ...]:
        # Errors cross processes; by default unpickling calls the constructor with the sentence.
        return _revive, (type(self), self.args, self.__dict__)


def _revive(
    kind: type[RtphysError], args: tuple[object, ...], state: dict[str, object]
) -> RtphysError:
    error = kind.__new__(kind, *args)
    error.args = args
    error.__dict__.update(state)
    return error


class UnknownName(RtphysError):
    """A name that is not in a known set; the message names the nearest match."""

    def __init__(self, kind: str, name: str, known: Iterable[str], where: str | Path = "") -> None:
        self.kind, self.name, self.known = kind, name, sorted(set(known))
        near = get_close_matches(name[:SHOWN_CHARACTERS], self.known, n=1, cutoff=0.4)
        hint = f"; did you mean {near[0]!r}?" if near else "."
        text = f"unknown {kind} {short_repr(name)}{hint} Known: {', '.join(self.known) or 'none'}"
        super().__init__(f"{where}: {text}" if where else text)


class BadValue(RtphysError):
    """A value outside what is allowed.

    Args:
        key: name of the field, in snake case; the command line shows it as the option's flag.
        allowed: what it may hold. A field that is named here stands in backticks.
        where: the file that the value comes from; empty for an argument or an option.
    """

    def __init__(self, key: str, value: object, allowed: str, where: str | Path = "") -> None:
        self.key, self.value, self.allowed, self.where = key, value, allowed, where
        place = f"{where}: " if where else ""
        super().__init__(f"{place}{key} = {short_repr(value)} is not allowed; {allowed}")


class BadFile(RtphysError):
    """A file that cannot be read as what it should be."""

    def __init__(self, path: str | Path, problem: str) -> None:
        self.path, self.problem = Path(path), problem
        super().__init__(f"{path}: {problem}")


class MissingAsset(RtphysError):
    """A model, embodiment or texture that the asset pack does not hold."""

    def __init__(self, what: str, where: str | Path, needed_by: str = "") -> None:
        self.what, self.where = what, Path(where)
        user = f" (needed by {needed_by})" if needed_by else ""
        super().__init__(f"{where}: the asset pack has no {what}{user}")


class NoRenderer(RtphysError):
    """No usable Vulkan device; `rtphys doctor` names the cure."""

    exit_code = 3


class Infeasible(RtphysError):
    """The expert cannot do this episode: a result of `generate.attempt`, not an error.

    `reason` is one word, such as those of `REASONS`, so that rejections can be counted.
    """

    def __init__(self, reason: str, detail: str = "") -> None:
        self.reason, self.detail = reason, detail
        super().__init__(f"{reason}: {detail}" if detail else reason)


REASONS: dict[str, str] = {
    "invalid_physics": "no real object could have this draw",
    "layout": "no layout of this seed satisfies the task's spacing rules",
    "unsettled": "objects did not come to rest before the episode (tilt, low friction)",
    "unreachable": "no inverse-kinematics solution for any allowed pose",
    "no_path": "no collision-free path between two reachable poses",
    "retime_failed": "the path could not be time-parameterised",
    "ungraspable": "no contact point fits the gripper",
    "grasp_missed": "the fingers closed on nothing",
    "slipped": "the object left the hand",
    "collision": "a link that is no finger was pressed with over 30 N for over 0.1 s",
    "overloaded": "a motor gave its largest torque for over 0.1 s",
    "too_slow": "the motion cannot finish within the task's step limit",
    "stalled": "an articulated part did not follow the hand",
    "failed_check": "the script ran to its end and the success condition did not hold",
    "not_held": "success held for an instant, but not 0.5 s later",
    "recovered": "a load was lost and would have to be taken again, which was not allowed",
    "disturbed": "another object was knocked over or off the table",
    "untwinned": "it was accepted, its twin under another protocol was not",
    "worker_crash": "the attempt crashed its worker process, twice",
    "worker_hang": "the attempt used more CPU time than the limit, twice",
}
