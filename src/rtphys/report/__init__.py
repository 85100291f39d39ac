"""A dataset made visible: one HTML page, contact sheets, plots."""
