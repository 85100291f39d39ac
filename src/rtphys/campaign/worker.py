"""The processes that do the jobs: a server that has imported all, and the workers it forks.

`python -m rtphys.campaign.worker FD PARENT` is the server: a fresh interpreter, because a process
that has drawn pictures or has threads cannot be forked. It has neither, so a worker costs a fork.
"""

import atexit
import ctypes
import gc
import os
import pickle
import signal
import sys
import traceback
from collections.abc import Callable
from contextlib import suppress
from multiprocessing.connection import Connection, wait
from multiprocessing.reduction import recv_handle

from rtphys.campaign.pool import Setup, WorkerError
from rtphys.core import arithmetic
from rtphys.core.errors import RtphysError

LOADED = "rtphys_"  # how the modules' names begin that `load_file` makes up
SERVER, WORKER = "rtphys-server", "rtphys-worker"  # as `ps -e` shows them
PR_SET_PDEATHSIG, PR_SET_NAME = 1, 15  # <linux/prctl.h>


class _Gone(Exception):
    """The supervisor has closed the line, or died."""


def serve(line: Connection) -> tuple[Connection, bytes]:
    """The server: imports what `setup` needs, then forks workers. Ends with its supervisor.

    It receives an import path, a pickled setup, and then numbers: 0 asks for a worker, and the
    handles of its line, standard output and standard error follow; any other is a worker to kill.
    It sends (process, None) when a worker begins and (process, exit code) when it has ended.

    Returns in a worker alone: its line, and the pickled setup.
    """
    _name(SERVER)
    sys.path[:] = line.recv()
    setup = line.recv_bytes()
    gc.disable()  # it would look through all that is imported, again and again
    with suppress(BaseException):  # each worker meets it again, and says so
        if isinstance(made := pickle.loads(setup), Setup):
            made.warm()
    gc.freeze()  # else the first collection in each worker copies all that was imported
    gc.enable()
    workers = dict[int, int]()  # by the handle that tells of its end
    while True:
        for ready in wait([line, *workers]):
            if isinstance(ready, int):
                pid = workers.pop(ready)
                os.close(ready)
                code = os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1])
                with suppress(OSError):
                    line.send((pid, code))
                continue
            try:
                doomed = line.recv()
            except (EOFError, OSError):
                os._exit(0)  # and all workers with it
            if doomed:
                if doomed in workers.values():
                    os.kill(doomed, signal.SIGKILL)
                continue
            handles = [recv_handle(line) for _ in range(3)]
            sys.stdout.flush()
            server = os.getpid()
            pid = os.fork()
            if not pid:
                _die_with(server)
                for number, handle in enumerate(handles[1:], start=1):
                    os.dup2(handle, number)
                for handle in (*handles[1:], *workers):
                    os.close(handle)
                line.close()
                return Connection(handles[0]), setup
            for handle in handles:
                os.close(handle)
            workers[os.pidfd_open(pid)] = pid
            line.send((pid, None))


def work(line: Connection, pickled: bytes) -> None:
    """The worker: does jobs until nobody sends any more.

    A `Setup` closes what its jobs have left open.
    """
    _name(WORKER)
    os.register_at_fork(after_in_child=line.close)  # who outlives us must not hide our death
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # somebody else's: no exception of the job
    if cv2 := sys.modules.get("cv2"):
        cv2.setNumThreads(0)  # there is a worker a core, and a picture is one thread's work
    if numpy := sys.modules.get("numpy"):
        numpy.random.seed()  # the code of users that forgot to must not draw the same everywhere
    setup: Callable[[], Callable[[object], object]] | None = None
    try:
        setup = pickle.loads(pickled)
        assert setup is not None
        do = setup()
        _send(line, "ready")
        while True:
            try:
                job = line.recv()
            except (EOFError, ConnectionError) as error:
                raise _Gone from error
            result = do(job)
            sys.stdout.flush()  # what the job has printed is shown with its result
            _send(line, result)
    except _Gone:
        with suppress(Exception):  # nobody listens any more
            if isinstance(setup, Setup):
                setup.finish()
    except MemoryError:  # the machine's trouble, as where the kernel is faster
        os.kill(os.getpid(), signal.SIGKILL)
    except RtphysError as error:
        _send(line, WorkerError(f"{error}{_user_line(error)}", error.exit_code))
    except BaseException as error:  # sent to the supervisor, who stops the run
        text = f"{type(error).__name__}: {error}{_user_line(error)}"
        _send(line, WorkerError(text, trace=traceback.format_exc()))


def _send(line: Connection, message: object) -> None:
    try:
        line.send(message)
    except ConnectionError as error:
        raise _Gone from error


def _user_line(error: BaseException) -> str:
    """` (FILE, line 12)`: where an error left a file that `load_file` has loaded, if it did."""
    for frame, line in reversed(list(traceback.walk_tb(error.__traceback__))):
        if str(frame.f_globals.get("__name__", "")).startswith(LOADED):
            return f" ({frame.f_code.co_filename}, line {line})"
    return ""


def _die_with(parent: int) -> None:
    """An orphan would write into a folder that the next run has locked."""
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != parent:  # it died before the line above
        os._exit(1)


def _name(text: str) -> None:
    ctypes.CDLL(None).prctl(PR_SET_NAME, text.encode())


def _leave() -> None:
    """Ends the process without tearing libraries down: SAPIEN's may abort."""
    sys.stdout.flush()
    os._exit(0)


if __name__ == "__main__":
    _die_with(int(sys.argv[2]))
    arithmetic.pin()
    handle = int(sys.argv[1])
    os.set_inheritable(handle, False)  # a child of ours would keep the line open after our death
    # Registered first, it runs last: after what the jobs' libraries have registered for the end.
    atexit.register(_leave)
    work(*serve(Connection(handle)))
