"""Reads the properties of one plugin element; what nobody asked for is reported at the end."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TypeVar

import numpy as np

from ..errors import nearest
from ..scene import Rgb
from . import values
from .findings import Findings
from .transforms import STEPS, Matrix, is_usable
from .tree import Node

_T = TypeVar("_T")

# The attributes of each element. Those of plugins are checked the same way.
_ATTRIBUTES = {
    "scene": {"version"},
    "float": {"name", "value"},
    "integer": {"name", "value"},
    "boolean": {"name", "value"},
    "string": {"name", "value"},
    "rgb": {"name", "value"},
    "spectrum": {"name", "value"},
    "point": {"name", "value", "x", "y", "z"},
    "vector": {"name", "value", "x", "y", "z"},
    "transform": {"name"},
    "translate": {"value", "x", "y", "z"},
    "scale": {"value", "x", "y", "z"},
    "rotate": {"value", "x", "y", "z", "angle"},
    "lookat": {"origin", "target", "up"},
    "matrix": {"value"},
    "ref": {"id", "name"},
}
_PLUGIN_ATTRIBUTES = {"type", "id", "name", "version"}
VALUE_TAGS = frozenset({"float", "integer", "boolean", "string", "rgb", "spectrum", "point", "vector", "transform"})
_NUMBER_TAGS = ("float", "integer")
_COLOUR_TAGS = ("rgb", "float", "integer", "spectrum")


class Plugin:
    """The properties of `node`; `label` names it in messages.

    Each method takes one of them, or gives the default where it is absent or wrong, which is reported. Call `done` after the last one.
    """

    def __init__(self, node: Node, findings: Findings, label: str) -> None:
        self.node = node
        self.label = label
        self.findings = findings
        self._left = {id(child): child for child in node.children}
        self._asked: set[str] = set()
        self._named: dict[str, Node] = {}
        check_attributes(node, findings)
        for child in node.children:
            if child.tag not in VALUE_TAGS and child.tag != "texture":
                continue
            check_attributes(child, findings)
            if not child.name:
                findings.wrong(f"<{child.tag}> in {label} lacks the attribute 'name'", child)
                del self._left[id(child)]
            elif child.name in self._named:
                findings.wrong(f"{label}: '{child.name}' is set twice, first in line {self._named[child.name].line}", child)
                del self._left[id(child)]
            else:
                self._named[child.name] = child

    def has(self, name: str) -> bool:
        """Whether the property is there."""
        self._asked.add(name)
        return name in self._named

    def is_text(self, name: str) -> bool:
        """Whether the property is there as a string."""
        return name in self._named and self._named[name].tag == "string"

    def number(self, name: str, default: float, low: float = -1e30, high: float = 1e30) -> float:
        """A number in low..high."""
        node = self._take(name, _NUMBER_TAGS)
        value = self._parse(node, lambda found: values.number(found.value))
        if node is None or value is None or not self._within(node, [value], low, high):
            return default
        return value

    def integer(self, name: str, default: int, low: int, high: int) -> int:
        """A whole number in low..high."""
        node = self._take(name, ("integer",))
        value = self._parse(node, lambda found: values.number(found.value))
        if node is None or value is None or not self._within(node, [value], low, high):
            return default
        if value != int(value):
            self.findings.wrong(f"{self.label}: '{name}' is {node.value}, a whole number is needed", node)
            return default
        return int(value)

    def colour(self, name: str, default: Rgb, low: float = 0.0, high: float = 1e30, *, light: bool = False) -> Rgb:
        """Linear RGB with each part in low..high; one number is grey, a constant spectrum of a `light` the colour of equal energy."""
        node = self._take(name, _COLOUR_TAGS)
        value = self._parse(node, _parse_colour)
        if node is None or value is None or not self._within(node, value, low, high):
            return default
        if node.tag == "spectrum" and light:
            red, green, blue = (part * white for part, white in zip(value, values.EQUAL_ENERGY, strict=True))
            return red, green, blue
        return value

    def text(self, name: str, default: str) -> str:
        """A string."""
        node = self._take(name, ("string",))
        return default if node is None else node.value

    def choice(self, name: str, default: str, allowed: Iterable[str]) -> str:
        """One of a few words, in any case of letters."""
        node = self._take(name, ("string",))
        word = default if node is None else node.value.strip().lower()
        if word not in allowed:
            self.findings.wrong(f"{self.label}: '{name}' is '{word}'; {nearest(word, allowed)}", node)
            return default
        return word

    def flag(self, name: str, default: bool) -> bool:
        """True or false."""
        node = self._take(name, ("boolean",))
        if node is None:
            return default
        word = node.value.strip().lower()
        if word not in ("true", "false"):
            self.findings.wrong(f"{self.label}: '{name}' is '{word}'; allowed: false, true", node)
            return default
        return word == "true"

    def point(self, name: str, default: Rgb) -> Rgb:
        """A point in metres."""
        value = self._parse(self._take(name, ("point", "vector")), lambda node: values.xyz(node, None))
        return default if value is None else value

    def transform(self, name: str) -> Matrix:
        """A (4, 4) matrix that can be inverted; the identity where there is none."""
        node = self._take(name, ("transform",))
        result = np.eye(4)
        if node is None:
            return result
        before = len(self.findings)
        for step in node.children:
            if step.tag not in STEPS:
                self.findings.unsupported(f"<{step.tag}> in a transform; {nearest(step.tag, STEPS)}", step)
                continue
            check_attributes(step, self.findings)
            made = self._parse(step, STEPS[step.tag])
            result = result if made is None else made @ result
        if is_usable(result):
            return result
        if len(self.findings) == before:
            self.findings.wrong(f"{self.label}: '{name}' is singular (it flattens space) or goes beyond 1e30", node)
        return np.eye(4)

    def children(self, *tags: str) -> list[Node]:
        """The nested elements with these tags."""
        found = [child for child in self._left.values() if child.tag in tags]
        for child in found:
            del self._left[id(child)]
        return found

    def skip(self, *names: str) -> None:
        """Accept properties that have no influence on the picture."""
        for name in names:
            self._take(name, tuple(VALUE_TAGS))

    def done(self) -> None:
        """Report what is left."""
        for child in self._left.values():
            if child.tag in VALUE_TAGS:
                allowed = nearest(child.name, self._asked) if self._asked else "it has none"
                self.findings.unsupported(f"{self.label}: property '{child.name}' is not supported; {allowed}", child)
            else:
                kind = f"{child.tag} '{child.type}'" if child.type else f"<{child.tag}>"
                self.findings.unsupported(f"{self.label}: {kind} is not supported here", child)

    def _take(self, name: str, tags: tuple[str, ...]) -> Node | None:
        self._asked.add(name)
        node = self._named.get(name)
        if node is None or self._left.pop(id(node), None) is None:
            return None
        if node.tag == "texture":
            self.findings.unsupported(f"{self.label}: texture '{node.type}' in '{name}' is not supported; a constant is", node)
            return None
        if node.tag not in tags:
            self.findings.wrong(f"{self.label}: '{name}' is a <{node.tag}>; allowed: {', '.join(f'<{tag}>' for tag in tags)}", node)
            return None
        if node.tag not in ("transform", "point", "vector") and "value" not in node.attributes:
            self.findings.wrong(f"{self.label}: '{name}' lacks the attribute 'value'", node)
            return None
        return node

    def _parse(self, node: Node | None, parse: values.Parser[_T]) -> _T | None:
        """What `parse` makes of `node`; a value that still holds a `$` has been reported already."""
        if node is None or any("$" in text for text in node.attributes.values()):
            return None
        try:
            return parse(node)
        except values.UnsupportedError as error:
            self.findings.unsupported(f"{self.label}: '{node.name}' {error}", node)
        except ValueError as error:
            what = f"'{node.name}'" if node.name else f"<{node.tag}>"
            self.findings.wrong(f"{self.label}: {what} {error}", node)
        return None

    def _within(self, node: Node, found: Iterable[float], low: float, high: float) -> bool:
        if all(low <= value <= high for value in found):
            return True
        allowed = f"at least {low:g}" if high >= 1e30 else f"{low:g} to {high:g}"
        self.findings.wrong(f"{self.label}: '{node.name}' is {node.value.strip()[:60]}, allowed: {allowed}", node)
        return False


def is_supported(node: Node, allowed: Iterable[str], findings: Findings, label: str = "") -> bool:
    """Whether the plugin `node` is one of those that are read; if not, that is reported. `label` names what it is part of."""
    if node.type in allowed:
        return True
    if node.type:
        part = f"{label}: " if label else ""
        findings.unsupported(f"{part}{node.tag} '{node.type}' is not supported; {nearest(node.type, allowed)}", node)
    else:
        check_attributes(node, findings)
    return False


def _parse_colour(node: Node) -> Rgb:
    if node.tag == "spectrum" and ("filename" in node.attributes or ":" in node.value):
        raise values.UnsupportedError("depends on the wavelength, which is not supported; a constant is")
    return values.rgb(node.value)


def check_attributes(node: Node, findings: Findings) -> None:
    """Report the attributes that `node` cannot have, and a plugin without a type."""
    allowed = _ATTRIBUTES.get(node.tag, _PLUGIN_ATTRIBUTES)
    for name in node.attributes:
        if name not in allowed and not (node.tag == "spectrum" and name == "filename"):
            findings.unsupported(f"<{node.tag}>: attribute '{name}' is not supported; {nearest(name, allowed)}", node)
    if allowed is _PLUGIN_ATTRIBUTES and not node.type:
        findings.wrong(f"<{node.tag}> lacks the attribute 'type'", node)
