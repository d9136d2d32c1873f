"""Read the values of flags. Each reader returns None and notes a problem where it cannot, so that all problems show at once."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import Literal

from ..errors import Problem, nearest

_SUFFIXES = {"": 1, "k": 10**3, "m": 10**6, "g": 10**9}
_COUNT = re.compile(r"(?P<number>[+-]?\d+(\.\d*)?(e\+?\d{1,2})?)(?P<suffix>[kmg]?)", re.IGNORECASE)
_LARGEST_EV = 100


def count(flag: str, text: str | None, problems: list[Problem]) -> int | None:
    """A whole number above 0: `5000`, `1e6`, `1.5M` (k, M, G)."""
    if text is None:
        return None
    match = _COUNT.fullmatch(text.strip())
    value = float(match["number"]) * _SUFFIXES[match["suffix"].lower()] if match else 0.0
    if value < 1 or value != int(value):
        problems.append(Problem(f"{flag} must be a whole number of at least 1 (such as 5000, 1e6 or 2M), found '{text}'"))
        return None
    return int(value)


def size(text: str | None, problems: list[Problem]) -> tuple[int, int] | None:
    """`WxH` in pixels."""
    if text is None:
        return None
    from ..settings import LARGEST_PICTURE

    match = re.fullmatch(r"(\d{1,6})[xX](\d{1,6})", text.strip())
    if not match or not all(1 <= int(side) <= LARGEST_PICTURE for side in match.groups()):
        problems.append(Problem(f"--size must be WIDTHxHEIGHT in pixels, each 1 to {LARGEST_PICTURE} (such as 640x480), found '{text}'"))
        return None
    return int(match[1]), int(match[2])


def defines(texts: Sequence[str], problems: list[Problem]) -> dict[str, str]:
    """`name=value` pairs; the last one of a name holds."""
    pairs: dict[str, str] = {}
    for text in texts:
        name, equals, value = text.partition("=")
        if not equals or not name.strip():
            problems.append(Problem(f"-D must be name=value, found '{text}'"))
        pairs[name.strip()] = value
    return pairs


def layers(text: str | None, problems: list[Problem]) -> tuple[str, ...] | Literal["all"] | None:
    """Layer names with commas between them, or `all`."""
    if text is None or text.strip() == "all":
        return "all" if text else None
    from ..result import DIAGNOSTICS, LAYERS

    names = tuple(name.strip() for name in text.split(",") if name.strip())
    known = ("rgb", *LAYERS, *DIAGNOSTICS)
    if not names:
        problems.append(Problem(f"--layers names no layer; allowed: all, {', '.join(known)}"))
    problems.extend(Problem(f"--layers: unknown layer '{name}'; {nearest(name, ('all', *known))}") for name in names if name not in known)
    return names


def choice(flag: str, text: str, allowed: Sequence[str], problems: list[Problem]) -> None:
    """Note a problem where `text` is none of `allowed`."""
    if text not in allowed:
        problems.append(Problem(f"{flag}: unknown value '{text}'; {nearest(text, allowed)}"))


def exclusive(flags: Mapping[str, object], problems: list[Problem]) -> bool:
    """Whether at most one of `flags` is given; notes a problem where there are more."""
    given = [flag for flag, value in flags.items() if value is not None]
    if len(given) > 1:
        problems.append(Problem(f"{' and '.join(given)} exclude each other: give one of {', '.join(flags)}"))
    return len(given) <= 1


def exposure(ev: float, problems: list[Problem]) -> None:
    """Note a problem where `ev` is beyond what float32 pictures can be brightened by."""
    if not -_LARGEST_EV <= ev <= _LARGEST_EV:
        problems.append(Problem(f"--exposure must be -{_LARGEST_EV} to {_LARGEST_EV} EV, found {ev:g}"))
