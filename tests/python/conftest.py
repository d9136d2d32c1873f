"""What several tests need."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="session")
def shared() -> Path:
    """The folder of reference scenes, pictures and vectors: $LUMEL_SHARED, else `shared` beside the repository."""
    folder = Path(os.environ.get("LUMEL_SHARED", ROOT.parent / "shared"))
    if not folder.is_dir():
        pytest.skip(f"no reference scenes at {folder}; set LUMEL_SHARED")
    return folder
