"""Figures of studies: what maps and panels show, and that a value changes its own cell alone."""

from pathlib import Path

import cv2
import numpy as np
import pytest
from matplotlib.axes import Axes
from relevance import Relevance, draw_relevance, relevance

from rtphys.report.figures import SENSITIVITY, draw_breaks, draw_task_map, tolerated_shares
from rtphys.results.breaks import Break, Curve
from rtphys.results.statistics import Rate


@pytest.mark.parametrize(
    ("tolerated", "r2", "expected"),
    [
        (0.4, 0.9, Relevance.BREAKS_IDENTIFIABLE),
        (0.99, 0.1, Relevance.BREAKS_HIDDEN),
        (1.0, 0.9, Relevance.HARMLESS_IDENTIFIABLE),
        (1.0, -2.0, Relevance.HARMLESS_HIDDEN),
    ],
)
def test_relevance_is_sensitivity_by_identifiability(
    tolerated: float, r2: float, expected: Relevance
) -> None:
    result = {"task": "click_bell", "attributes": {"friction": {"share": tolerated}}}
    found = relevance(tolerated_shares([result]), {"click_bell": {"friction": r2}})
    assert found == {"click_bell": {"friction": expected}}


def test_only_what_both_studies_measured_has_a_relevance() -> None:
    tolerated = {"click_bell": {"friction": 1.0, "camera_angle": 1.0}, "lift_pot": {}}
    r2 = {"click_bell": {"friction": 0.7}, "turn_switch": {"friction": 0.7}}
    assert relevance(tolerated, r2).keys() == {"click_bell"}
    assert relevance(tolerated, r2)["click_bell"].keys() == {"friction"}


def test_one_value_changes_one_cell(tmp_path: Path) -> None:
    cells = {task: {"friction": 0.5, "table_height": 0.5} for task in ("a", "b")}
    draw_task_map(cells, SENSITIVITY, one := tmp_path / "one.png")
    cells["b"]["table_height"] = 0.9
    draw_task_map(cells, SENSITIVITY, other := tmp_path / "other.png")
    first, second = cv2.imread(str(one)), cv2.imread(str(other))
    assert first is not None and second is not None and first.shape == second.shape
    rows, columns = np.nonzero((first != second).any(axis=2))
    assert len(rows) > 0
    height, width = first.shape[:2]
    assert np.ptp(rows) < height / 2 and np.ptp(columns) < width / 2


def test_each_relevance_has_its_colour(tmp_path: Path) -> None:
    pictures = []
    for one in Relevance:
        draw_relevance({"a": {"friction": one}}, path := tmp_path / f"{one.name}.png")
        pictures.append(cv2.imread(str(path)))
    for i, picture in enumerate(pictures):
        assert picture is not None
        assert all((picture != other).any() for other in pictures[:i])


def test_a_p_that_is_adjusted_is_called_so(monkeypatch: pytest.MonkeyPatch) -> None:
    titles = list[str]()
    monkeypatch.setattr(Axes, "set_title", lambda _, text, **__: titles.append(text))
    curve = Curve(low=0.1, high=0.9, slope=-3.0, error=1.0, levels=(1.0,), p=2.5e-7)
    effect = Break("friction", "1", curve, 2e-6, ((0.1, 0.9, Rate(3, 9)),))
    drawn = draw_breaks([effect], "idle under phys_random")
    assert titles == ["friction [1]\nlog-odds -3.0, p (Holm) = 2e-06"]
    assert drawn.startswith(b"\x89PNG")
