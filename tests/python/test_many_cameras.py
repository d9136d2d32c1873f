"""Gathering does not outgrow shooting, however many cameras look."""

from __future__ import annotations

import sys
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import lumel


def test_many_cameras_get_fewer_gathering_rays_and_see_the_same_light(monkeypatch: pytest.MonkeyPatch) -> None:
    scene = lumel.load("lumel:cornell")
    crowd = replace(scene, cameras=tuple(replace(scene.cameras[0], name=f"eye {i}") for i in range(6)))
    work: dict[str, Any] = {"rays": 1_000_000, "patches": 2000, "size": (32, 24), "camera": "all", "quality": "draft"}
    asked = lumel.render(crowd, **work, gather=16)
    monkeypatch.setattr(sys.modules["lumel.render"], "MOST_GATHERING", 1e-4)
    limited = lumel.render(crowd, **work)
    # What glossy areas count as samples tells that fewer rays are gathered.
    hits = [float(np.sum(result.layer("hits", "eye 0"))) for result in (asked, limited)]
    assert 0 < hits[1] < 0.99 * hits[0]
    means = [float(np.mean(result.image("eye 0"))) for result in (asked, limited)]
    stderr = [float(np.mean(result.layer("stderr", "eye 0"))) for result in (asked, limited)]
    assert abs(means[0] - means[1]) < sum(stderr)
