"""What README.md says can be done."""

from __future__ import annotations

import json
import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest
import readme

ROOT = Path(__file__).resolve().parents[2]
LUMEL = [sys.executable, "-m", "lumel"]


def split_commands() -> list[list[str]]:
    """Every command of the `sh` blocks, as words; `a && b` is two."""
    lines = [line for block in readme.blocks("sh") for line in readme.commands(block)]
    return [shlex.split(part) for line in lines for part in line.split("&&")]


def help_of(*command: str) -> str:
    """What `lumel COMMAND --help` prints, on lines wide enough not to break a word."""
    environment = {**os.environ, "COLUMNS": "200", "NO_COLOR": "1", "TERM": "dumb"}
    done = subprocess.run([*LUMEL, *command, "--help"], check=True, capture_output=True, text=True, env=environment)
    return done.stdout


def test_commands_are_read_as_a_shell_reads_them() -> None:
    text = "# title\n\n```sh\nmake demo   # first\n\n# second\nlumel info x \\\n  --json\n```\n\n```python\nimport lumel\n```\n"
    assert [readme.commands(block) for block in readme.blocks("sh", text)] == [["make demo", "lumel info x    --json"]]
    assert readme.blocks("python", text) == ["import lumel\n"]


def test_there_are_commands_and_python() -> None:
    programs = {Path(words[0]).name for words in split_commands()}
    assert {"make", "lumel", "cmake", "ctest", "pip", "setup.sh"} <= programs
    assert len(readme.blocks("python")) == 1


def test_make_targets_exist() -> None:
    targets = set(re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE))
    assert {words[1] for words in split_commands() if words[0] == "make"} <= targets


def test_presets_exist() -> None:
    presets = json.loads((ROOT / "CMakePresets.json").read_text(encoding="utf-8"))
    for words in split_commands():
        if words[0] in {"cmake", "ctest"}:
            kind = "testPresets" if words[0] == "ctest" else "buildPresets" if "--build" in words else "configurePresets"
            assert words[words.index("--preset") + 1] in {preset["name"] for preset in presets[kind]}


def test_linked_files_exist() -> None:
    links = re.findall(r"\]\(([^)#]+)", (ROOT / "README.md").read_text(encoding="utf-8"))
    assert [link for link in links if "://" not in link and not (ROOT / link).exists()] == []


def test_lumel_commands_and_options_exist() -> None:
    wrong = []
    for words in (words for words in split_commands() if Path(words[0]).name == "lumel"):
        options = [word for word in words[2:] if re.match(r"--?[a-z]", word, re.IGNORECASE)]
        known = help_of(words[1])
        wrong += [f"lumel {words[1]} {option}" for option in options if not re.search(rf"(?<![\w-]){option}(?![\w-])", known)]
    assert not wrong


def test_python_block_runs(tmp_path: Path) -> None:
    script = tmp_path / "readme_block.py"
    script.write_text(readme.blocks("python")[0], encoding="utf-8")
    done = subprocess.run([sys.executable, "-W", "error", script.name], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "cornell.exr").stat().st_size > 0


@pytest.mark.parametrize("script", ["tools/setup.sh", "tools/readme.py", ".ci/run"])
def test_scripts_are_executable(script: str) -> None:
    assert os.access(ROOT / script, os.X_OK)
