"""Base class and field types of the models of JSON files."""

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field, FiniteFloat, ValidationError

from rtphys.core.errors import RtphysError

Seed = Annotated[int, Field(ge=0)]
Count = Annotated[int, Field(ge=0)]
Sha256 = Annotated[str, Field(pattern=r"^[0-9a-f]{64}$")]
Vector3 = Annotated[list[FiniteFloat], Field(min_length=3, max_length=3)]
Quaternion = Annotated[list[FiniteFloat], Field(min_length=4, max_length=4)]


class SchemaError(RtphysError):
    """JSON that breaks its schema; one clause per problem, naming the place."""

    def __init__(self, what: str, error: ValidationError) -> None:
        self.problems = [
            f"{'.'.join(map(str, item['loc'])) or 'top level'}: {item['msg'].lower()}"
            for item in error.errors()
        ]
        super().__init__(f"{what} breaks its schema: {'; '.join(self.problems)}")


class Model(BaseModel):
    """A closed record: an unknown key is a mistake, not an extension."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)
