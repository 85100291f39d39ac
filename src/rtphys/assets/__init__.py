"""Asset packs: one layout (RoboTwin's), one loader, and the generators of the builtin pack."""
