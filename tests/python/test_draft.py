"""Drafts show a picture early, and change nothing of the result."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

import lumel
from lumel import cli
from lumel.images import files
from lumel.result import Result


@pytest.mark.parametrize("transport", ["rays", "walk", "bundles"])
def test_drafts_change_nothing(transport: str) -> None:
    scene, drafts = lumel.load("lumel:demo"), list[Result]()
    settings: dict[str, Any] = {"transport": transport, "size": (32, 24), "patches": 2000}
    settings |= {"directions": 120} if transport == "bundles" else {"rays": 1_200_000}
    with_drafts, without = (lumel.render(scene, **settings, draft=draft) for draft in (drafts.append, None))
    for name, layer in without.pictures["main"].items():
        np.testing.assert_array_equal(with_drafts.pictures["main"][name], layer, err_msg=name)
    assert with_drafts.stats["rays"] == without.stats["rays"]
    assert drafts
    assert float(str(drafts[0].stats["rays"])) < float(str(without.stats["rays"]))
    # The same view: a first draft is off by noise alone.
    assert drafts[0].image().mean() == pytest.approx(without.image().mean(), rel=0.2)


@pytest.mark.parametrize(("progress", "drafts"), [("bar", True), ("plain", False)])
def test_a_bar_comes_with_drafts_in_the_file(progress: str, drafts: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    written: list[list[Path]] = []
    write = files.write_pictures

    def counted(contents: Mapping[Path, bytes]) -> None:
        written.append(list(contents))
        write(contents)

    monkeypatch.setattr(files, "write_pictures", counted)
    out = tmp_path / "a.png"
    flags = ["--rays", "1200000", "--size", "32x24", "--patches", "2000", "--progress", progress, "-o", str(out)]
    ran = CliRunner().invoke(cli.app, ["render", "lumel:demo", *flags])
    assert ran.exit_code == 0, ran.output
    assert all(paths == [out] for paths in written)
    assert (len(written) > 1) == drafts
    assert list(tmp_path.iterdir()) == [out]
