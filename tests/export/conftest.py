"""A dataset for every test of exports."""

import pytest
from collected import collect

from rtphys.data.dataset import Dataset


@pytest.fixture(scope="session")
def dataset(tmp_path_factory: pytest.TempPathFactory) -> Dataset:
    """Three episodes of four seeds, which no test changes."""
    out = tmp_path_factory.mktemp("dataset")
    collect(out, 3)
    return Dataset(out)
