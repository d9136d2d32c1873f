"""Finds elements by their `id`."""

from __future__ import annotations

from ..errors import nearest
from .findings import Findings
from .tree import Node


class References:
    """All elements under `root` that have an `id`; an id that is used twice is reported."""

    def __init__(self, root: Node, findings: Findings) -> None:
        self._findings = findings
        self._by_id: dict[str, Node] = {}
        self._collect(root)

    def _collect(self, node: Node) -> None:
        if node.id and node.tag != "ref":
            first = self._by_id.setdefault(node.id, node)
            if first is not node:
                self._findings.wrong(f"the id '{node.id}' is used twice, first in {first.file}:{first.line}", node)
        for child in node.children:
            self._collect(child)

    def names(self) -> set[str]:
        """All ids."""
        return set(self._by_id)

    def resolve(self, node: Node, tag: str) -> Node | None:
        """The element that a `<ref>` means, or `node` itself where it is none; None (and reported) where there is no such `tag`."""
        if node.tag != "ref":
            return node
        found = self._by_id.get(node.id)
        if found is not None and found.tag == tag:
            return found
        names = [name for name, other in self._by_id.items() if other.tag == tag]
        if "$" in node.id:
            return None
        if found is not None:
            self._findings.wrong(f"'{node.id}' is a {found.tag}, not a {tag}", node)
        elif not node.id:
            self._findings.wrong("<ref> lacks the attribute 'id'", node)
        else:
            hint = nearest(node.id, names) if names else f"the scene has no {tag} with an id"
            self._findings.wrong(f"there is no {tag} '{node.id}'; {hint}", node)
        return None
