"""What tests share."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = ROOT / "examples"


def program() -> Path:
    """The program of the same tree: BSM, or what the workspace has built last."""
    if "BSM" in os.environ:
        return Path(os.environ["BSM"])
    built = [ROOT / "target" / profile / "bsm" for profile in ("release", "debug")]
    found = [path for path in built if path.exists()]
    if not found:
        pytest.skip("no program built: cargo build --release")
    return max(found, key=lambda path: path.stat().st_mtime)


@pytest.fixture(autouse=True)
def at_the_root(monkeypatch: pytest.MonkeyPatch) -> None:
    """Documents and examples name their files from the root of the repository."""
    monkeypatch.chdir(ROOT)
