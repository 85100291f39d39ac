"""Base class and field types of the models of JSON files."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, FiniteFloat, ValidationError

from rtphys.core.bounds import SHOWN_CHARACTERS, WHOLE_NUMBER
from rtphys.core.errors import BadFile, RtphysError, shortened
from rtphys.core.paths import plain_name, plain_path

Seed = Annotated[int, Field(ge=0, le=WHOLE_NUMBER)]
Count = Annotated[int, Field(ge=0, le=WHOLE_NUMBER)]
Name = Annotated[str, AfterValidator(plain_name)]  # becomes a part of a path
RelativePath = Annotated[str, AfterValidator(plain_path)]  # of a file in the dataset


def _stepping(stride: list[int]) -> list[int]:
    if stride[1] < 1:
        raise ValueError("its step is at least 1")
    return stride


# First attempt, and step.
Stride = Annotated[list[Count], Field(min_length=2, max_length=2), AfterValidator(_stepping)]
KeepFailures = Annotated[str, Field(pattern=r"^(all|[1-9][0-9]{0,7})$")]  # how many, or all
Sha256 = Annotated[str, Field(pattern=r"^[0-9a-f]{64}$")]
Vector3 = Annotated[list[FiniteFloat], Field(min_length=3, max_length=3)]
Quaternion = Annotated[list[FiniteFloat], Field(min_length=4, max_length=4)]


MOST = SHOWN_CHARACTERS // 40  # problems that an error names


class SchemaError(RtphysError):
    """JSON that breaks its schema; one clause per problem, naming the place."""

    def __init__(self, what: str, error: ValidationError) -> None:
        found = error.errors(include_url=False, include_context=False, include_input=False)
        self.problems = [
            f"{shortened('.'.join(map(str, item['loc']))) or 'top level'}: {item['msg'].lower()}"
            for item in found[:MOST]
        ]
        if len(found) > MOST:
            self.problems.append(f"and {len(found) - MOST} more")
        super().__init__(f"{what} breaks its schema: {'; '.join(self.problems)}")


class Model(BaseModel):
    """A closed record: an unknown key is a mistake, not an extension."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)


@contextmanager
def problems_of(path: Path) -> Iterator[None]:
    """Turns what a file's content breaks into `BadFile`, which names each problem's place."""
    try:
        yield
    except ValidationError as error:
        raise BadFile(path, "; ".join(SchemaError(str(path), error).problems)) from error
