"""A websocket to a policy server: slow is fine, dead is a typed error."""

import time
from collections.abc import Mapping
from dataclasses import dataclass, field

from websockets.exceptions import ConnectionClosed, InvalidHandshake, InvalidURI
from websockets.sync.client import ClientConnection, connect

from rtphys.core.errors import BadValue, RtphysError
from rtphys.policies.options import Options, number
from rtphys.policies.policy import PolicyGone
from rtphys.policies.served.wire import BadFrame, Encoding

RETRY = 1.0  # [s] between two tries to reach a server that is still loading its weights


class ServerFailed(RtphysError):
    """The server answered with an error of its own: the policy's failure."""


@dataclass(frozen=True)
class Endpoint:
    """Where a server is and how patient to be with it."""

    url: str  # ws://host:port
    encoding: Encoding
    reply_s: float = 600.0  # [s] that one answer may take
    connect_s: float = 30.0  # [s] during which to knock again
    headers: Mapping[str, str] = field(default_factory=dict)


CONNECTION_OPTIONS = ("reply_s", "connect_s")


def endpoint(
    where: str, encoding: Encoding, given: Options, headers: Mapping[str, str] | None = None
) -> Endpoint:
    """From `HOST:PORT` or `ws://HOST:PORT` and the options of a spec string.

    Raises:
        BadValue: no address, or a time that is no number.
    """
    if not where:
        raise BadValue("policy", "", "name the server: HOST:PORT")
    return Endpoint(
        where if "://" in where else f"ws://{where}",
        encoding,
        reply_s=number(given, "reply_s", Endpoint.reply_s),
        connect_s=number(given, "connect_s", Endpoint.connect_s),
        headers=headers or {},
    )


class Connection:
    """One open websocket. Messages are packed with the endpoint's encoding.

    Raises:
        PolicyGone: nobody opened within `connect_s`.
    """

    def __init__(self, endpoint: Endpoint) -> None:
        self.endpoint = endpoint
        self._socket = _open(endpoint)

    def send(self, message: object) -> None:
        """Raises `PolicyGone`, `BadFrame`."""
        packed = self.endpoint.encoding.pack(message)
        try:
            self._socket.send(packed)
        except (ConnectionClosed, OSError) as error:
            raise self._lost(error) from error

    def receive(self) -> object:
        """The next message.

        Raises:
            PolicyGone: it closed, or said nothing for `reply_s`.
            ServerFailed: it sent text, which is its traceback.
            BadFrame: it sent bytes that are no message.
        """
        try:
            raw = self._socket.recv(timeout=self.endpoint.reply_s)
        except TimeoutError as error:
            patience = f"no answer within {self.endpoint.reply_s:g} s"
            raise PolicyGone(self.endpoint.url, patience) from error
        except (ConnectionClosed, OSError) as error:
            raise self._lost(error) from error
        if isinstance(raw, str):
            raise ServerFailed(f"{self.endpoint.url} failed:\n{raw}")
        try:
            return self.endpoint.encoding.unpack(raw)
        except BadFrame as error:
            raise BadFrame(f"{self.endpoint.url}: {error}") from error

    def close(self) -> None:
        self._socket.close()

    def _lost(self, error: Exception) -> PolicyGone:
        return PolicyGone(self.endpoint.url, f"the server is gone: {error}")


def _open(endpoint: Endpoint) -> ClientConnection:
    deadline = time.monotonic() + endpoint.connect_s
    while True:
        try:
            # Entered, because newer releases want it; `close` does what leaving would.
            return connect(
                endpoint.url,
                additional_headers=dict(endpoint.headers),
                compression=None,
                max_size=None,
                # A model that thinks for a minute answers no ping, and would be hung up on.
                ping_interval=None,
                open_timeout=max(endpoint.connect_s, 1.0),
                proxy=None,
            ).__enter__()
        except InvalidURI as error:
            raise PolicyGone(endpoint.url, f"not a websocket address: {error}") from error
        except (OSError, InvalidHandshake, TimeoutError, EOFError) as error:
            if time.monotonic() + RETRY > deadline:
                waited = f"nobody opened within {endpoint.connect_s:g} s"
                raise PolicyGone(endpoint.url, f"{waited}: {error}") from error
            time.sleep(RETRY)
