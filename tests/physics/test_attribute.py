"""A fourteenth attribute, from a user's folder, without touching the package."""

import importlib

import pytest

from rtphys.core.errors import BadFile, RtphysError, UnknownName
from rtphys.physics import Physics, attributes, enforce, load_domain
from rtphys.physics.attribute import in_order

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

AFTER = WIND.replace('    unit = "N"', '    unit = "N"\n    applied_after = {after}')
SIZED = WIND.replace('    unit = "N"', '    unit = "N"\n    size = {size}')
WHEN = WIND.replace('    unit = "N"', '    unit = "N"\n    when = "before-build"')
ACTING = WIND.replace('    unit = "N"', '    unit = "N"\n    acts_on = "{on}"')


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
        (WIND.format(key="wind").replace('unit = "N"', ""), "does not define unit"),
        (WIND.format(key="wind").replace("def apply", "def aply"), "does not define apply"),
        (ACTING.format(key="wind", on="body"), "did you mean 'bodies'"),
        (WIND.format(key="wind").replace("nominal = 0.0", "nominal = -3.0"), "wind .*-3.0"),
        (AFTER.format(key="wind", after="'friction'"), "applied_after = 'friction' .* a tuple"),
        (SIZED.format(key="wind", size=2), r"size = 2 .* a number \(1\) or a vector \(3\)"),
        (WHEN.format(key="wind"), "did you mean 'before_build'"),
        (
            WIND.format(key="wind").replace("Interval(0, 5)", "(0, 5)"),
            r"valid = \(0, 5\) .* an Interval",
        ),
    ],
)
def test_a_broken_plugin_is_named(own_library, text, words):
    path = own_library / "attributes" / "wind.py"
    path.write_text(text)
    with pytest.raises(RtphysError, match=words) as caught:
        attributes()
    assert str(path) in str(caught.value)


def test_a_twin_of_a_bundled_attribute_is_refused(own_library):
    (own_library / "attributes" / "friction.py").write_text(WIND.format(key="friction"))
    with pytest.raises(BadFile, match="exists already"):
        attributes()


def test_an_order_among_attributes_of_one_quantity(own_library):
    folder = own_library / "attributes"
    (folder / "breeze.py").write_text(AFTER.format(key="breeze", after=("wind", "table_tilt")))
    (folder / "wind.py").write_text(WIND.format(key="wind"))
    keys = [attribute.key for attribute in in_order()]
    assert keys.index("wind") < keys.index("breeze")
    assert keys.index("table_tilt") < keys.index("breeze")
    rest = [key for key in keys if key not in ("wind", "breeze", "table_tilt")]
    assert rest == sorted(rest)


def test_a_wrong_order_is_named(own_library):
    folder = own_library / "attributes"
    (folder / "wind.py").write_text(AFTER.format(key="wind", after=("frictoin",)))
    with pytest.raises(UnknownName, match="did you mean 'friction'") as caught:
        attributes()
    assert str(folder / "wind.py") in str(caught.value)
    (folder / "wind.py").write_text(AFTER.format(key="wind", after=("breeze",)))
    (folder / "breeze.py").write_text(AFTER.format(key="breeze", after=("wind",)))
    importlib.import_module("rtphys.physics.attribute")._attributes.cache_clear()
    with pytest.raises(BadFile, match="circle: breeze -> wind -> breeze"):
        attributes()


def test_what_an_attribute_raises_is_named_with_file_and_line(own_library):
    path = own_library / "attributes" / "wind.py"
    path.write_text(WIND.format(key="wind").replace("target.wind = value", "target.blow(value)"))
    line = path.read_text().splitlines().index("        target.blow(value)") + 1
    world = type("World", (), {})()
    with pytest.raises(
        BadFile, match=rf"wind\.apply raises AttributeError.*\(line {line}\)"
    ) as caught:
        enforce(world, Physics({"wind": 2.0}, {"wind"}))
    assert str(path) in str(caught.value)
