"""The page: all figures in one HTML file that loads nothing else."""

from __future__ import annotations

import base64
import csv
import io
import math
import os
import platform
import re
from collections.abc import Mapping
from datetime import datetime
from pathlib import Path

from jinja2 import Environment, PackageLoader, select_autoescape
from markupsafe import Markup, escape

from .figure import Cell, Figure, Table
from .lab import Lab

PAPER = """L. Szirmay-Kalos, Gy. Antal, B. Balázs: "Weighted Importance Sampling in Shooting Algorithms",
Spring Conference on Computer Graphics 2003"""
_CODE = re.compile(r"`([^`]+)`")


def page(figures: Mapping[str, Figure], command: str, lab: Lab) -> str:
    """The HTML of a report."""
    from .. import __version__

    environment = Environment(
        loader=PackageLoader("lumel", "report/templates"), autoescape=select_autoescape(["html"]), trim_blocks=True, lstrip_blocks=True
    )
    environment.filters |= {"prose": _prose, "cell": shown, "data": _data_uri, "svg": Markup}
    return environment.get_template("page.html").render(
        figures=figures,
        command=command,
        paper=PAPER,
        version=__version__,
        machine=machine(),
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


def machine() -> str:
    """Processors that may be used, their name, the system, and how busy it is."""
    lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    name = next((line.split(":")[1].strip() for line in lines if line.startswith("model name")), platform.processor())
    threads, load = len(os.sched_getaffinity(0)), os.getloadavg()
    return f"{threads} threads of {name}, {platform.system()}; load {load[2]:.1f} over the last 15 minutes, {load[0]:.1f} at the end"


def _prose(text: str) -> Markup:
    """Text with `code` in it."""
    return Markup(_CODE.sub(r"<code>\1</code>", str(escape(text))))


def _data_uri(png: bytes) -> str:
    return f"data:image/png;base64,{base64.b64encode(png).decode()}"
