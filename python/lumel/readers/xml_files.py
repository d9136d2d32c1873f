"""Reads XML files into nodes: safely, with includes spliced in and `$name`s replaced.

Mitsuba's rules hold: `<default name value>` sets a name unless the caller or an earlier default did; names are replaced in document
order, the longest that matches first; included files share the names, and the children of an included `<scene>` take its place.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path

from lxml import etree

from ..errors import SceneError, nearest
from .findings import Findings
from .paths import read_file
from .tree import Node

_DEEPEST = 64  # elements within elements
_MOST_FILES = 1000  # included files that include each other twice would double without end
_MOST_ELEMENTS = 1_000_000
_LONGEST = 100_000  # characters of a value: defaults made of defaults would double without end


class TooLargeError(Exception):
    """The scene grows beyond all bounds while it is read."""


def read_tree(path: Path, defines: Mapping[str, str], findings: Findings) -> Node | None:
    """The root element of the scene in `path`, or None after a problem that leaves nothing to read. Problems go to `findings`."""
    reader = _TreeReader(defines, findings)
    try:
        root = reader.read(path, None)
    except TooLargeError as error:
        findings.wrong(str(error), Node("scene", {}, str(path), 1))
        return None
    reader.report_unused(defines)
    return root


class _TreeReader:
    def __init__(self, defines: Mapping[str, str], findings: Findings) -> None:
        self._values = {name: str(value) for name, value in defines.items()}
        self._used: set[str] = set()
        self._known: set[str] = set()
        self._chain: list[Path] = []
        self._files = 0
        self._elements = 0
        self._findings = findings

    def read(self, path: Path, include: Node | None) -> Node | None:
        """Read one file; `include` is the element that asked for it."""
        self._files += 1
        if self._files > _MOST_FILES:
            raise TooLargeError(f"more than {_MOST_FILES} files are included")
        element = self._parse(path, include)
        if element is None:
            return None
        self._chain.append(path.resolve())
        nodes = self._convert(element, str(path), len(self._chain))
        self._chain.pop()
        return nodes[0] if nodes else None

    def _parse(self, path: Path, include: Node | None) -> etree._Element | None:
        start = Node("", {}, str(path), 1)
        try:
            data = read_file(path)
        except SceneError as error:
            self._findings.wrong(str(error), include)
            return None
        parser = etree.XMLParser(resolve_entities=False, no_network=True, load_dtd=False, remove_comments=True, remove_pis=True)
        try:
            element = etree.fromstring(data, parser)
        except etree.XMLSyntaxError as error:
            line, column = error.position
            reason = re.sub(r",? *line \d+, column \d+.*", "", str(error.msg))
            start.line = max(line, 1)
            self._findings.wrong(f"not well-formed XML: {reason} (column {max(column, 1)})", start)
            return None
        except ValueError as error:  # such as an encoding that does not exist
            self._findings.wrong(f"not readable as XML: {error}", start)
            return None
        if element.getroottree().docinfo.internalDTD is not None:
            self._findings.wrong("a DOCTYPE is not allowed: scenes need no entities", start)
            return None
        return element

    def _convert(self, element: etree._Element, file: str, depth: int) -> list[Node]:
        """The nodes that stand for one element: itself, none (a default), or those of an included file."""
        self._elements += 1
        if self._elements > _MOST_ELEMENTS:
            raise TooLargeError(f"more than {_MOST_ELEMENTS} elements")
        node = Node(str(element.tag), {}, file, element.sourceline or 1)
        if depth > _DEEPEST:
            raise TooLargeError(f"elements are nested more than {_DEEPEST} deep at {file}:{node.line}")
        node.attributes = {str(key): self._replace(str(value), node) for key, value in element.attrib.items()}
        if node.tag == "default":
            self._set_default(node)
            return []
        if node.tag == "include":
            return self._include(node)
        self._refuse_text(element.text, element, node)
        for child in element:
            self._refuse_text(child.tail, child, node)
            node.children.extend(self._convert(child, file, depth + 1))
        return [node]

    def _refuse_text(self, text: str | None, before: etree._Element, parent: Node) -> None:
        if text and text.strip():
            place = Node("", {}, parent.file, before.sourceline or parent.line)
            self._findings.wrong(f"text {text.strip()[:40]!r} inside <{parent.tag}>: values belong in attributes", place)

    def _set_default(self, node: Node) -> None:
        name = node.name
        if not name or "value" not in node.attributes:
            self._findings.wrong("<default> needs the attributes 'name' and 'value'", node)
            return
        self._known.add(name)
        self._values.setdefault(name, node.value)

    def _include(self, node: Node) -> list[Node]:
        name = node.attributes.get("filename", "")
        if not name or len(node.attributes) > 1:
            self._findings.wrong("<include> needs the attribute 'filename' and no other", node)
            return []
        path = Path(node.file).parent / name
        if path.resolve() in self._chain:
            self._findings.wrong(f"'{name}' includes itself", node)
            return []
        root = self.read(path, node)
        if root is None:
            return []
        return root.children if root.tag == "scene" else [root]

    def _replace(self, text: str, node: Node) -> str:
        """Put in the values of all `$name`s."""
        if "$" not in text:
            return text
        head, *parts = text.split("$")
        for part in parts:
            name = max((name for name in self._values if part.startswith(name)), key=len, default="")
            if not name:
                self._report_undefined(part, node)
            self._used.add(name)
            head += self._values[name] + part[len(name) :] if name else "$" + part
        if len(head) > _LONGEST:
            raise TooLargeError(f"a value is longer than {_LONGEST} characters at {node.file}:{node.line}")
        return head

    def _report_undefined(self, text: str, node: Node) -> None:
        word = re.split(r"\W", text, maxsplit=1)[0][:100]
        hint = nearest(word, self._values) if self._values else "no names are defined up to here"
        self._findings.wrong(f"${word} is not defined; {hint}", node)

    def report_unused(self, defines: Mapping[str, str]) -> None:
        """Report the names given by the caller that no file uses."""
        known = self._known | (self._used & set(self._values)) - set(defines)
        for name in defines:
            if name not in self._used:
                hint = nearest(name, known) if known else "it has no such names"
                self._findings.unsupported(f"-D {name}={defines[name]}: the scene does not use ${name}; {hint}")
