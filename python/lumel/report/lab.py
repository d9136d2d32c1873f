"""What all figures share: the scenes, the time, the settings, and works that several of them need."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any, TypeVar, cast

from .. import machine
from ..errors import Problem, SceneError
from ..progress import Progress
from ..readers import load
from ..render import render, with_camera
from ..result import Result
from ..scene import Scene
from .areas import Subject, Truth, truth_within
from .budget import Budget, until

BUST, BOX = "lumel:demo", "lumel:cornell"
PATCHES = {BUST: 21_000, BOX: 6_000}
LEAST_TIME = 0.2  # s of a render

Kept = TypeVar("Kept")


@dataclass
class Lab:
    """`given` is the scene that stands for all others, None for those of the figures; `size` of pictures, None for that of the scene.

    `show` is told what is done, and the share of the time that is over.
    """

    budget: Budget
    given: Scene | None = None
    size: tuple[int, int] | None = None
    patches: int | None = None
    threads: int = 0
    show: Callable[[str, float], None] = lambda *_: None
    doing: str = ""
    load: float = field(default_factory=machine.load)  # of the machine, before the start
    _kept: dict[str, Any] = field(default_factory=dict)

    def begin(self, doing: str) -> None:
        """Say what is done from now on."""
        self.doing = doing
        self.tell()

    def tell(self, _: Progress | None = None) -> None:
        """Say how far the report is."""
        self.show(self.doing, self.budget.fraction)

    def once(self, name: str, make: Callable[[], Kept]) -> Kept:
        """What `make` gives, made at the first call for `name`."""
        if name not in self._kept:
            self._kept[name] = make()
        return cast(Kept, self._kept[name])

    def scene(self, name: str) -> Scene:
        """The scene that was given, else the built-in one `name`, with its first camera alone, at the size of the report."""

        def make() -> Scene:
            scene = with_camera(self.given or load(name))[0]
            camera = scene.cameras[0]
            return replace(scene, cameras=(camera.with_size(*self.size) if self.size else camera,))

        return self.once(f"scene {name}", make)

    def patches_of(self, name: str) -> int | None:
        """About how many patches scene `name` is divided into, as for `lumel.render`."""
        return self.patches or (None if self.given else PATCHES[name])

    def render(self, name: str, **settings: Any) -> Result:
        """Render scene `name` with the settings of the report and these."""
        if "time" in settings:
            settings["time"] = max(LEAST_TIME, settings["time"])
        common: dict[str, Any] = {"patches": self.patches_of(name), "threads": self.threads, "progress": self.tell}
        return render(self.scene(name), **common | settings)

    def subject(self, name: str) -> Subject:
        """The glossy patches of scene `name`."""
        return self.once(f"subject {name}", lambda: Subject(self.scene(name), self.patches_of(name), self.threads))

    def truth(self, name: str) -> Truth:
        """The light in the glossy patches of scene `name`. Takes the time of the work `truth`."""

        def make() -> Truth:
            self.begin("truth of the areas of interest")
            more = until(self.budget.take("truth"))
            truth = truth_within(self.subject(name), more)
            self.check_lit(name, truth.mean)
            return truth

        return self.once(f"truth {name}", make)

    def check_lit(self, name: str, light: float) -> None:
        """Raise SceneError where `light`, the mean light in gloss of scene `name`, is none."""
        if not light > 0:
            found = "no light comes over other surfaces to what is glossy in view"
            raise SceneError(Problem(f"{found}: a report has nothing to compare", self.scene(name).source or None))
