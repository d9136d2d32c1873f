"""What `lumel render` says when it is done."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import text

if TYPE_CHECKING:
    from ..result import Result


def show(result: Result, files: Sequence[Path], *, as_json: bool) -> None:
    """Print a few lines to stdout, or the last JSON line to stderr."""
    if as_json:
        event = {"phase": "done", "files": [str(file) for file in files], "notes": list(result.notes), "stats": dict(result.stats)}
        print(text.to_json(event), file=sys.stderr)
        return
    if result.stats.get("interrupted"):
        print("stopped early, on request")
    if line := numbers(result.stats):
        print(line)
    if why := result.stats.get("why_transport"):
        print(f"transport {result.stats['transport']}: {why}")
    if division := result.stats.get("division"):
        print(f"time: {division}")
    if why := result.stats.get("why_estimator"):
        print(f"estimator auto: {why}")
    if "directions" in result.stats:
        print(bundles(result.stats))
    for note in result.notes:
        print(f"note: {note}")
    for file in files:
        print(f"wrote {file}")


def bundles(stats: Mapping[str, Any]) -> str:
    """`window 512, 3 M fragments, 2 M pairs, mean depth 2.40, 12 parity violations per million lines, 1 % of the light escaped, ...`."""
    return (
        f"window {stats['window']}, {text.count(stats['fragments'], 'fragments')}, {text.count(stats['pairs'], 'pairs')}, "
        f"mean depth {stats['mean_depth']:.2f}, {text.si(stats['parity_violations_per_million']).strip()} parity violations per million "
        f"lines, {text.error(stats['escaped_share'])} of the light escaped, {text.error(stats['mispaired_share'])} was paired wrongly"
    )


def numbers(stats: Mapping[str, object]) -> str:
    """`5 M rays, 4.2 M rays/s, 3.1 s, error 1.2 %`, of those that `stats` has."""
    shown: dict[str, Callable[[float], str]] = {
        "directions": lambda value: text.count(value, "directions"),
        "directions_per_s": lambda value: text.count(value, "directions/s"),
        "rays": lambda value: text.count(value, "rays"),
        "rays_per_s": lambda value: text.count(value, "rays/s"),
        "time": text.seconds,
        "error": lambda value: f"error {text.error(value)}",
    }
    return ", ".join(put(value) for key, put in shown.items() if isinstance(value := stats.get(key), int | float))
