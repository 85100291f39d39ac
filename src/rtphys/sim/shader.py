"""The slim shader pack: SAPIEN's default one with everything removed that no picture of ours uses.

Image-based lighting alone costs 5 CPU-seconds at the first frame (it integrates a BRDF table) and
changes no pixel where no environment map is set. The passes for transparency, lines and points
cost half of each frame on a CPU. The pack is edited at run time from the installed SAPIEN's own
files and cached, so nothing of SAPIEN is copied into this repository.

Slim draws no transparent parts: a material with alpha in (0, 1) comes out opaque.
"""

import hashlib
import itertools
import os
import re
import shutil
import tempfile
from pathlib import Path

from rtphys.errors import RtphysError

_RECIPE = 1  # raise when an edit below changes: it is part of the cache key
_UNUSED_PASSES = ("gbuffer1.*", "line.*", "point.*")


class ShaderMismatch(RtphysError):
    """The installed SAPIEN's shaders are not the ones that the edits were written for."""

    def __init__(self, file: Path, what: str) -> None:
        self.file, self.what = file, what
        super().__init__(f"{file}: {what} not found; SAPIEN's shaders have changed")


def cache_folder() -> Path:
    """Where derived packs live: `$RTPHYS_CACHE`, else `rtphys` in the XDG cache folder."""
    own = os.environ.get("RTPHYS_CACHE")
    if own:
        return Path(own) / "shaders"
    base = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(base) / "rtphys" / "shaders"


def slim_pack(source: Path, version: str, cache: Path) -> Path:
    """Folder of the slim pack, derived on first use.

    Args:
        source: SAPIEN's `vulkan_shader` folder, with `default/` and `common/`.
        version: SAPIEN's version, part of the cache key.
        cache: folder to keep packs in; made if missing.

    Raises:
        ShaderMismatch: an edit finds nothing to edit.
        OSError: the cache cannot be written.
    """
    root = cache / f"slim-{version}-{_digest(source)}"
    if not (root / "slim").is_dir():
        cache.mkdir(parents=True, exist_ok=True)
        work = Path(tempfile.mkdtemp(dir=cache, prefix=".slim-"))
        try:
            shutil.copytree(source / "common", work / "common")  # included as ../common
            shutil.copytree(source / "default", work / "slim")
            _make_slim(work / "slim")
            work.chmod(0o755)
            _publish(work, root)
        finally:
            shutil.rmtree(work, ignore_errors=True)
    return root / "slim"


def _publish(work: Path, root: Path) -> None:
    try:
        work.rename(root)
    except OSError:
        if not (root / "slim").is_dir():  # else another worker was first, with the same content
            raise


def _digest(source: Path) -> str:
    total = hashlib.sha256(f"recipe {_RECIPE}".encode())
    for folder in ("common", "default"):
        for file in sorted((source / folder).iterdir()):
            total.update(file.name.encode())
            total.update(file.read_bytes())
    return total.hexdigest()[:12]


def _make_slim(pack: Path) -> None:
    for pattern in _UNUSED_PASSES:
        files = sorted(pack.glob(pattern))
        if not files:
            raise ShaderMismatch(pack, pattern)
        for file in files:
            file.unlink()
    _edit(pack / "scene_set.glsl", _drop_line("samplerEnvironment"), _drop_line("samplerBRDFLUT"))
    _edit(
        pack / "deferred.frag",
        (r"textureLod\(samplerEnvironment, texcoord, 0\)\.rgb", "vec3(0)"),
        (r"vec3 diffuseIBL\(.*?\n}\n", ""),
        (r"vec3 specularIBL\(.*?\n}\n", ""),
        (r"color \+= diffuseIBL\(.*?\);\n", ""),
        (r"color \+= specularIBL\(.*?camDir\);\n", ""),
        _drop_line("samplerEmission;"),
        (r"vec4 emission = texture\(samplerEmission, inUV\);\n", ""),
        (r"vec3 color = emission\.rgb \* emission\.a;", "vec3 color = vec3(0);"),
    )
    _edit(
        pack / "gbuffer.frag",
        _drop_line("out vec4 outEmission;"),
        (r"  outEmission = materialBuffer\.emission;\n", ""),
        (r"  if \(\(materialBuffer\.textureMask & 16\) != 0\) {\n.*?\n  }\n", ""),
    )
    _edit(
        pack / "composite0.frag",
        _drop_line("samplerLineDepth;"),
        _drop_line("samplerLine;"),
        _drop_line("samplerPointDepth;"),
        _drop_line("samplerPoint;"),
        _drop_line("uniform usampler2D samplerSegmentation;"),
        _drop_line("out vec4 outSegmentationView0;"),
        _drop_line("out vec4 outSegmentationView1;"),
        (r"vec4 colors\[60\] = {.*?};\n", ""),
        (r"  uvec2 seg = .*?(?=  outPosition)", ""),
    )


def _drop_line(mark: str) -> tuple[str, str]:
    return rf"[^\n]*{re.escape(mark)}[^\n]*(\n|$)", ""


def _edit(file: Path, *changes: tuple[str, str]) -> None:
    """Apply regular-expression replacements, each exactly once."""
    text = file.read_text()
    for pattern, replacement in changes:
        text, count = re.subn(pattern, replacement, text, flags=re.DOTALL)
        if count != 1:
            raise ShaderMismatch(file, f"{count} times {pattern!r}, once expected,")
    text = _renumber(text, r"(?<=binding = )\d+(?=\) uniform u?sampler2D sampler\w+;)")
    text = _renumber(text, r"(?<=location = )\d+(?=\) out )")
    file.write_text(text)


def _renumber(text: str, number: str) -> str:
    """Close the gaps that removals leave: SAPIEN indexes what a shader declares without them."""
    count = itertools.count()
    return re.sub(number, lambda _: str(next(count)), text)
