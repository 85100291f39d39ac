"""Files of a dataset: schemas, HDF5 layouts, video, journal and manifest. Needs no simulator."""
