"""95 % intervals hold the truth 95 times of 100: irradiance of patches, and every estimator on gloss."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest

import lumel
from lobes import MATERIALS, Floats, Run, measure, seen
from lumel import _core
from lumel.quadrature.student import t_quantile
from lumel.readers.primitives import sphere
from running import quad, render

REPLICAS = 16
BANDS = 10
RAYS = 4_000_000  # some 250 hits an area and replica: Student's law wants replicas whose means are nearly normal
ALLOWED = (0.93, 0.97)


@dataclass
class Covered:
    """Counts of intervals, and of those that hold the truth."""

    intervals: int = 0
    held: int = 0

    def add(self, value: Floats, variance: Floats, truth: Floats) -> None:
        """Count the values (n, 3) with a variance."""
        there = variance > 0
        within = np.abs(value - truth) <= t_quantile(0.95, REPLICAS - 1) * np.sqrt(variance)
        self.intervals += int(there.sum())
        self.held += int((within & there).sum())

    @property
    def share(self) -> float:
        """Held of all, 0..1."""
        return self.held / self.intervals


def banded_sphere(*inside: lumel.Mesh) -> tuple[lumel.Scene, float]:
    """A unit sphere whose exitance and albedo vary over its height, and the irradiance that is the same all over it, W/m2."""
    vertices, triangles, _ = sphere(3).flipped().arrays()
    corners = vertices[triangles].astype(np.float64)
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
    height = corners.mean(axis=1)[:, 2]
    band = np.clip(((height + 1) / 2 * BANDS).astype(int), 0, BANDS - 1)
    radiance, albedo = 0.2 + np.linspace(0, 1, BANDS) ** 2, np.linspace(0.7, 0.2, BANDS)
    materials = {f"band {i}": lumel.Material(f"band {i}", diffuse=(float(albedo[i]),) * 3) for i in range(BANDS)}
    meshes = [lumel.Mesh(n, vertices, triangles[band == i], n, emission=(float(radiance[i]),) * 3) for i, n in enumerate(materials)]
    exitance = np.pi * np.average(radiance[band], weights=area)
    scene = seen(*inside, *meshes, origin=(0, -0.5, 0.4))
    irradiance = float(exitance / (1 - np.average(albedo[band], weights=area)))
    return lumel.Scene(scene.meshes, {**MATERIALS, **materials}, cameras=scene.cameras), irradiance


def plate_of_many(size: float = 0.6, parts: int = 4) -> lumel.Mesh:
    """A glossy square on z = 0 of parts x parts squares."""
    step = size / parts
    corners = [(-size / 2 + step * i, -size / 2 + step * j) for i in range(parts) for j in range(parts)]
    quads = [quad("gloss", [(x, y, 0), (x + step, y, 0), (x + step, y + step, 0), (x, y + step, 0)], "gloss") for x, y in corners]
    vertices = np.concatenate([q.vertices for q in quads])
    triangles = np.concatenate([q.triangles + 4 * i for i, q in enumerate(quads)])
    return lumel.Mesh("gloss", vertices, triangles.astype(np.int32), "gloss")


def front_irradiance(session: _core.Session) -> tuple[Floats, Floats]:
    """Values and variances (P, 3) on the fronts, direct light included."""
    (direct, direct_variance), (shot, shot_variance) = session.direct(), session.indirect()
    return np.asarray(direct[0] + shot[0], np.float64), np.asarray(direct_variance[0] + shot_variance[0], np.float64)


def sphere_covered(transport: str, seeds: int) -> Covered:
    """Irradiance in a sphere of any exitance and albedo."""
    scene, truth = banded_sphere()
    covered = Covered()
    for seed in range(seeds):
        run = Run(400_000, REPLICAS, "weighted", gather=0.0, transport=transport)
        covered.add(*front_irradiance(measure(scene, run, seed)), np.full(3, truth))
    return covered


def cube_covered(transport: str, seeds: int) -> Covered:
    """Irradiance of the patches of the cube, against a run fifty times as long."""
    scene, run = lumel.load("lumel:cube"), Run(200_000, REPLICAS, "weighted", gather=0.0, transport=transport, patches=300)
    truth, _ = front_irradiance(measure(scene, replace(run, rays=10_000_000, transport="rays"), 999))
    covered = Covered()
    for seed in range(seeds):
        covered.add(*front_irradiance(measure(scene, run, seed)), truth)
    return covered


def gloss_covered(transport: str, seeds: int, gather: float, areas: str = "patches") -> dict[str, Covered]:
    """Gloss in a sphere, by estimator."""
    scene, _ = banded_sphere(plate_of_many())
    # The truth of so many rays that its own error hardly counts, of the solve either.
    truth = measure(scene, Run(10 * RAYS, REPLICAS, "weighted", gather=4096.0, areas=areas), 999).areas(0, "weighted")["value"]
    covered = {name: Covered() for name in _core.estimators()}
    for seed in range(seeds):
        session = measure(scene, Run(RAYS, REPLICAS, "weighted", gather=gather, transport=transport, areas=areas), seed)
        for name, counts in covered.items():
            measured = session.areas(0, name)
            counts.add(measured["value"], measured["variance"], truth)
    return covered


def assert_honest(covered: Covered, what: str) -> None:
    assert ALLOWED[0] <= covered.share <= ALLOWED[1], f"{what}: {covered.share:.4f} of {covered.intervals}"


@pytest.mark.parametrize("transport", ["rays", "walk"])
def test_intervals_of_irradiance(transport: str) -> None:
    assert_honest(sphere_covered(transport, 5), f"sphere, {transport}")


@pytest.mark.slow
@pytest.mark.timeout(3000)
@pytest.mark.parametrize("transport", ["rays", "walk"])
def test_intervals_of_irradiance_over_200_seeds(transport: str) -> None:
    assert_honest(sphere_covered(transport, 200), f"sphere, {transport}")
    assert_honest(cube_covered(transport, 200), f"cube, {transport}")


@pytest.mark.slow
@pytest.mark.timeout(3000)
@pytest.mark.parametrize("gather", [0.0, 40.0])
@pytest.mark.parametrize("transport", ["rays", "walk"])
def test_intervals_of_gloss_over_200_seeds(transport: str, gather: float) -> None:
    for name, covered in gloss_covered(transport, 200, gather).items():
        assert_honest(covered, f"{name}, {transport}, {gather:g} gathered")


def test_results_give_intervals() -> None:
    result = render(lumel.load("lumel:cube"), rays=400_000, patches=300, size=(8, 6), quality="draft")
    replicas = result.patches.replicas
    assert replicas == result.stats["replicas"]
    for level in (0.5, 0.95):
        t = t_quantile(level, replicas - 1)
        np.testing.assert_allclose(result.interval(level), t * result.stderr(), rtol=1e-6)
        np.testing.assert_allclose(result.patches.interval(level), t * result.patches.stderr, rtol=1e-6)
    with pytest.raises(lumel.SettingsError, match=r"level: 1\.5; allowed"):
        result.interval(1.5)
    with pytest.raises(lumel.SettingsError, match="unknown camera 'x'"):
        result.interval(camera="x")
