"""Which objects look alike: clutter must not, so that an instruction stays unambiguous."""

from collections.abc import Collection

GROUPS = (
    {"001_bottle", "114_bottle", "029_olive-oil", "065_soy-sauce", "066_vinegar", "049_shampoo"},
    {"109_hydrating-oil", "080_pillbottle", "095_glue", "031_jam-jar"},
    {"071_can", "105_sauce-can", "068_boxdrink", "038_milk-box"},
    {"021_cup", "039_mug", "059_pencup", "002_bowl"},
    {"003_plate", "008_tray", "019_coaster"},
    {"076_breadbasket", "110_basket", "062_plasticbox", "007_shoe-box"},
    {"063_tabletrashbin", "011_dustbin"},
    {"005_french-fries", "006_hamburg", "075_bread"},
    {"077_phone", "079_remotecontrol", "151_calculator"},
    {"078_phonestand", "074_displaystand", "070_paymentsign"},
    {"112_tea-box", "113_coffee-box", "081_playingcards", "107_soap", "023_tissue-box"},
    {"086_woodenblock", "073_rubikscube"},
    {"020_hammer", "084_woodenmallet"},
    {"030_drill", "024_scanner"},
    {"106_skillet", "060_kitchenpot"},
    {"043_book", "150_paperback", "092_notebook", "015_laptop", "116_keyboard"},
    {"036_cabinet", "040_rack", "044_microwave"},
    {"046_alarm-clock", "099_fan"},
)
"""Groups of id_names that look alike; models of one id_name always do."""

BLOCKS = {"086_woodenblock", "073_rubikscube", "112_tea-box", "113_coffee-box"}
"""id_names that look like the plain boxes that tasks stack."""

ROUND = {"035_apple", "130_fruit", "102_roller", "155_marker"}
"""id_names that are never clutter: stable on a level table, they roll off a tilted one."""


def alike(category: str, named: Collection[str], blocks: bool) -> bool:
    """Whether a model of this category could be mistaken for one of the task's objects.

    Args:
        named: categories of the task's objects.
        blocks: whether plain boxes are among them.
    """
    if category in named or (blocks and category in BLOCKS):
        return True
    return any(category in group and not group.isdisjoint(named) for group in GROUPS)
