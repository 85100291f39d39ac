"""The doctor names the right cause, and its exit code is the cause's own."""

import errno
import json
import os
import re
import subprocess
import sys
from importlib import metadata
from pathlib import Path

import pytest

from rtphys import doctor
from rtphys.assets.identity import source_digest
from rtphys.assets.pack import default_pack
from rtphys.core import dependencies, library
from rtphys.core.cache import NoCache
from rtphys.core.errors import BadFile, RtphysError
from rtphys.data.verify import default_path
from rtphys.episode.fingerprint import fingerprint_of
from rtphys.results.instances import (
    BenchmarkInstance,
    Fingerprint,
    InstanceList,
    list_file,
    read_fingerprints,
    write_lists,
)
from rtphys.sim import probe
from rtphys.studies.resources import check_space
from rtphys.task.spec import load_task

NO_DEVICE = {"VK_DRIVER_FILES": "/nowhere.json", "VK_ICD_FILENAMES": "/nowhere.json"}


def child(code: str) -> list[str]:
    return [sys.executable, "-c", code]


def test_every_cause_has_its_own_exit_code_and_a_cure() -> None:
    codes = [cause.exit_code for cause in doctor.CAUSES.values()]
    assert len(set(codes)) == len(codes)
    assert all(cause.cure for name, cause in doctor.CAUSES.items() if name != "ok")


@pytest.mark.parametrize(
    ("code", "cause"),
    [
        ('print(\'{"cause": "ok", "devices": [], "first_frame_s": 1}\')', "ok"),
        ("print('noise'); print('{\"cause\": \"old_driver\"}'); exit(1)", "old_driver"),
        ("import os; os.kill(os.getpid(), 11)", "crashed"),
        ("import os; os.write(2, b'\\xff'); os.kill(os.getpid(), 11)", "crashed"),
        ("import time; time.sleep(60)", "timeout"),
        ("raise ImportError('libX11.so.6: cannot open shared object file')", "no_simulator"),
        ('print(\'{"cause": "something new"}\')', "no_simulator"),
        ("pass", "no_simulator"),
    ],
)
def test_what_the_child_says_or_how_it_dies_is_the_cause(code: str, cause: str) -> None:
    finding = doctor.check_renderer(child(code), limit_s=2.0 if cause == "timeout" else 30.0)
    assert finding.cause == cause
    assert finding.status == ("ok" if cause == "ok" else "fail")
    if cause == "no_simulator" and "libX11" in code:
        assert "libX11.so.6" in finding.detail


@pytest.mark.parametrize(
    ("kinds", "gpus"),
    [
        (["CPU"], 0),
        (["CPU", "discrete GPU", "discrete GPU"], 2),
        (["integrated GPU", "discrete GPU"], 1),
        (["integrated GPU", "CPU"], 1),
    ],
)
def test_the_gpus_that_draw_are_counted_and_the_path_is_named(kinds: list[str], gpus: int) -> None:
    devices = [
        {"name": kind, "api": "1.3.0", "kind": kind, "partially_bound": True} for kind in kinds
    ]
    facts = {"cause": "ok", "devices": devices, "first_frame_s": 0.2}
    finding = doctor.check_renderer(child(f"print({json.dumps(json.dumps(facts))})"))
    assert finding.gpus == gpus
    assert ("drawing workers draw" in finding.detail) == (gpus > 0)


@pytest.mark.parametrize("build", doctor.OPENCV)
def test_either_headless_build_of_opencv_will_do(
    build: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def version(name: str) -> str:
        if name in doctor.OPENCV and name != build:
            raise metadata.PackageNotFoundError(name)
        return "99.0.0"

    monkeypatch.setattr(doctor.metadata, "version", version)
    assert doctor.check_packages().status == "ok"


@pytest.mark.render
def test_the_probe_draws_a_frame_here() -> None:
    cause, facts = doctor.probe(doctor.PROBE, doctor.PROBE_LIMIT)
    assert cause == "ok", facts
    devices = facts["devices"]
    assert isinstance(devices, list) and any(d["partially_bound"] for d in devices)


def test_a_machine_without_a_driver(monkeypatch: pytest.MonkeyPatch) -> None:
    """The real loader, told to use no driver at all."""
    for key, value in NO_DEVICE.items():
        monkeypatch.setenv(key, value)
    monkeypatch.setattr(probe, "_GPU_FILES", ())
    assert probe.load_library() is not None
    finding = doctor.check_renderer()
    assert finding.cause in ("no_driver", "no_permission")
    assert "VK_DRIVER_FILES" in finding.detail


OLD = probe.Device("llvmpipe", "CPU", "1.3.230", partially_bound=False)


@pytest.mark.parametrize(
    ("library", "devices", "cause", "said"),
    [
        (None, [], "no_loader", ""),
        ((None, "libvulkan.so.1"), [OLD], "old_driver", "llvmpipe (Vulkan 1.3.230)"),
        ((None, "libvulkan.so.1"), [], "no_permission", "renderD128"),
    ],
)
def test_what_the_loader_finds_is_the_cause(
    library: tuple[None, str] | None, devices: list[probe.Device], cause: str, said: str,
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path,
) -> None:  # fmt: skip
    (tmp_path / "renderD128").touch()
    monkeypatch.setattr(probe, "_GPU_FILES", (str(tmp_path / "renderD128"),))
    monkeypatch.setattr(probe, "load_library", lambda: library)
    monkeypatch.setattr(probe, "vulkan_devices", lambda library: devices)
    monkeypatch.setattr(os, "access", lambda path, mode: False)  # root may open everything
    answer = probe.probe()
    assert answer["cause"] == cause and said in str(answer.get("detail", ""))


def test_a_missing_system_library_is_named_with_its_package() -> None:
    said = "toppra: libgomp.so.1: cannot open shared object file: No such file or directory"
    finding = doctor.check_compiled(child(f"print({said + ': libgomp1'!r}); exit(1)"))
    assert finding.cause == "not_loadable" and "libgomp1" in finding.detail
    assert dependencies.package_of(said) == "libgomp1"
    assert dependencies.package_of("No module named 'toppra'") is None
    assert doctor.check_compiled(child("import os; os.abort()")).cause == "not_loadable"
    assert doctor.check_compiled().status == "ok"


def test_a_package_that_hangs_does_not_hang_the_doctor(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Nor is it imported here by the check that needs it."""
    hung = doctor.check_compiled(child("import time; time.sleep(60)"), limit_s=1.0)
    assert hung.cause == "not_loadable" and "stopped after 1 s" in hung.detail
    monkeypatch.setattr(doctor, "check_compiled", lambda: hung)
    monkeypatch.setattr(doctor, "check_renderer", lambda: doctor.UNREAD)
    monkeypatch.setattr(doctor, "check_lists", lambda: pytest.fail("imports compiled packages"))
    found = {finding.check: finding for finding in doctor.examine(tmp_path)}
    assert found["compiled packages"] == hung and found["certified lists"].status == "note"


def test_a_file_in_the_current_folder_breaks_no_module(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    (tmp_path / "selectors.py").write_text("raise RuntimeError('a file of the user')")
    monkeypatch.chdir(tmp_path)
    assert doctor.check_compiled().status == "ok"
    assert doctor.probe(doctor.PROBE, doctor.PROBE_LIMIT)[0] == "ok"


def test_a_broken_module_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(dependencies, "MODULES", ("json", "no_such_module_at_all"))
    assert dependencies.failures() == {
        "no_such_module_at_all": "No module named 'no_such_module_at_all'"
    }


def test_full_disk_and_closed_folder(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    inside = tmp_path / "not" / "yet" / "there"
    assert doctor.check_disk("space", inside).status in ("ok", "note")
    usage = type("Usage", (), {"free": 1e8})
    monkeypatch.setattr(doctor.shutil, "disk_usage", lambda path: usage)
    assert doctor.check_disk("space", inside).cause == "no_disk"
    file = tmp_path / "file"
    file.touch()
    for out in (file, file / "below"):
        assert doctor.check_disk("space", out).cause == "not_a_folder"
        with pytest.raises(RtphysError, match=r"where a folder is needed \(.*/file\)"):
            check_space(out, 0.0)
    monkeypatch.setattr(doctor.os, "access", lambda path, mode: False)  # root may write everywhere
    assert doctor.check_disk("space", inside).cause == "not_writable"


@pytest.mark.parametrize("out", ["~", "~x", "~no_such_user/data"])
def test_a_tilde_is_a_name_like_any_other(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, out: str
) -> None:
    """The shell has replaced those that stand for a home; commands write where they are told."""
    monkeypatch.chdir(tmp_path)
    assert str(tmp_path) in doctor.check_disk("space", Path(out)).detail


def test_the_cache_of_another_user(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Built under umask 077, and shared: nothing of it may even be looked for."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.delenv("RTPHYS_ASSETS", raising=False)
    known = Path.is_file

    def is_file(path: Path) -> bool:
        if path.is_relative_to(tmp_path):
            raise PermissionError(errno.EACCES, "Permission denied", str(path))
        return known(path)

    monkeypatch.setattr(Path, "is_file", is_file)
    cure = f"let its owner run `chmod -R a\\+rX {tmp_path}/rtphys`, or set XDG_CACHE_HOME"
    with pytest.raises(NoCache, match=f"this user may not read it; {cure}"):
        default_pack()
    monkeypatch.setattr(doctor, "check_renderer", lambda: 1 / 0)
    found = {finding.check: finding.cause for finding in doctor.examine(tmp_path)}
    assert found["assets"] == found["space for assets"] == "no_cache"
    assert (found["renderer"], found["library"]) == ("unknown", "ok")
    assert found["certified lists"] == "ok", "that it cannot compare them is no failure of its own"


def test_no_home_to_write_to(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "gone"))
    monkeypatch.delenv("RTPHYS_ASSETS", raising=False)

    def mkdir(path: Path, **_: object) -> None:
        raise PermissionError(errno.EACCES, "Permission denied", str(path))

    monkeypatch.setattr(Path, "mkdir", mkdir)
    with pytest.raises(NoCache, match=r"be written here \(Permission denied\); set XDG_"):
        default_pack()
    monkeypatch.setattr(doctor.os, "access", lambda path, mode: False)
    finding = doctor.check_cache()
    assert finding.cause == "no_cache" and "XDG_CACHE_HOME" in finding.cure


@pytest.mark.parametrize("base", ["", "~no_such_user"])
def test_a_user_without_a_home(monkeypatch: pytest.MonkeyPatch, base: str) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", base)
    monkeypatch.setattr(os.path, "expanduser", lambda path: path)
    with pytest.raises(NoCache, match=r"no home folder.*set XDG_CACHE_HOME"):
        default_pack()
    assert default_path() is None


def test_a_package_too_old_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    assert doctor.check_packages().status == "ok"
    real = doctor.metadata.version
    monkeypatch.setattr(
        doctor.metadata, "version", lambda name: "2.9.1" if name == "sapien" else real(name)
    )
    finding = doctor.check_packages()
    assert finding.cause == "old_package" and "sapien 2.9.1 is older than" in finding.detail


def test_versions_that_are_not_the_certified_ones_are_a_note(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    path = doctor.constraints()
    known = dict(re.findall(r"^([\w.-]+)==(\S+)", path.read_text(), re.MULTILINE))
    assert {"numpy", "sapien", "pin"} <= known.keys()
    monkeypatch.setattr(metadata, "version", {**known, "numpy": "2.0.0"}.__getitem__)
    finding = doctor.check_versions()
    assert (finding.status, doctor.exit_code([finding])) == ("note", 0)
    assert f"numpy 2.0.0, not {known['numpy']}" in finding.detail and str(path) in finding.detail
    assert "sapien" not in finding.detail


def test_stale_lists_are_counted_with_the_cause(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    now = fingerprint_of(load_task("click_bell"), "clean", default_pack())

    def write(suite: str, listed: Fingerprint) -> None:
        made = InstanceList("click_bell", "clean", listed, (BenchmarkInstance(1),))
        write_lists(list_file(tmp_path / suite, "clean"), [made])

    write("benchmark", now)
    assert doctor.check_lists(tmp_path).detail == "1 list, none is stale"
    versions = {**now.versions, "code": "old", "numpy": "0.1"}
    write("suite", now.model_copy(update={"versions": versions, "assets": "none"}))
    finding = doctor.check_lists(tmp_path)
    assert (finding.status, doctor.exit_code([finding])) == ("note", 0)
    assert finding.detail.startswith("1 of 2 lists are stale, `rtphys evaluate` refuses them: ")
    assert f"versions.code was 'old', now '{now.versions['code']}' (1)" in finding.detail
    assert "assets was 'none'" in finding.detail and "numpy" not in finding.detail
    monkeypatch.setattr(doctor, "cache_folder", lambda: tmp_path)  # no pack is built there
    detail = doctor.check_lists(tmp_path).detail
    assert "versions.code was" in detail and "assets was" not in detail
    assert "assets were not compared" in detail


def test_the_shipped_lists_are_examined() -> None:
    finding = doctor.check_lists()
    said = re.match(r"(?:\d+ of )?(\d+) lists", finding.detail)
    shipped = (library.bundled() / "manifests").glob("*/*.jsonl")
    assert said and int(said[1]) == sum(len(read_fingerprints(path)) for path in shipped) > 24


def test_assets_that_are_none(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("RTPHYS_ASSETS", str(tmp_path))
    finding = doctor.check_assets()
    assert finding.cause == "bad_assets" and str(tmp_path) in finding.detail


def test_assets_that_a_run_refuses(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """As under systemd or Docker, which leave the tilde of a variable as it is."""
    (tmp_path / "pack" / "objects").mkdir(parents=True)
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setenv("RTPHYS_ASSETS", "~/pack")
    with pytest.raises(BadFile):
        default_pack()
    assert doctor.check_assets().cause == "bad_assets"
    monkeypatch.setenv("RTPHYS_ASSETS", str(tmp_path / "pack"))
    monkeypatch.setenv("RTPHYS_ASSETS_FALLBACK", "builtin")
    assert doctor.check_assets().status == "ok"
    monkeypatch.setenv("RTPHYS_ASSETS_FALLBACK", "bultin")
    assert "did you mean 'builtin'" in doctor.check_assets().detail


def test_the_pack_that_a_run_uses_is_named(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Not one of another version, of which there may be newer ones."""
    monkeypatch.delenv("RTPHYS_ASSETS", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    (other := doctor.cache_folder() / "a_new").mkdir(parents=True)
    (other / doctor.STAMP).write_text("{}")
    assert doctor.check_assets().detail.startswith("not built yet")
    (mine := doctor.cache_folder() / source_digest()[:16]).mkdir()
    (mine / doctor.STAMP).write_text("{}")
    os.utime(mine / doctor.STAMP, (1000, 1000))
    assert doctor.check_assets().detail == f"builtin pack in {mine}"


def test_a_missing_library_folder(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("RTPHYS_LIBRARY", str(tmp_path / "gone"))
    assert doctor.check_library().cause == "bad_library"
    assert doctor.check_lists().cause == "bad_library", "no check failed itself"


def test_command_line(tmp_path: Path) -> None:
    """The whole command on a machine without a driver: JSON, cure and exit code agree."""
    command = [sys.executable, "-m", "rtphys.cli.main", "doctor", "--json", "--out", str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True, env={**os.environ, **NO_DEVICE})
    report = json.loads(done.stdout)
    failed = [f for f in report["findings"] if f["status"] == "fail"]
    assert [f["check"] for f in failed] == ["renderer"]
    assert done.returncode == report["exit_code"] == doctor.CAUSES[failed[0]["cause"]].exit_code
    assert "mesa-vulkan-drivers" in failed[0]["cure"]
