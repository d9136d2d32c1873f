"""Ctrl-C: the first ends the batch and keeps the picture, the second stops at once."""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from types import FrameType
from typing import TypeVar

from .errors import STOPPED

T = TypeVar("T")

_SHOW_CURSOR = "\x1b[?25h"


def run_interruptibly(work: Callable[[Callable[[], bool]], T]) -> T:
    """Run `work(interrupted)` so that Ctrl-C is heard at any time: the first makes `interrupted()` true, the second ends the process.

    `work` runs in a thread of its own: Python hands signals to the main thread only, which must not be inside the renderer.
    """
    asked = threading.Event()

    def on_signal(_signal: int, _frame: FrameType | None) -> None:
        if asked.is_set():
            # The renderer's threads cannot be stopped from outside, and files are written in one go: leave without waiting for them.
            if sys.stderr.isatty():
                os.write(2, _SHOW_CURSOR.encode())
            os.write(2, b"\nlumel: stopped; nothing more was written\n")
            os._exit(STOPPED)
        asked.set()
        os.write(2, b"\nlumel: finishing the picture with what is there; Ctrl-C again stops at once\n")

    before = signal.signal(signal.SIGINT, on_signal)
    try:
        with ThreadPoolExecutor(1, thread_name_prefix="render") as pool:
            return pool.submit(work, asked.is_set).result()
    finally:
        signal.signal(signal.SIGINT, before)
