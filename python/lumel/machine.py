"""The machine that measures."""

from __future__ import annotations

import os
import platform
from pathlib import Path


def processors() -> str:
    """Processors that this process may use, and their name."""
    lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    name = next((line.split(":")[1].strip() for line in lines if line.startswith("model name")), platform.processor())
    return f"{len(os.sched_getaffinity(0))} threads of {name or 'an unknown processor'}"


def load() -> float:
    """How many processes wanted to run at once, over the last minute."""
    return os.getloadavg()[0]
