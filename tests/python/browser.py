"""A headless Chromium that notes all that a page says and asks for."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

from playwright.sync_api import Page, sync_playwright

BROWSERS = ("chromium-headless-shell", "chromium", "google-chrome")


@dataclass
class Opened:
    """A page with its console messages, its errors, and what it asked for beside itself."""

    page: Page
    said: list[str] = field(default_factory=list)
    asked: list[str] = field(default_factory=list)


@contextmanager
def opened(file: Path, *, scheme: str = "light") -> Iterator[Opened]:
    """The page `file` in a browser without a network, in the colour scheme `light` or `dark`."""
    found = next((path for name in BROWSERS if (path := shutil.which(name))), None)
    assert found, f"there is no browser; install one of {', '.join(BROWSERS)}"
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=found)
        page = browser.new_page(color_scheme="dark" if scheme == "dark" else "light", viewport={"width": 1280, "height": 900}, offline=True)
        seen = Opened(page)
        page.on("console", lambda message: seen.said.append(message.text))
        page.on("pageerror", lambda error: seen.said.append(str(error)))
        page.on("request", lambda request: seen.asked.append(request.url[:100]))
        page.goto(file.as_uri())
        yield seen
        browser.close()
