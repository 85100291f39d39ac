"""Files of a dataset: schemas, HDF5 layouts, videos, ledgers and manifest. Needs no simulator."""
