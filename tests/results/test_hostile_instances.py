"""Lists of instances that somebody else wrote: a list, or a sentence, soon."""

from pathlib import Path

import pytest
import yaml
from hostile import NAMES, RAW, VALUES
from time_limit import at_most

from rtphys.core.errors import RtphysError
from rtphys.results.instance_file import read_instances

SOUND = Path(__file__).parents[2] / "manifests/benchmark_v2/clean/click_bell.yaml"
SECONDS = 10
KEYS = tuple(yaml.safe_load(SOUND.read_text()))


def complaint(path: Path, text: str) -> str:
    """What is wrong with the answer to a list; empty if nothing is."""
    path.write_text(text, errors="surrogatepass")
    try:
        with at_most(SECONDS):
            read_instances(path)
    except RtphysError as error:
        return "" if 0 < len(str(error)) < 5000 else f"{text[:80]!r}: says {str(error)[:80]!r}"
    except Exception as error:
        return f"{text[:200]!r} raised {type(error).__name__}: {str(error)[:100]}"
    return ""


@pytest.mark.parametrize(
    "key", [KEYS[-1], *(pytest.param(key, marks=pytest.mark.slow) for key in KEYS[:-1])]
)
def test_a_value_that_does_not_belong_there(key: str, tmp_path: Path) -> None:
    whole, wrong = yaml.safe_load(SOUND.read_text()), []
    for value in (*VALUES, *NAMES):
        odd = yaml.safe_dump({**whole, key: value}, allow_unicode=True)
        wrong.append(complaint(tmp_path / "list.yaml", odd))
        if isinstance(whole[key], list) and whole[key]:
            odd = yaml.safe_dump({**whole, key: [*whole[key], value]}, allow_unicode=True)
            wrong.append(complaint(tmp_path / "list.yaml", odd))
    rest = yaml.safe_dump({name: value for name, value in whole.items() if name != key})
    raws = (*RAW, "*a", "&a [*a]", "!!python/object:os.system x", "!!binary x", "|\n  x")
    wrong += [complaint(tmp_path / "list.yaml", f"{rest}\n{key}: {raw}\n") for raw in raws]
    found = [text for text in wrong if text]
    assert not found, f"{len(found)} of {len(wrong)}:\n" + "\n".join(found)


def test_too_many_instances_are_refused_soon(tmp_path: Path) -> None:
    head = SOUND.read_text().partition("instances:")[0]
    text = head + "instances:\n" + "- [1, ok, null, null]\n" * 40_000
    assert not complaint(tmp_path / "list.yaml", text)


@pytest.mark.parametrize("target", ["/dev/zero", "/etc", "list.yaml"])
def test_a_list_that_is_no_file(target: str, tmp_path: Path) -> None:
    (tmp_path / "list.yaml").symlink_to(target)
    with at_most(SECONDS), pytest.raises(RtphysError):
        read_instances(tmp_path / "list.yaml")
