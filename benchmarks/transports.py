"""What the trial of transports says of a scene, and what is true of it, as a Markdown table.

python benchmarks/transports.py [--seconds S] [--matt] [SCENE ...]

Each is tried for 0.9 nominal seconds, on even patches. The truth is the ratio of relMSE to a reference, bundles over rays, after S nominal
seconds of shooting with either, on even patches: of the pictures as they are, and of means of 8x8 pixels, where the noise of the eye
cancels. `--matt` takes the gloss away; the reference is then made here, by rays and with another seed. Needs the reference scenes.
"""

from __future__ import annotations

import argparse

import numpy as np
from scenes import NAMES, folder, machine, matt

import lumel
from lumel.core import to_core
from lumel.error_bars import errors, pictures
from lumel.images import read_picture
from lumel.images.compare import compare
from lumel.pace import WorkClock
from lumel.report.areas import Subject
from lumel.scene import FloatArray, Scene
from lumel.settings import GATHER, MOST_GATHERING
from lumel.trial import OTHER, tried
from lumel.work import Work

TRANSPORTS = ("rays", OTHER)
TRIAL = 0.9  # nominal seconds that each is tried for
REPLICAS, PASSES, SAMPLES = 8, 4, 16


def work_on(scene: Scene, transport: str) -> Work:
    """All that one thread needs to render the first camera with even patches."""
    settings = {"transport": transport, "gather": GATHER, "most_gathering": MOST_GATHERING}
    view = scene.cameras[0]
    return Work(Subject(scene, threads=1).session(1, **settings), 1, view.width * view.height, transport, plain=False, clock=WorkClock())


def shot(scene: Scene, transport: str, seconds: float) -> tuple[FloatArray, float]:
    """The picture after so many nominal seconds of shooting, and the squared error of the solution by its error bars."""
    work = work_on(scene, transport)
    for replica in range(REPLICAS):
        until = seconds * (replica + 1) / REPLICAS
        work.begin(int(seconds / REPLICAS / 4 * WorkClock.SPEED))
        if replica == 0:
            work.first_step(seconds)
        work.steps_until(until, lambda: False)
        work.session.end_replica()
    work.session.reconstruct()
    for _ in range(PASSES):
        work.see(SAMPLES)
    return pictures(work.session, 1)[0].astype(np.float32), errors(work.session, 1)[0] ** 2


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=4, help="nominal, of shooting")
    parser.add_argument("--matt", action="store_true")
    parser.add_argument("names", nargs="*", default=NAMES, metavar="SCENE", help=f"of {', '.join(NAMES)}; all of them by default")
    arguments = parser.parse_args()
    print(machine(), end="\n\n")
    print("| scene | patches | a trial says | error bars | relMSE | of 8x8 means |")
    print("|---|---|---|---|---|---|")
    for name in arguments.names:
        scene = lumel.load(folder() / f"{name}.xml")
        if arguments.matt:
            scene = matt(scene)
            truth = lumel.render(scene, transport="rays", quality="high", seed=99, threads=1).pictures[scene.cameras[0].name]
        else:
            truth = read_picture(folder() / "reference" / f"{name}.exr").layers
        cost = [tried(work_on(scene, transport), TRIAL, lambda: False) for transport in TRANSPORTS]
        found = [shot(scene, transport, arguments.seconds) for transport in TRANSPORTS]
        far = [compare(picture, truth["rgb"], None, truth["stderr"]) for picture, _ in found]
        ratios = (
            cost[1] / cost[0],
            found[1][1] / found[0][1],
            far[1].relmse_without_noise / far[0].relmse_without_noise,
            far[1].relmse_8x8_without_noise / far[0].relmse_8x8_without_noise,
        )
        kind = " matt" if arguments.matt else ""
        print(f"| `{name}`{kind} | {to_core(scene)[0].patches:,} | " + " | ".join(f"{r:.2f}" for r in ratios) + " |", flush=True)


if __name__ == "__main__":
    main()
