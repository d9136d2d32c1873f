"""Load a scene, render it for some seconds, write what came out.

python examples/render_file.py [SCENE [SECONDS]], where SCENE is a Mitsuba 3 XML file, an OBJ, PLY or STL mesh, or a built-in scene.
"""

import sys

import lumel


def main(path: str = "lumel:cornell", seconds: str = "5") -> None:
    scene = lumel.load(path)
    result = lumel.render(scene, transport="rays", estimator="weighted", time=float(seconds))

    # An EXR holds every layer and its standard error, a PNG what a screen shows of it.
    result.write("scene.exr")
    result.write("scene.png", exposure=0.5)

    # The same as numpy arrays: linear Rec.709 radiance, (height, width, 3).
    image, error = result.image(), result.stderr()
    print(f"mean radiance {image.mean():.4f}, mean standard error {error.mean():.4f}")
    print(f"of which seen in glossy surfaces {result.layer('indirect.specular').mean():.4f}")
    print(f"{len(result.patches.area)} patches, {result.patches.area.sum():.2f} m2")


if __name__ == "__main__":
    main(*sys.argv[1:])
