"""Build a scene from numpy arrays, without any file: a glossy, rippled sheet under a warm panel and a cool point lamp.

python examples/from_arrays.py [SECONDS]
"""

import sys

import numpy as np

import lumel


def main(seconds: str = "5") -> None:
    # A height field of 80 x 80 squares, y = 0.12 cos(7 r), with the exact normals of that function.
    line = np.linspace(-1, 1, 81)
    z, x = (part.ravel() for part in np.meshgrid(line, line, indexing="ij"))
    r = np.hypot(x, z) + 1e-9
    slope = -0.84 * np.sin(7 * r) / r
    points = np.column_stack([x, 0.12 * np.cos(7 * r), z]).astype(np.float32)
    normals = np.column_stack([-slope * x, np.ones_like(x), -slope * z])
    normals = (normals / np.linalg.norm(normals, axis=1, keepdims=True)).astype(np.float32)
    a = (np.arange(80)[:, None] * 81 + np.arange(80)).ravel()
    triangles = np.concatenate([np.column_stack([a, a + 81, a + 82]), np.column_stack([a, a + 82, a + 1])]).astype(np.int32)
    panel = np.array([(-0.5, 1.5, -0.5), (0.5, 1.5, -0.5), (0.5, 1.5, 0.5), (-0.5, 1.5, 0.5)], dtype=np.float32)
    square = np.array([(0, 1, 2), (0, 2, 3)], dtype=np.int32)  # counter-clockwise from below, where it shines

    sheet = lumel.Material("sheet", diffuse=(0.3, 0.2, 0.1), specular=(0.5, 0.5, 0.5), alpha=0.15)
    scene = lumel.Scene(
        meshes=(
            lumel.Mesh("sheet", points, triangles, "sheet", normals),
            lumel.Mesh("panel", panel, square, "black", emission=(12.0, 9.0, 6.0)),
        ),
        materials={"sheet": sheet, "black": lumel.Material("black")},
        lights=(lumel.PointLight("blue", (0.9, 0.8, -0.9), (0.3, 0.5, 1.0)),),
        cameras=(lumel.Camera.look_at("main", (1.6, 1.2, 2.0), (0.0, 0.1, 0.0), fov=45, width=320, height=240),),
    )
    lumel.render(scene, time=float(seconds)).write("sheet.png")


if __name__ == "__main__":
    main(*sys.argv[1:])
