"""How long `lumel --help` and the help of every command take, the best of some runs; exits with 1 above the limit."""

from __future__ import annotations

import subprocess
import sys
import time

LIMIT = 0.4  # seconds
RUNS = 5
COMMANDS = ("", "render", "info", "compare", "demo", "bench")


def seconds(command: str) -> float:
    """Wall time of the fastest of RUNS."""
    line = [sys.executable, "-m", "lumel", *command.split(), "--help"]
    times = []
    for _ in range(RUNS):
        begin = time.perf_counter()
        subprocess.run(line, check=True, stdout=subprocess.DEVNULL)
        times.append(time.perf_counter() - begin)
    return min(times)


def main() -> int:
    """Print one line for each command."""
    measured = {command: seconds(command) for command in COMMANDS}
    for command, wall in measured.items():
        print(f"lumel {command:7} --help  {wall:.3f} s")
    return int(max(measured.values()) > LIMIT)


if __name__ == "__main__":
    sys.exit(main())
