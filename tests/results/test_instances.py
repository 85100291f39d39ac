"""Certified lists: counts and first episodes; what is written is what is read; damage is named."""

import json
from dataclasses import replace
from pathlib import Path

import pytest
from hostile import NAMES, RAW, VALUES
from time_limit import at_most

from rtphys.core.errors import BadFile, RtphysError
from rtphys.results import instances as module
from rtphys.results.instances import (
    FIRST_SEED,
    BenchmarkInstance,
    DomainDigest,
    Fingerprint,
    InstanceList,
    benchmark_file,
    list_file,
    read_fingerprints,
    read_list,
    read_lists,
    write_lists,
)

FINGERPRINT = Fingerprint(
    domain=DomainDigest(name="global", digest="0" * 64),
    look="",
    assets="1" * 64,
    versions={"task": "2" * 16, "rtphys": "0.1.0"},
)
ROWS = (
    BenchmarkInstance(100000, "", "0123456789012345", True, None),
    BenchmarkInstance(100001, "unreachable"),
    BenchmarkInstance(100002, "", "0e12345678901234", False, True),
    BenchmarkInstance(100003, "slipped"),
    BenchmarkInstance(100004, "unreachable"),
)
LIST = InstanceList("click_bell", "phys_random", FINGERPRINT, ROWS, ("replay",))
SECONDS = 10


def written(folder: Path, *lists: InstanceList) -> Path:
    path = list_file(folder, "phys_random")
    write_lists(path, lists or [LIST])
    return path


def test_the_first_episodes_keep_the_attempts_they_took() -> None:
    part = LIST.first(2)
    assert [one.seed for one in part.instances] == [100000, 100001, 100002]
    assert (part.attempts, len(part.feasible)) == (3, 2)
    assert LIST.first(9).instances == ROWS


def test_what_certification_made_is_told_from_a_datasets_seeds() -> None:
    assert LIST.certified
    seeds = tuple(BenchmarkInstance(row.seed, row.reason) for row in ROWS)
    assert not replace(LIST, instances=seeds).certified


def test_headers_are_read_without_their_rows(tmp_path: Path) -> None:
    path = written(tmp_path)
    path.write_bytes(path.read_bytes().replace(b"[100001", b"[nonsense"))
    with pytest.raises(BadFile):
        read_lists(path)
    assert read_fingerprints(path) == {"click_bell": FINGERPRINT}


def test_a_fingerprint_says_what_keeps_a_list_from_being_used() -> None:
    def now(**changes: object) -> Fingerprint:
        return FINGERPRINT.model_copy(update=changes)

    assert FINGERPRINT.changes(now()) == []
    # Only versions that decide an episode count.
    versions = {**FINGERPRINT.versions, "rtphys": "9.0", "numpy": "3"}
    assert FINGERPRINT.changes(now(versions=versions)) == []
    clauses = ["assets was '%s', now 'a'" % ("1" * 64), "versions.code was None, now 'b'"]
    versions = {**versions, "code": "b"}
    assert FINGERPRINT.changes(now(assets="a", versions=versions)) == clauses
    for key in ("task", "dataset"):
        (clause,) = FINGERPRINT.changes(now(versions={**FINGERPRINT.versions, key: "c"}))
        assert clause.startswith(f"versions.{key} was")
    domain = DomainDigest(name="global", digest="2" * 64)
    for changed in ({"domain": domain}, {"look": "d"}, {"embodiment": "piper"}):
        (clause,) = FINGERPRINT.changes(now(**changed))
        assert clause.startswith(next(iter(changed)))


def test_counts() -> None:
    assert LIST.rejected == {"unreachable": 2, "slipped": 1}
    assert LIST.first_seed == 100000
    assert replace(LIST, instances=()).first_seed == FIRST_SEED


def test_equal_lists_are_equal_bytes(tmp_path: Path) -> None:
    path = written(tmp_path / "made" / "here")
    first = path.read_bytes()
    assert read_list(path, "click_bell") == LIST and read_list(path, "lift_pot") is None
    versions = dict(reversed(FINGERPRINT.versions.items()))
    turned = Fingerprint.model_validate({**FINGERPRINT.model_dump(), "versions": versions})
    write_lists(path, [replace(LIST, fingerprint=turned)])
    assert path.read_bytes() == first and first.count(b"\n") == 1 + len(ROWS)
    assert b"embodiment" not in first, "it stands where it is not the usual robot"


@pytest.mark.parametrize("rows", [ROWS[:1], ROWS[1:2], ()])
def test_a_list_may_hold_one_kind_alone_or_nothing(tmp_path: Path, rows) -> None:
    known = read_list(written(tmp_path, replace(LIST, instances=rows)), "click_bell")
    assert known is not None and known.instances == rows


def test_one_task_is_replaced_and_the_others_stay_byte_for_byte(tmp_path: Path) -> None:
    others = [replace(LIST, task=task) for task in ("lift_pot", "adjust_bottle")]
    path = written(tmp_path, LIST, *others)
    before = path.read_bytes().splitlines()
    write_lists(path, [replace(LIST, instances=ROWS[:1])])
    assert list(read_lists(path)) == ["adjust_bottle", "click_bell", "lift_pot"]
    after = path.read_bytes().splitlines()
    assert after[:6] == before[:6] and after[8:] == before[12:] and len(after) == 14
    write_lists(path, [LIST])
    assert path.read_bytes().splitlines() == before


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('"format": 2', '"format": 9', "format: input should be 2"),
        ("[100002,", "[100009,", "a seed is missing"),
        ('"attempts": 5', '"attempts": 6', "attempts are 6, but it holds 5 seeds"),
        ('"feasible": 2', '"feasible": 3', "3 are feasible, but it holds 2"),
        ('"unreachable"]\n', '"unreach', "last line is cut short"),
        ('{"task"', '["task"', "is no file of certified lists"),
        ("true, null", "1, null", "3: input should be a valid boolean"),
        ('"assets":', '"asset":', r"fingerprint\.assets: field required"),
        ("[100000", "[true", "0: input should be a valid integer"),
        ("[100003", '["three"', "0: input should be a valid integer"),
        ('"slipped"]', "3]", "1: input should be a valid string"),
        ('"slipped"]', "]", "invalid json"),
    ],
)
def test_damage_is_named_with_its_line(tmp_path: Path, old: str, new: str, said: str) -> None:
    path = written(tmp_path)
    text = path.read_text()
    assert old in text
    head, _, tail = text.rpartition(old)
    path.write_text(head + new + ("" if new == '"unreach' else tail))
    with pytest.raises(BadFile, match=said) as error:
        read_list(path, "click_bell")
    assert str(path) in str(error.value)


def test_a_second_list_of_a_task_is_refused(tmp_path: Path) -> None:
    path = written(tmp_path)
    path.write_bytes(path.read_bytes() * 2)
    with pytest.raises(BadFile, match="line 7: is a second list of click_bell"):
        read_lists(path)


# ---- files that somebody else wrote: a list, or a sentence, soon --------------------------------


def complaint(path: Path, text: str) -> str:
    """What is wrong with the answer to a file; empty if nothing is."""
    path.write_text(text, errors="surrogatepass")
    try:
        with at_most(SECONDS):
            read_lists(path)
    except RtphysError as error:
        return "" if 0 < len(str(error)) < 5000 else f"{text[:80]!r}: says {str(error)[:80]!r}"
    except Exception as error:
        return f"{text[:200]!r} raised {type(error).__name__}: {str(error)[:100]}"
    return ""


def test_values_that_do_not_belong_there(tmp_path: Path) -> None:
    path, wrong = tmp_path / "clean.jsonl", list[str]()
    with benchmark_file("clean", "click_bell").open() as lines:
        head, *rows = [next(lines) for _ in range(101)]
    header, row = json.loads(head), json.loads(rows[0])
    for value in (*VALUES, *NAMES):
        odd = [json.dumps({**header, key: value}) + "\n" + "".join(rows) for key in header]
        odd += [head + json.dumps([*row[:n], value, *row[n + 1 :]]) + "\n" for n in range(6)]
        wrong += [complaint(path, text) for text in odd]
    for raw in (*RAW, "{" * 10_000, "[" * 10_000, '{"task": "a", "task": "b"}', "\0"):
        wrong += [complaint(path, text) for text in (raw + "\n", head + raw + "\n")]
    found = [text for text in wrong if text]
    assert not found, f"{len(found)} of {len(wrong)}:\n" + "\n".join(found)


def test_what_would_not_be_read_is_not_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = (path := written(tmp_path)).read_bytes()
    monkeypatch.setattr(module, "LIST_BYTES", len(before))
    with pytest.raises(BadFile, match=r"phys_random\.jsonl: its lists would have .* MB"):
        write_lists(path, [replace(LIST, task="press_bell")])
    assert path.read_bytes() == before and read_list(path, LIST.task) == LIST


def test_too_many_instances_are_refused_soon(tmp_path: Path) -> None:
    head = benchmark_file("clean", "click_bell").read_text().partition("\n")[0]
    assert not complaint(tmp_path / "list.jsonl", head + "\n" + '[1, ""]\n' * 1_000_000)
    assert not complaint(tmp_path / "list.jsonl", head + "\n" + '[1, ""]\n' * 3_000_000)


@pytest.mark.parametrize("target", ["/dev/zero", "/etc", "list.jsonl"])
def test_a_file_of_lists_that_is_no_file(target: str, tmp_path: Path) -> None:
    (tmp_path / "list.jsonl").symlink_to(target)
    with at_most(SECONDS), pytest.raises(RtphysError):
        read_lists(tmp_path / "list.jsonl")
