"""Finding a Ray cluster, or making a small one of this machine alone."""

import logging
import os
import signal

import ray

from rtphys.core.errors import RtphysError

OBJECT_STORE = 200_000_000  # [bytes] of a private one: it holds episodes on their way, 2 MB each
CONNECT_SECONDS = 20  # Ray's own patience is minutes


class NoCluster(RtphysError):
    """No Ray cluster where one was said to be."""

    exit_code = 3


def connect(address: str | None = None, workers: int | None = None) -> int:
    """Joins a cluster unless this process is in one; returns how many workers to use.

    Args:
        address: `host:port`; None: `$RAY_ADDRESS`, else the cluster this machine belongs to;
            "local": a private one, which ends with this process.
        workers: None: as many as the cluster has CPUs.

    Raises:
        NoCluster: with the cure.
    """
    os.environ.setdefault("RAY_gcs_rpc_server_reconnect_timeout_s", str(CONNECT_SECONDS))
    os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")  # it would ask, on standard error
    os.environ.setdefault("RAY_ACCEL_ENV_VAR_OVERRIDE_ON_ZERO", "0")  # likewise
    if not ray.is_initialized():
        polite = signal.getsignal(signal.SIGTERM)
        try:
            _init(address, workers)
        except (ConnectionError, TimeoutError, ValueError, RuntimeError) as error:
            cure = "start one with `ray start --head`, or take `--address local`"
            first = (str(error).strip().splitlines() or [type(error).__name__])[0]
            raise NoCluster(f"no Ray cluster at {address or 'hand'}: {first}; {cure}") from error
        finally:
            signal.signal(signal.SIGTERM, polite)  # Ray has put its own in place
    return workers or max(int(ray.cluster_resources().get("CPU", 1)), 1)


def _init(address: str | None, workers: int | None) -> None:
    if address == "local":
        ray.init(
            address="local",
            num_cpus=workers,
            object_store_memory=OBJECT_STORE,
            include_dashboard=False,
            log_to_driver=False,
            logging_level=logging.ERROR,
        )
    else:
        ray.init(address=address or "auto", log_to_driver=False, logging_level=logging.ERROR)
