"""The examples run, and leave the pictures that they promise."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
RUNS = {
    "render_file.py": (["lumel:cornell", "1"], ["scene.exr", "scene.png"]),
    "from_arrays.py": (["1"], ["sheet.png"]),
    "many_cameras.py": (["2", "3"], ["view0.png", "view1.png"]),
    "quadrature.py": (["20"], ["quadrature.png"]),
}


def test_every_example_is_run_here_and_short() -> None:
    scripts = sorted(EXAMPLES.glob("*.py"))
    assert [script.name for script in scripts] == sorted(RUNS)
    for script in scripts:
        code = [line for line in script.read_text(encoding="utf-8").splitlines() if line.strip()]
        assert len(code) < 40, script.name


@pytest.mark.parametrize("name", RUNS)
def test_example_leaves_its_pictures(name: str, tmp_path: Path) -> None:
    arguments, files = RUNS[name]
    done = subprocess.run([sys.executable, EXAMPLES / name, *arguments], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(files)
    for path in tmp_path.glob("*.png"):
        picture = np.asarray(Image.open(path).convert("RGB"))
        assert picture.std() > 10, f"{path.name} is all of one colour"
