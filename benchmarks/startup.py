"""How long `lumel --help` and the help of every command take, and the demo scene until its first draft is in the file: the best of some
runs. Exits with 1 above the limits."""

from __future__ import annotations

import subprocess
import sys
import tempfile
import time
from pathlib import Path

LIMIT = 0.4  # seconds
LIMIT_OF_DRAFT = 2.0
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


def seconds_to_draft() -> float:
    """Wall time from the start of the process until its output is a picture."""
    times = []
    for _ in range(RUNS):
        with tempfile.TemporaryDirectory() as folder:
            out = Path(folder) / "demo.png"
            begin = time.perf_counter()
            line = [sys.executable, "-m", "lumel", "render", "lumel:demo", "--progress", "bar", "-o", str(out)]
            with subprocess.Popen(line, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
                while not out.exists() and process.poll() is None:
                    time.sleep(0.005)
                times.append(time.perf_counter() - begin)
                process.kill()
    return min(times)


def main() -> int:
    """Print one line for each command."""
    measured = {command: seconds(command) for command in COMMANDS}
    for command, wall in measured.items():
        print(f"lumel {command:7} --help  {wall:.3f} s")
    draft = seconds_to_draft()
    print(f"lumel render lumel:demo, first draft  {draft:.3f} s")
    return int(max(measured.values()) > LIMIT or draft > LIMIT_OF_DRAFT)


if __name__ == "__main__":
    sys.exit(main())
