"""Parquet files with fixed types, so that an empty or a null column keeps its type."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from rtphys.data.files import make_folder, refusals


def frame_table(columns: Mapping[str, np.ndarray]) -> pa.Table:
    """Vectors as lists of fixed length, scalars plain."""
    arrays = {}
    for name, values in columns.items():
        if values.ndim == 2:
            flat = pa.array(np.ascontiguousarray(values).ravel())
            arrays[name] = pa.FixedSizeListArray.from_arrays(flat, values.shape[1])
        else:
            arrays[name] = pa.array(values)
    return pa.table(arrays)


def record_table(rows: Sequence[Mapping[str, object]]) -> pa.Table:
    """One row a record; the keys of the first; floats, integers, text and nested lists of them."""
    columns = {}
    for key in rows[0]:
        values = [_plain(row[key]) for row in rows]
        columns[key] = pa.array(values, _type(values))
    return pa.table(columns)


def _plain(value: object) -> object:
    return value.tolist() if isinstance(value, np.ndarray) else value


def _type(values: Sequence[object]) -> pa.DataType | None:
    """A column of nothing but nulls still is a column of numbers (an asset's own friction)."""
    return pa.float64() if all(value is None for value in values) else None


def write_table(table: pa.Table, path: Path, row_group: int | None = None) -> None:
    """Raises `CannotWrite`."""
    make_folder(path.parent)
    with refusals(path):
        pq.write_table(table, path, compression="snappy", row_group_size=row_group)
