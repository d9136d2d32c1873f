"""Turn exceptions into messages on stderr and exit codes."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager

import typer

from ..errors import LumelError, OutputError, SettingsError

BAD_INPUT = 1  # a scene or picture cannot be read or used
BAD_USAGE = 2  # an unknown flag, or a setting out of its range
CANNOT_WRITE = 3
STOPPED = 130  # by Ctrl-C


@contextmanager
def reporting() -> Iterator[None]:
    """Print every problem of a LumelError, one a line, and exit with the code of its kind."""
    try:
        yield
    except LumelError as error:
        for problem in error.problems:
            print(f"lumel: error: {problem}", file=sys.stderr)
        raise typer.Exit(code_of(error)) from error
    except MemoryError as error:
        print("lumel: error: there is not enough memory for this; smaller pictures and fewer patches need less", file=sys.stderr)
        raise typer.Exit(BAD_INPUT) from error
    except KeyboardInterrupt as error:
        print("lumel: stopped", file=sys.stderr)
        raise typer.Exit(STOPPED) from error


def code_of(error: LumelError) -> int:
    """The exit code for `error`."""
    if isinstance(error, SettingsError):
        return BAD_USAGE
    return CANNOT_WRITE if isinstance(error, OutputError) else BAD_INPUT
