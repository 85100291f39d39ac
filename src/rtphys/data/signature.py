"""SSH signatures of a manifest, checked by OpenSSH's own `ssh-keygen`.

A dataset is signed with `ssh-keygen -Y sign -n rtphys -f KEY manifest.json`, which writes
`manifest.json.sig` beside it. The manifest lists the SHA-256 of every file.
"""

import subprocess
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from rtphys.core.bounds import LONGEST_SIGNATURE
from rtphys.core.errors import BadFile, RtphysError, shortened
from rtphys.data import files
from rtphys.data.layout import MANIFEST, SIGNATURE

NAMESPACE = "rtphys"  # a signature of a mail or a commit by the same key is none of a dataset
SECONDS = 30.0


class NoKeygen(RtphysError):
    """OpenSSH is not installed."""

    exit_code = 3

    def __init__(self) -> None:
        super().__init__("ssh-keygen, which checks signatures, is not here: install openssh-client")


def signer(out: Path, manifest: bytes, allowed: Path) -> str:
    """Who of the allowed signers signed the manifest with these bytes.

    Args:
        out: the dataset's folder, which holds the signature.
        allowed: a file in the format of ssh-keygen's ALLOWED SIGNERS: a name and a public key a
            line.

    Raises:
        BadFile: there is no signature, or it is none of theirs.
        NoKeygen: ssh-keygen is not installed.
    """
    path = out / SIGNATURE
    signature = files.read(path, LONGEST_SIGNATURE)
    if not allowed.is_file():
        raise BadFile(allowed, "no such file; write a name and a public key a line")
    with TemporaryDirectory(prefix="rtphys-signature-") as folder:
        copy = Path(folder) / "sig"  # what is checked is what was read
        copy.write_bytes(signature)
        given = ["-s", str(copy), "-f", str(allowed)]
        found = _keygen(["find-principals", *given], b"")
        names = found.stdout.decode(errors="replace").splitlines()
        for name in names:
            check = ["verify", *given, "-n", NAMESPACE, "-I", name]
            if _keygen(check, manifest).returncode == 0:
                return name
    if names:
        raise BadFile(path, f"is of {shortened(names[0])}, but not of this {out / MANIFEST}")
    said = shortened(found.stderr.decode(errors="replace").strip())
    raise BadFile(path, f"is of none of the signers in {allowed} ({said})")


def _keygen(words: Sequence[str], data: bytes) -> subprocess.CompletedProcess[bytes]:
    command = ["ssh-keygen", "-Y", *words]
    try:
        return subprocess.run(command, input=data, capture_output=True, timeout=SECONDS)
    except FileNotFoundError as error:
        raise NoKeygen from error
    except subprocess.TimeoutExpired as error:
        raise RtphysError(f"ssh-keygen did not answer within {SECONDS:g} s") from error
