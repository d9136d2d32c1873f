"""The page: all figures in one HTML file that loads nothing else."""

from __future__ import annotations

import base64
import csv
import io
import math
import re
from collections.abc import Mapping
from datetime import datetime

from jinja2 import Environment, PackageLoader, select_autoescape
from markupsafe import Markup, escape

from ..machine import load, processors
from .figure import Cell, Figure, Table
from .lab import Lab

PAPER = """L. Szirmay-Kalos, Gy. Antal, B. Balázs: "Weighted Importance Sampling in Shooting Algorithms",
Spring Conference on Computer Graphics 2003"""
_CODE = re.compile(r"`([^`]+)`")


def page(figures: Mapping[str, Figure], command: str, whole: bool, lab: Lab) -> str:
    """The HTML of a report that `command` made; a `whole` one has all figures there are."""
    from .. import __version__

    environment = Environment(
        loader=PackageLoader("lumel", "report/templates"), autoescape=select_autoescape(["html"]), trim_blocks=True, lstrip_blocks=True
    )
    environment.filters |= {"prose": _prose, "cell": shown, "data": _data_uri, "svg": Markup}
    return environment.get_template("page.html").render(
        figures=figures,
        command=command,
        whole=whole,
        paper=PAPER,
        version=__version__,
        machine=f"{processors()}; load {lab.load:.1f} before the start, {load():.1f} at the end",
        date=f"{datetime.now().astimezone():%d %B %Y, %H:%M %Z}",
        seconds=lab.budget.elapsed,
    )


def to_csv(table: Table) -> str:
    """A table as CSV, its numbers in full."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(table.head)
    writer.writerows(table.rows)
    return text.getvalue()


def shown(value: Cell) -> str:
    """A cell for people: three digits, and a dash for what is not known."""
    if isinstance(value, float):
        return f"{value:.3g}" if math.isfinite(value) else "-"
    return f"{value:,}" if isinstance(value, int) else value


def _prose(text: str) -> Markup:
    """Text with `code` in it."""
    return Markup(_CODE.sub(r"<code>\1</code>", str(escape(text))))


def _data_uri(png: bytes) -> str:
    return f"data:image/png;base64,{base64.b64encode(png).decode()}"
