"""Pictures of a pack, drawn without a renderer."""

import numpy as np

from rtphys.assets.contact_sheet import CONTACT, FUNCTIONAL, contact_sheet, tile


def marked(picture, colour) -> bool:
    return bool((picture == np.array(colour, np.uint8)).all(-1).any())


def test_a_tile_shows_the_object_and_its_points(builtin):
    hammer = tile(builtin, "020_hammer", 0, 96)
    assert marked(hammer, CONTACT) and marked(hammer, FUNCTIONAL)
    red = (hammer[..., 0] > 90) & (hammer[..., 1] < 40) & (hammer[..., 2] < 40)
    assert red.mean() > 0.03  # its grip
    bell = tile(builtin, "050_bell", 0, 96)
    assert marked(bell, CONTACT) and not marked(bell, FUNCTIONAL)


def test_a_sheet_has_a_tile_a_model(builtin):
    messages = []
    sheet = contact_sheet(
        builtin, [("015_laptop", i) for i in range(3)], 48, columns=2, tell=messages.append
    )
    assert sheet.size == (96, 2 * 60) and len(messages) == 3
    assert len(np.unique(np.asarray(sheet)[:48, :48].reshape(-1, 3), axis=0)) > 20
