"""The instruction set that rays are traced with: chosen by name, and no matter for what is computed."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import lumel
from lumel import _core
from lumel.settings import ISAS, Settings
from running import render, run


def test_an_unknown_name_is_told_the_nearest(tmp_path: Path) -> None:
    (problem,) = Settings(isa="avx215").problems()
    assert problem.message == "unknown isa 'avx215'; did you mean 'avx2'? allowed: avx2, avx512"
    for command in (("render", "lumel:cube", "-o", "never.png"), ("bench", "lumel:cube")):
        done = run(*command, "--isa", "sse", cwd=tmp_path)
        assert done.code == 2
        assert "unknown isa 'sse'; allowed: avx2, avx512" in done.err


def test_one_that_the_processor_lacks_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(_core, "isas", lambda: ["avx2"])
    (problem,) = Settings(isa="avx512").problems()
    assert problem.message == "isa is avx512, which this processor does not have; allowed: avx2"


def test_the_best_is_taken_by_default_and_the_result_says_which() -> None:
    scene = lumel.load("lumel:cube")
    assert render(scene, rays=1000, size=(4, 4)).stats["isa"] == _core.isas()[-1]
    assert render(scene, rays=1000, size=(4, 4), isa="avx2").stats["isa"] == "avx2"


def test_pictures_agree_far_within_their_errors() -> None:
    if _core.isas() != list(ISAS):
        pytest.skip("this processor has no AVX-512")
    scene = lumel.load("lumel:cornell")
    two, many = (render(scene, rays=300_000, size=(32, 32), quality="draft", isa=isa).pictures["main"] for isa in ISAS)
    # Rays that hit edges may go either way, and what they carry goes other ways from there on; all others share their random numbers.
    difference, error = two["rgb"] - many["rgb"], np.hypot(two["stderr"], many["stderr"])
    assert np.sqrt(np.mean(difference**2)) < np.sqrt(np.mean(error**2))
    assert np.mean(two["rgb"]) == pytest.approx(np.mean(many["rgb"]), rel=0.01)
