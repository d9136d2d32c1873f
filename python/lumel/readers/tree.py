"""The elements of a scene file, after includes and `$name`s are resolved; each knows its file and line."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass(eq=False)
class Node:
    """One XML element. `line` is 1-based; `file` is the path as the user would write it."""

    tag: str
    attributes: dict[str, str]
    file: str
    line: int
    children: list[Node] = field(default_factory=list)

    @property
    def type(self) -> str:
        """The plugin's name, '' where it is missing."""
        return self.attributes.get("type", "")

    @property
    def name(self) -> str:
        """The property that this element sets, '' where it is missing."""
        return self.attributes.get("name", "")

    @property
    def id(self) -> str:
        """The name by which references find this element, '' without one."""
        return self.attributes.get("id", "")

    @property
    def value(self) -> str:
        """The text of the attribute `value`, '' where it is missing."""
        return self.attributes.get("value", "")
