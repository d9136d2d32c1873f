"""Whether `--time` is kept within 10 % and memory within its bound, and how long the demo takes.

Run it on a quiet machine: `python benchmarks/budgets.py SCENE.xml...`; exits with 1 where a budget is missed.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

BUDGETS = (3.0, 10.0)  # seconds
ROOM = 0.1  # of the budget
MEMORY = {"bust": 400.0}  # MB, of the scenes that have such a bound
DEMO = 30.0  # seconds


def lumel(*args: str) -> tuple[float, float, str]:
    """Run the command: seconds in all, peak memory in MB, stderr."""
    begin = time.monotonic()
    process = subprocess.Popen([sys.executable, "-m", "lumel", *args], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    with process:
        assert process.stderr
        said = process.stderr.read()
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        raise SystemExit(said)
    return time.monotonic() - begin, usage.ru_maxrss / 1024, said


def main(scenes: list[str]) -> int:
    """Print a line for each budget; gives how many were missed."""
    missed = 0
    with tempfile.TemporaryDirectory() as folder:
        for scene in scenes:
            for budget in BUDGETS:
                whole, memory, said = lumel("render", scene, "--time", f"{budget:g}", "--progress", "json", "-o", f"{folder}/a.exr")
                stats = json.loads(said.splitlines()[-1])["stats"]
                kept = abs(stats["time"] / budget - 1) <= ROOM and memory <= MEMORY.get(Path(scene).stem, memory)
                missed += not kept
                print(
                    f"{Path(scene).stem:16} --time {budget:<4g} took {stats['time']:.2f} s ({whole:.2f} s with the start), "
                    f"{memory:.0f} MB, {stats['rays_per_s'] / 1e6:.2f} M rays/s, error {stats['error']:.3g}{'' if kept else '  MISSED'}"
                )
        seconds, memory, _ = lumel("demo", "-o", folder, "--quiet")
        missed += seconds > DEMO
        print(f"{'demo':16} took {seconds:.1f} s, {memory:.0f} MB{'' if seconds <= DEMO else '  MISSED'}")
    return missed


if __name__ == "__main__":
    sys.exit(1 if main(sys.argv[1:] or ["lumel:demo"]) else 0)
