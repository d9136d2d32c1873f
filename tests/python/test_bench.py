"""What `lumel bench` says, not how fast it is."""

from __future__ import annotations

import pytest

from lumel.bench import run
from lumel.cli.bench import tell
from lumel.scenes import build


def test_bench_says_what_it_measured() -> None:
    found = run(build("cube"), patches=600, cameras=2, threads=1, rays=4096)
    for which in ("", "_single"):
        embree = found[f"embree{which}_rays_per_s"]
        assert found[f"shooting_over_embree{which}"] == pytest.approx(found["shooting_rays_per_s"] / embree)
        assert found[f"bundles_over_embree{which}"] == pytest.approx(found["bundle_transfers_per_s"] / embree)
    assert found["ordered_rays_per_s"] > 0
    assert found["eye_pixels_per_s"] > 0
    assert found["peak_rss_bytes"] > 0
    assert (found["cameras"], found["threads"], found["triangles"]) == (2, 1, 12)
    assert "2 eyes, 1 thread" in tell(found)
