"""Ctrl-C, sent to a process of its own: the first keeps the picture, the second stops at once."""

from __future__ import annotations

import signal
import subprocess
import sys
import time
from pathlib import Path

from lumel.images import read_picture

# A renderer that obeys only as told, and never hands the interpreter back by itself for longer than a moment.
PROGRAM = """
import dataclasses, sys, time
from types import ModuleType
sys.path.insert(0, {tests!r})
from cli_core import FakeCore
core = FakeCore()

def render(scene, **settings):
    while not ({obeys} and settings["interrupted"]()):
        print("running", file=sys.stderr, flush=True)
        time.sleep(0.05)
    result = core.render(scene, **settings)
    return dataclasses.replace(result, stats={{**result.stats, "interrupted": True}})

for name, function in (("render", render), ("readers", core.load)):
    module = sys.modules["lumel." + name] = ModuleType("lumel." + name)
    setattr(module, "load" if name == "readers" else name, function)

from lumel.cli import main
sys.argv = ["lumel", "render", "s", "-o", {output!r}, "--progress", "plain"]
main()
"""


def start(output: Path, *, obeys: bool) -> subprocess.Popen[str]:
    """Begin a render that goes on until it is stopped; returns when it runs."""
    program = PROGRAM.format(tests=str(Path(__file__).parent), output=str(output), obeys=obeys)
    process = subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert process.stderr
    for line in process.stderr:
        if line == "running\n":
            return process
    raise AssertionError("the render did not start")


def test_first_ctrl_c_writes_the_picture(tmp_path: Path) -> None:
    process = start(tmp_path / "a.exr", obeys=True)
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=30)
    assert process.returncode == 0
    assert "finishing the picture" in err
    assert "stopped early" in out
    assert "1 k rays" in out
    assert read_picture(tmp_path / "a.exr").layers["rgb"].shape == (8, 12, 3)


def test_second_ctrl_c_stops_at_once_and_leaves_nothing(tmp_path: Path) -> None:
    process = start(tmp_path / "a.exr", obeys=False)
    process.send_signal(signal.SIGINT)
    time.sleep(0.3)
    assert process.poll() is None
    begin = time.monotonic()
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=30)
    assert time.monotonic() - begin < 5
    assert process.returncode == 130
    assert "nothing more was written" in err
    assert "Traceback" not in err
    assert out == ""
    assert not list(tmp_path.iterdir())
