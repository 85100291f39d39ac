"""All fifty tasks of the paper are there, by name, with sentences; no more under those names."""

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

from rtphys.core import library
from rtphys.task.spec import load_task

# Typed from the paper's per-task table (which lists place_burger_fries twice).
PAPER = """
adjust_bottle beat_block_hammer blocks_ranking_rgb blocks_ranking_size click_alarmclock click_bell
dump_bin_bigbin grab_roller handover_block handover_mic hanging_mug lift_pot move_can_pot
move_playingcard_away move_stapler_pad open_laptop open_microwave pick_diverse_bottles
pick_dual_bottles place_a2b_left place_a2b_right place_bread_basket place_bread_skillet
place_burger_fries place_can_basket place_cans_plasticbox place_container_plate place_dual_shoes
place_empty_cup place_fan place_mouse_pad place_object_basket place_object_scale
place_object_stand place_phone_stand move_pillbottle_pad place_shoe press_stapler
put_bottles_dustbin put_object_cabinet rotate_qrcode scan_object shake_bottle
shake_bottle_horizontally stack_blocks_three stack_blocks_two stack_bowls_three stack_bowls_two
stamp_seal turn_switch
""".split()  # noqa: SIM905

# RoboTwin's evaluation step limits, typed from the fact sheet: they sum to 31 000 over the fifty.
OTHER_LIMITS = {
    "blocks_ranking_rgb": 1200, "blocks_ranking_size": 1200, "dump_bin_bigbin": 600,
    "handover_block": 800, "handover_mic": 600, "hanging_mug": 900, "open_laptop": 700,
    "open_microwave": 1500, "place_bread_basket": 700, "place_bread_skillet": 500,
    "place_burger_fries": 500, "place_can_basket": 700, "place_cans_plasticbox": 800,
    "place_dual_shoes": 600, "place_empty_cup": 500, "place_object_basket": 700,
    "place_shoe": 500, "put_bottles_dustbin": 1700, "put_object_cabinet": 700,
    "scan_object": 500, "shake_bottle": 700, "shake_bottle_horizontally": 700,
    "stack_blocks_three": 1200, "stack_blocks_two": 800, "stack_bowls_three": 1200,
    "stack_bowls_two": 900,
}  # fmt: skip


def test_the_set_is_the_papers() -> None:
    assert len(PAPER) == len(set(PAPER)) == 50
    bundled = [n for n, path in library.names("tasks").items() if library.bundled() in path.parents]
    assert set(bundled) == set(PAPER)


@pytest.mark.parametrize("name", PAPER)
def test_step_limit_is_the_official_one(name: str) -> None:
    assert load_task(name).step_limit == OTHER_LIMITS.get(name, 400)


FILES = sorted((library.bundled() / "tasks").glob("*.py"))  # families too


def lays_out(function: ast.FunctionDef) -> bool:
    """Layouts consist of ranges, which are said where they are drawn from."""
    annotations = [arg.annotation for arg in function.args.args]
    kinds = {kind.id for kind in annotations if isinstance(kind, ast.Name)}
    return function.name == "layout" or bool(kinds & {"Draw", "Spot"})


def wants_a_name(value: object) -> bool:
    return type(value) in (int, float) and value not in (0, 1, 2)


def unnamed(node: ast.AST, inside: bool = False) -> Iterator[str]:
    """Numbers other than 0, 1 and 2 within functions and lambdas: they should have names."""
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.FunctionDef) and lays_out(child):
            continue
        if inside and isinstance(child, ast.Constant) and wants_a_name(child.value):
            yield f"line {child.lineno}: {child.value}"
        yield from unnamed(child, inside or isinstance(child, ast.FunctionDef | ast.Lambda))


def literals(path: Path) -> list[str]:
    return list(unnamed(ast.parse(path.read_text())))


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_a_task_names_its_numbers(path: Path) -> None:
    left = literals(path)
    assert len(left) <= 3, left


def test_few_numbers_are_left_without_a_name() -> None:
    assert sum(len(literals(path)) for path in FILES) <= 60


def test_unnamed_numbers_are_counted_outside_layouts_alone() -> None:
    source = """
LIFT = 0.1
def layout(draw):
    return 0.2
def free(spot: Spot):
    return spot.x > 0.3
def script(robot, gap=0.4):
    robot.do(robot.left.lift(-0.5), 2, "0.6", True)
    return lambda: 0.7
below = lambda scene: scene.time < 0.8
"""
    assert [text.split()[-1] for text in unnamed(ast.parse(source))] == ["0.4", "0.5", "0.7", "0.8"]
