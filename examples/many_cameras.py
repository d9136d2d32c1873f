"""Render many views at once: the light is shot once and measured for every camera.

python examples/many_cameras.py [VIEWS [SECONDS]]
"""

import math
import sys
from dataclasses import replace

import lumel


def main(views: str = "5", seconds: str = "15") -> None:
    scene = lumel.load("lumel:demo")

    # An arc of cameras in front of the bust, from one wall to the other.
    cameras = []
    for i in range(int(views)):
        angle = math.radians(-35 + 70 * (i + 0.5) / int(views))
        origin = (1.6 * math.sin(angle), 1.4, 1.6 * math.cos(angle) - 0.3)
        cameras.append(lumel.Camera.look_at(f"view{i}", origin, (0.0, 1.2, -0.3), fov=60, width=240, height=240))
    scene = replace(scene, cameras=tuple(cameras))

    result = lumel.render(scene, camera="all", patches=21_000, time=float(seconds))
    for camera in scene.cameras:
        result.write(f"{camera.name}.png", camera=camera.name)


if __name__ == "__main__":
    main(*sys.argv[1:])
