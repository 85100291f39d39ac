"""A fourteenth attribute, from a user's folder, without touching the package."""

import pytest

from rtphys.core.errors import BadFile
from rtphys.physics import attributes, load_domain

WIND = '''
"""How hard the wind blows."""
from rtphys.physics import Attribute, Interval

class Wind(Attribute):
    key = "{key}"
    unit = "N"
    nominal = 0.0
    valid = Interval(0, 5)

    def apply(self, target, value):
        target.wind = value

    def read(self, world):
        return {{"air": world.wind}}
'''


@pytest.fixture
def own_library(tmp_path, monkeypatch):
    monkeypatch.setenv("RTPHYS_LIBRARY", str(tmp_path))
    (tmp_path / "attributes").mkdir()
    (tmp_path / "domains").mkdir()
    return tmp_path


def test_thirteen_are_found_by_scanning():
    assert len(attributes()) == 13
    for key, attribute in attributes().items():
        assert attribute.key == key
        assert attribute.what
        assert type(attribute).__doc__
        if attribute.nominal is not None:
            attribute.check(attribute.nominal)


def test_a_fourteenth_moves_no_draw(own_library):
    before = load_domain("global").sample(9)
    (own_library / "attributes" / "wind.py").write_text(WIND.format(key="wind"))
    (own_library / "domains" / "gale.yaml").write_text("physics: {wind: {uniform: [1, 5]}}\n")
    after = load_domain("global").sample(9)
    assert {k: after[k] for k in before} == dict(before)
    assert after["wind"] == 0.0
    assert 1 <= load_domain("gale").sample(9).scalar("wind") <= 5


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (WIND.format(key="friction"), "the key is 'friction', the file or entry point 'wind'"),
        ("x = 1\n", "needs exactly one Attribute, has 0"),
        ("\nimport nowhere_at_all\n", r"cannot be loaded: ModuleNotFoundError.*\(line 2\)"),
        (WIND.format(key="wind").replace('unit = "N"', ""), "does not say its unit"),
    ],
)
def test_a_broken_plugin_is_named(own_library, text, words):
    path = own_library / "attributes" / "wind.py"
    path.write_text(text)
    with pytest.raises(BadFile, match=words) as caught:
        attributes()
    assert str(path) in str(caught.value)


def test_a_twin_of_a_bundled_attribute_is_refused(own_library):
    (own_library / "attributes" / "friction.py").write_text(WIND.format(key="friction"))
    with pytest.raises(BadFile, match="exists already"):
        attributes()
