"""Figures of an evaluation: what their panels say."""

from pathlib import Path

import pytest
from matplotlib.axes import Axes

from rtphys.report.figures import draw_breaks
from rtphys.results.breaks import Break, Curve
from rtphys.results.statistics import Rate


def test_a_p_that_is_adjusted_is_called_so(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    titles = list[str]()
    monkeypatch.setattr(Axes, "set_title", lambda _, text, **__: titles.append(text))
    curve = Curve(low=0.1, high=0.9, slope=-3.0, error=1.0, levels=(1.0,), p=2.5e-7)
    effect = Break("friction", "1", curve, 2e-6, ((0.1, 0.9, Rate(3, 9)),))
    draw_breaks([effect], "idle under phys_random", tmp_path / "attributes.png")
    assert titles == ["friction [1]\nlog-odds -3.0, p (Holm) = 2e-06"]
    assert (tmp_path / "attributes.png").stat().st_size
