"""Instructions that three hot paths take, beside those of the last release; exits with 1 where one takes more than the room for it.

Counted by callgrind, so load on the machine does not matter; the compiler and Embree's version do. `--update` keeps the new counts.
Run it with valgrind installed: `python benchmarks/kernels.py [--update]`.
"""

from __future__ import annotations

import json
import re
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
KEPT = Path(__file__).with_suffix(".json")
BUILD = ROOT / "build" / "kernels"
UNITS = {"shoot": ("ray", 1 << 16), "shoot-16": ("ray", 1 << 16), "eye": ("sample", 64 * 48 * 8)}
"""What is counted, and for how many: one step with one eye, one with sixteen, and one eye pass (benchmarks/kernels.cpp)."""
ROOM = 0.03  # of the count


def build() -> Path:
    """The program with the kernels."""
    for line in (
        ["cmake", "-S", ROOT, "-B", BUILD, "-DCMAKE_BUILD_TYPE=Release", "-DLUMEL_BENCHMARKS=ON"],
        ["cmake", "--build", BUILD, "--target", "lumel_kernels", "--parallel"],
    ):
        subprocess.run(line, check=True, stdout=subprocess.DEVNULL)
    return BUILD / "lumel_kernels"


def count(program: Path, kernel: str) -> int:
    """Instructions in the part of `kernel` that counts."""
    with tempfile.NamedTemporaryFile() as out:
        line = ["valgrind", "--tool=callgrind", "--toggle-collect=counted_*", f"--callgrind-out-file={out.name}", program, kernel]
        said = subprocess.run(line, check=True, capture_output=True, text=True).stderr
    found = re.search(r"Collected : (\d+)", said)
    if not found:
        raise SystemExit(said)
    return int(found[1])


def main(update: bool) -> int:
    """Print a line for each kernel; gives how many have grown too much."""
    program = build()
    kept: dict[str, int] = json.loads(KEPT.read_text()) if KEPT.exists() else {}
    counts = {kernel: count(program, kernel) for kernel in UNITS}
    grown = 0
    for kernel, found in counts.items():
        unit, units = UNITS[kernel]
        ratio = found / kept.get(kernel, found)
        grown += ratio > 1 + ROOM
        print(f"{kernel:9} {found / units:8.1f} instructions a {unit}, {ratio:.3f} of the last release{'  GROWN' * (ratio > 1 + ROOM)}")
    if update:
        KEPT.write_text(json.dumps(counts, indent=2) + "\n")
    return 0 if update else grown


if __name__ == "__main__":
    sys.exit(main("--update" in sys.argv[1:]))
