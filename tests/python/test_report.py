"""`lumel report`: a small report, opened in a browser, and what stands beside it."""

from __future__ import annotations

import csv
import math
import re
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path

import pytest

import lumel
from browser import opened
from lumel.images import read_picture
from lumel.report import FIGURES
from lumel.report.budget import DRAWING, Budget
from lumel.report.run import PAGE, Order, run

SECONDS = 8  # asked for; works that take a least time of their own make it more
SMALL = ("--scene", "lumel:cornell", "--time", str(SECONDS), "--size", "64x48", "--patches", "1500")


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a small report of all figures, in which another file lay before."""
    folder = tmp_path_factory.mktemp("report") / "new" / "folder"
    folder.mkdir(parents=True)
    (folder / "mine.txt").write_text("kept", encoding="utf-8")
    line = [sys.executable, "-W", "error", "-m", "lumel", "report", "-o", str(folder), *SMALL]
    done = subprocess.run(line, capture_output=True, text=True, check=False, timeout=200)
    assert done.returncode == 0, done.stderr
    assert f"wrote {folder / PAGE}" in done.stdout
    return folder


def names(folder: Path, ending: str) -> set[str]:
    """File names without that ending."""
    return {path.stem for path in folder.glob(f"*.{ending}")}


def test_there_is_a_file_for_every_picture_curve_and_table(report: Path) -> None:
    assert (report / "mine.txt").read_text(encoding="utf-8") == "kept"
    assert not list(report.glob(".*"))
    assert names(report, "csv") == set(FIGURES)
    assert names(report, "svg") == set(FIGURES) - {"figure2", "figure6"}
    expected = {f"figure2.{e}{kind}" for e in ("classical", "weighted", "auto", "reference") for kind in ("", ".gloss")}
    expected |= {f"figure6.{e}{kind}" for e in ("classical", "weighted", "reference") for kind in ("", ".gloss")}
    expected |= {"figure5"} | {
        f"transports.{t}.{e}" for t in ("rays", "walk", "bundles") for e in ("classical", "weighted", "regression", "auto")
    }
    assert names(report, "png") == expected


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_a_browser_shows_every_picture_and_curve(report: Path, scheme: str) -> None:
    with opened(report / PAGE, scheme=scheme) as seen:
        pictures = seen.page.eval_on_selector_all(
            "section img", "all => all.map(i => [i.alt, i.naturalWidth, i.naturalHeight, i.clientWidth])"
        )
        assert len(pictures) == len(names(report, "png"))
        sizes = Counter(read_picture(path).layers["rgb"].shape[1::-1] for path in report.glob("*.png"))
        assert Counter((width, height) for _, width, height, _ in pictures) == sizes
        assert all(alt and shown > 0 for alt, _, _, shown in pictures)
        curves = seen.page.eval_on_selector_all(
            ".curve", "all => all.map(c => [c.ariaLabel, c.querySelectorAll('svg path').length, c.getBoundingClientRect().height])"
        )
        assert len(curves) == len(names(report, "svg"))
        assert all(label and paths > 3 and height > 20 for label, paths, height in curves)
        assert [url for url in seen.asked if not url.startswith("data:")] == [(report / PAGE).as_uri()]
        assert seen.said == []


def test_the_page_is_whole(report: Path) -> None:
    text = (report / PAGE).read_text(encoding="utf-8")
    identifiers = re.findall(r'\sid="([^"]+)"', text)
    assert [name for name, count in Counter(identifiers).items() if count > 1] == []
    assert set(re.findall(r'(?:href="#|url\(#)([^")]+)', text)) <= set(identifiers)
    assert not re.findall(r'(?:src|href)="(?!data:|#)', text)
    assert "nan" not in re.sub(r"base64,[^\"]+|<svg.*?</svg>", "", text, flags=re.DOTALL).split()
    for figure in FIGURES:
        assert f'<section id="{figure}">' in text
        assert f"--only {figure}</code>" in text


def test_a_picture_is_enlarged_by_a_click(report: Path) -> None:
    with opened(report / PAGE) as seen:
        seen.page.click("#figure2 .grid button")
        assert seen.page.is_visible("dialog img")
        small, large = (seen.page.eval_on_selector(s, "i => [i.src, i.clientWidth]") for s in ("#figure2 .grid img", "dialog img"))
        assert large[0] == small[0]
        assert large[1] >= 64
        seen.page.keyboard.press("Escape")
        assert not seen.page.is_visible("dialog img")


def read_table(path: Path) -> list[dict[str, str]]:
    """The rows of a CSV."""
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def test_tables_hold_numbers(report: Path) -> None:
    for figure in FIGURES:
        rows = read_table(report / f"{figure}.csv")
        assert rows
        for row in rows:
            cells = {head: cell for head, cell in row.items() if not head.startswith("gain")}  # nan where noise hides it
            assert "nan" not in cells.values()
            assert "inf" not in row.values()


def test_a_figure_alone_replaces_its_files_and_no_others(report: Path) -> None:
    before = {path.name: path.read_bytes() for path in report.iterdir() if path.name != PAGE}
    order = Order(lumel.load("lumel:cornell"), ("coverage",), 1.0, (32, 24), 300)
    figures, files = run(report, order)
    assert list(figures) == ["coverage"]
    assert {path.name for path in files} == {"coverage.svg", "coverage.csv"}
    assert {name for name, data in before.items() if (report / name).read_bytes() != data} <= {"coverage.svg", "coverage.csv"}


def test_ctrl_c_leaves_nothing(tmp_path: Path) -> None:
    def interrupt(doing: str, fraction: float) -> None:
        if fraction >= 0 and doing.startswith("error bars"):
            raise KeyboardInterrupt

    order = Order(lumel.load("lumel:cornell"), ("coverage",), 1.0, (32, 24), 300)
    with pytest.raises(KeyboardInterrupt):
        run(tmp_path / "a" / "b", order, interrupt)
    assert not list(tmp_path.iterdir())


def refusal(order: Order, folder: Path) -> str:
    """What `run` says when it refuses `order`, having left `folder` as it was."""
    before = sorted(folder.rglob("*"))
    with pytest.raises(lumel.LumelError) as caught:
        run(folder / "report", order)
    assert sorted(folder.rglob("*")) == before
    return str(caught.value)


def test_orders_that_cannot_be_carried_out_leave_nothing(tmp_path: Path) -> None:
    assert "unknown figure 'figure3'; did you mean 'figure" in refusal(Order(only=("figure3",)), tmp_path)
    assert "coverage, figure2, figure4" in refusal(Order(only=("nothing",)), tmp_path)
    said = refusal(Order(only=("figur2",), seconds=0, size=(0, 9), patches=-1, threads=-2), tmp_path)
    assert [part in said for part in ("did you mean 'figure2'", "time is 0", "size is 0x9", "patches is -1", "threads is -2")] == [True] * 5
    assert "time is nan" in refusal(Order(seconds=math.nan), tmp_path)
    assert "sees nothing glossy" in refusal(Order(lumel.load("lumel:cube")), tmp_path)
    (tmp_path / "report").write_text("a file", encoding="utf-8")
    assert "cannot make the folder" in refusal(Order(), tmp_path)


def test_a_page_in_the_way_is_refused(tmp_path: Path) -> None:
    (tmp_path / "report" / PAGE).mkdir(parents=True)
    assert "it is a folder" in refusal(Order(only=("coverage",)), tmp_path)


def test_a_broken_scene_is_bad_input(tmp_path: Path) -> None:
    (tmp_path / "broken.xml").write_text("<scene", encoding="utf-8")
    line = [sys.executable, "-m", "lumel", "report", "-o", str(tmp_path / "out"), "--scene", str(tmp_path / "broken.xml")]
    done = subprocess.run(line, capture_output=True, text=True, check=False, timeout=60)
    assert done.returncode == 1
    assert "broken.xml" in done.stderr
    assert not (tmp_path / "out").exists()


def test_time_that_one_work_takes_too_long_is_shared_by_the_others(monkeypatch: pytest.MonkeyPatch) -> None:
    now = 100.0
    monkeypatch.setattr(time, "monotonic", lambda: now)
    budget = Budget(100 / (1 - DRAWING), {"a": 1.0, "b": 1.0, "c": 2.0})
    assert budget.take("a") == pytest.approx(25)
    now += 40  # 15 more than it had
    assert budget.take("b") == pytest.approx(20)
    now += 20
    assert budget.take("c") == pytest.approx(40)
    now += 500
    assert budget.fraction == 1
