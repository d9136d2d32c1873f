"""The fenced blocks of README.md: list its commands, or run them as a reader would.

tools/readme.py list                    print the `sh` blocks
tools/readme.py run [--skip COMMAND]    run every `sh` block in the tree, each as one script; COMMAND has just been run elsewhere
"""

from __future__ import annotations

import argparse
import re
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
FENCE = re.compile(r"^```(\w+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def blocks(language: str, text: str | None = None) -> list[str]:
    """The contents of all fenced blocks of `language` in `text` (default: README.md), in order."""
    text = (ROOT / "README.md").read_text(encoding="utf-8") if text is None else text
    return [body for found, body in FENCE.findall(text) if found == language]


def commands(block: str) -> list[str]:
    """The commands of an `sh` block: its lines without comments and empty ones, continued lines joined."""
    lines = (re.sub(r"(^|\s+)#.*", "", line).strip() for line in block.replace("\\\n", " ").splitlines())
    return [line for line in lines if line]


def run(skip: set[str]) -> int:
    """Run each block as one bash script; return the number of blocks that failed."""
    failed = 0
    for block in blocks("sh"):
        script = "\n".join(line for line in commands(block) if line not in skip)
        if not script:
            continue
        print(f"--- README:\n{script}", flush=True)
        started = time.monotonic()
        code = subprocess.run(["bash", "-euo", "pipefail", "-c", script], cwd=ROOT, check=False).returncode
        print(f"--- exit {code} after {time.monotonic() - started:.1f} s", flush=True)
        failed += code != 0
    return failed


def main() -> int:
    """Do what the command line says; the exit code is 1 where a block failed."""
    parser = argparse.ArgumentParser(description="List or run the commands of README.md.")
    parser.add_argument("action", choices=["list", "run"])
    parser.add_argument("--skip", action="append", default=[], metavar="COMMAND", help="leave out this line")
    arguments = parser.parse_args()
    if arguments.action == "list":
        print("\n".join(blocks("sh")), end="")
        return 0
    unknown = set(arguments.skip) - {line for block in blocks("sh") for line in commands(block)}
    if unknown:
        parser.error(f"--skip names what README.md does not say: {', '.join(sorted(unknown))}")
    return 1 if run(set(arguments.skip)) else 0


if __name__ == "__main__":
    sys.exit(main())
