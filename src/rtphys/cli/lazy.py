"""A command group that imports a command's module only when that command is called."""

import errno
import sys
from collections.abc import Mapping
from importlib import import_module

import typer
from typer.core import TyperGroup

from rtphys.core.errors import RtphysError

# Package -> the optional part of rtphys that brings it.
EXTRAS = {
    "pyarrow": "lerobot",
    "websockets": "serve",
    "msgpack": "serve",
    "gymnasium": "gym",
    "ray": "ray",
}
INTERRUPTED = 130  # what a shell reports for a program stopped by Ctrl-C


class LazyGroup(TyperGroup):
    """Turns every error that a user can cause into one line and an exit code.

    Commands are registered as stubs (name and help); the module `rtphys.cli.<name>` is imported
    when its command is resolved, so `rtphys --help` loads neither SAPIEN nor numpy.
    """

    def resolve_command(self, ctx, args):
        name, stub, rest = super().resolve_command(ctx, args)
        return name, _load(name) if name and stub else stub, rest

    def invoke(self, ctx):
        if ctx.params.get("debug"):
            return super().invoke(ctx)
        try:
            return super().invoke(ctx)
        except RtphysError as error:
            _stop(str(error), error.exit_code)
        except KeyboardInterrupt:
            _stop("stopped", INTERRUPTED)
        except ImportError as error:
            package = (error.name or "").partition(".")[0]
            if package == "rtphys":
                raise
            extra = EXTRAS.get(package)
            cure = f"`pip install 'rtphys[{extra}]'`" if extra else "`rtphys doctor` names the cure"
            _stop(f"{error}; {cure}", 3)
        except BrokenPipeError:
            sys.stdout = None  # whoever read our output has left; the exit flush would complain
            raise typer.Exit(1) from None
        except OSError as error:
            _stop(_sentence(error), 2)


def add_stubs(app: typer.Typer, commands: Mapping[str, str]) -> None:
    """Register name -> help, so that help and "did you mean" know every command."""
    for name, text in commands.items():
        app.command(name, help=text)(_stub)


def _stub() -> None:
    raise RuntimeError("a stub ran: LazyGroup did not resolve the command")


def _load(name: str):
    """The real command: the module's `app`, else the function named after the module."""
    module_name = name.replace("-", "_")
    module = import_module(f"rtphys.cli.{module_name}")
    inner = getattr(module, "app", None)
    if inner is None:
        inner = typer.Typer(add_completion=False)
        inner.command()(getattr(module, module_name))
    return typer.main.get_command(inner)


def _stop(message: str, code: int) -> None:
    typer.echo(f"rtphys: {message}", err=True)
    raise typer.Exit(code)


def _sentence(error: OSError) -> str:
    what = error.strerror or str(error)
    where = f"{error.filename}: " if error.filename else ""
    hint = "; free some space, then repeat the command" if error.errno == errno.ENOSPC else ""
    return f"{where}{what}{hint}"
