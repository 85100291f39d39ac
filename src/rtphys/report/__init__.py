"""Datasets and results as pictures: an HTML page, contact sheets, plots."""
