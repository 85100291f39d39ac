"""Asset packs in RoboTwin's layout: the loader, and the generators of the builtin pack."""
