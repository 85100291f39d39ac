"""The program of a worker process: `python -m rtphys.campaign.workers.worker FD PARENT`.

It reads its import path, then a pickled `setup`, then jobs; it answers each job. It imports nothing
of a robot itself, so that what it cannot load is told to the supervisor like any other error.
"""

import ctypes
import os
import signal
import sys
import traceback
from multiprocessing.connection import Connection

from rtphys.campaign.workers.pool import WorkerFailed
from rtphys.core.errors import RtphysError

PR_SET_PDEATHSIG = 1  # <linux/prctl.h>


def main(connection: Connection, parent: int) -> None:
    """Serve until the supervisor hangs up or dies."""
    # An orphan would write into a folder that the next run has locked.
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != parent:  # it died before the line above
        os._exit(1)
    try:
        sys.path[:] = connection.recv()
        work = connection.recv()()
        connection.send("ready")
        while True:
            connection.send(work(connection.recv()))
    except (EOFError, BrokenPipeError):
        return
    except RtphysError as error:
        connection.send(WorkerFailed(str(error), error.exit_code))
    except BaseException as error:  # told to the supervisor, who stops the run
        text = f"{type(error).__name__}: {error}"
        connection.send(WorkerFailed(text, trace=traceback.format_exc()))


if __name__ == "__main__":
    handle = int(sys.argv[1])
    os.set_inheritable(handle, False)  # a child of ours would keep the line open after our death
    main(Connection(handle), int(sys.argv[2]))
    sys.stdout.flush()
    os._exit(0)  # SAPIEN's teardown may abort; nothing is left to be done
