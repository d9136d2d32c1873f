"""What stands behind the command line in its tests: a reader and a renderer that answer at once and remember what they were asked."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from lumel.errors import LumelError
from lumel.progress import Progress
from lumel.result import LAYERS, Patches, Result
from lumel.scene import Camera, Material, Mesh, Scene

SCENE = Scene(
    meshes=(Mesh("floor", np.eye(3, dtype=np.float32), np.array([[0, 1, 2]], dtype=np.int32), "grey"),),
    materials={"grey": Material("grey", diffuse=(0.5, 0.5, 0.5), two_sided=False)},
    cameras=(Camera.look_at("main", (0, 0, 5), (0, 0, 0), width=64, height=48),),
    notes=("ignored a thing",),
    source="s.xml",
)


class FakeCore:
    """`load`, `render` and `describe` with the signatures of the true ones."""

    def __init__(self) -> None:
        self.cameras: tuple[str, ...] = ("main",)
        self.failure: LumelError | None = None
        self.loaded: tuple[str, dict[str, str], bool] | None = None
        self.settings: dict[str, Any] = {}
        self.described: int | None = None

    def load(self, path: str, *, defines: dict[str, str], lenient: bool) -> Scene:
        """The same small scene, whatever is asked for."""
        self.loaded = path, defines, lenient
        return SCENE

    def render(self, scene: Scene, **settings: Any) -> Result:
        """Noise, after one Progress of each phase."""
        assert scene is SCENE
        self.settings = settings
        if self.failure:
            raise self.failure
        for phase, error in (("solve", math.nan), ("shoot", 0.1), ("eye", 0.05)):
            if settings["progress"]:
                settings["progress"](Progress(phase, 0.5, 1000, 1e6, error, 0.1, 0.1))  # type: ignore[arg-type]
        rng = np.random.default_rng(0)
        none = np.zeros((0, 2, 3), dtype=np.float32)
        vectors = np.zeros((0, 3), dtype=np.float32)
        pictures = {
            camera: {
                name: rng.random((8, 12, 3), dtype=np.float32) if name != "depth" else rng.random((8, 12), dtype=np.float32)
                for name in ("rgb", *LAYERS)
            }
            for camera in self.cameras
        }
        stats = {"rays": 1000, "rays_per_s": 1e6, "time": 0.2, "error": math.nan}
        return Result(pictures, Patches(none, none, none, none[:, 0, 0], vectors, vectors), {"seed": "0"}, stats, ("a note",))

    def describe(self, scene: Scene, patches: int | None = None) -> dict[str, Any]:
        """Made-up numbers."""
        assert scene is SCENE
        self.described = patches
        power = (math.pi, math.pi, math.pi)
        return {
            "patches": 10, "triangles": 1, "degenerate": 1, "duplicate": 0, "huge": 0, "nonfinite": 2, "memory_bytes": 3_000_000,
            "surface_area": 0.5, "power": power, "lights": [{"name": "lamp", "kind": "area", "power": power}],
        }  # fmt: skip
