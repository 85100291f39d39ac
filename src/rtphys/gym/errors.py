"""Errors that Gymnasium's AsyncVectorEnv can raise again where it is called.

Of an error in a process it keeps the class and the object, and raises `type(error)(error)`. Those
of rtphys take other arguments, so that a TypeError came instead of what they say.
"""

from collections.abc import Iterator
from contextlib import contextmanager

from rtphys.core import errors


class _Again:
    def __init__(self, error: errors.RtphysError) -> None:
        self.args = error.args
        vars(self).update(vars(error))


class BadFile(_Again, errors.BadFile): ...


class BadValue(_Again, errors.BadValue): ...


class MissingAsset(_Again, errors.MissingAsset): ...


class UnknownName(_Again, errors.UnknownName): ...


KINDS = {kind.__bases__[1]: kind for kind in (BadFile, BadValue, MissingAsset, UnknownName)}


@contextmanager
def raised_again() -> Iterator[None]:
    """Gives these errors the class of their name here, which is one of theirs too."""
    try:
        yield
    except errors.RtphysError as error:
        if (kind := KINDS.get(type(error))) is None:
            raise
        raise kind(error).with_traceback(error.__traceback__) from error.__cause__
