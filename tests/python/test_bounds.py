"""No estimate over a ratio exceeds the brightest light that was carried, and gathering bounds every weight."""

from __future__ import annotations

from typing import Any

import numpy as np
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import lumel
from lobes import Run, luminance, measure, plate, seen

ROUNDING = 1 + 1e-5
QUICK = settings(max_examples=40, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow])

tints = st.tuples(*[st.floats(0.05, 0.9)] * 3)
boxes = st.fixed_dictionaries(
    {
        "emissions": st.lists(st.tuples(*[st.floats(0, 10)] * 3), min_size=5, max_size=5).filter(lambda e: max(max(e[0]), max(e[1])) > 0.1),
        "size": st.tuples(st.floats(0.6, 3), st.floats(0.6, 3), st.floats(0.8, 2)),
        "tint": tints,
        "alpha": st.floats(0.05, 0.9),
        "sky": st.booleans(),
        "transport": st.sampled_from(["rays", "walk"]),
        "areas": st.sampled_from(["patches", "pixels"]),
        "gather": st.sampled_from([0.0, 100.0, 1000.0]),
        "defensive": st.sampled_from([0.0, 0.3]),
        "rays": st.sampled_from([2_000, 20_000]),
        "seed": st.integers(0, 2**32),
    }
)


def build(box: dict[str, Any]) -> lumel.Scene:
    """A glossy floor between black walls that shine inwards, each in its own colour: L_in is at most the largest emission of a channel."""
    x, y, z = box["size"]
    walls = [
        plate("back", (-x, y, 0), (2 * x, 0, 0), (0, 0, z), "black"),
        plate("front", (x, -y, 0), (-2 * x, 0, 0), (0, 0, z), "black"),
        plate("left", (-x, -y, 0), (0, 2 * y, 0), (0, 0, z), "black"),
        plate("right", (x, y, 0), (0, -2 * y, 0), (0, 0, z), "black"),
        plate("ceiling", (-x, y, z), (2 * x, 0, 0), (0, -2 * y, 0), "black"),
    ]
    shining = [lumel.Mesh(w.name, w.vertices, w.triangles, "black", emission=e) for w, e in zip(walls, box["emissions"], strict=True)]
    floor = plate("floor", (-x, -y, 0), (2 * x, 0, 0), (0, 2 * y, 0), "tinted")
    scene = seen(floor, *shining[: 4 if box["sky"] else 5], origin=(0.0, -0.5, 0.5))
    return lumel.Scene(
        scene.meshes,
        {**scene.materials, "tinted": lumel.Material("tinted", specular=box["tint"], alpha=box["alpha"])},
        cameras=scene.cameras,
    )


def run(box: dict[str, Any], replicas: int, gather: float, transport: str) -> Run:
    """How a box is measured."""
    return Run(box["rays"], replicas, "weighted", box["defensive"], gather, transport, box["areas"], patches=100)


@QUICK
@given(boxes)
def test_weighted_is_at_most_the_brightest_light_times_the_albedo(box: dict[str, Any]) -> None:
    """Not so for `walk`: a transfer carries the light of one generation alone, and G counts all generations."""
    scene = build(box)
    areas = measure(scene, run(box, 2, box["gather"], "rays"), box["seed"]).areas(0, "weighted")
    brightest = np.max([mesh.emission for mesh in scene.meshes], axis=0)
    # F/G in a channel is a mean of L_in w / lum(w) times a_bar: with one tint, L_in tint / lum(tint) lum(a_s).
    tint = np.array(box["tint"])
    bound = areas["albedo"][:, None] * (brightest * tint / luminance(tint))
    assert np.all(areas["value"] <= bound * ROUNDING + 1e-12)
    assert np.all(areas["value"] >= 0)


@QUICK
@given(boxes)
def test_gathering_bounds_every_weight(box: dict[str, Any]) -> None:
    gathered = 20.0
    gather = gathered * 2**20 / box["rays"]
    session = measure(build(box), run(box, 1, gather, box["transport"]), box["seed"])
    areas = session.areas(0, "weighted")
    # A walk shoots more or fewer rays than it was asked for, and gathers in proportion.
    expected = gathered if box["transport"] == "rays" else gather * session.rays / 2**20
    there = areas["weight"] > 0
    # g/q <= max(g/p_g) / n_g, and g/p_g = lum(tint) G1(wi) / a_bar. What bounds all weights bounds their mean by weight.
    mean_weight = areas["moment.gg"][there] / areas["weight"][there]
    assert np.all(mean_weight <= float(luminance(box["tint"])) / areas["albedo"][there] / expected * ROUNDING)
