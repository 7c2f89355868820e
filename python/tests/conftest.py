"""What tests share."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = ROOT / "examples"

# For the type checker only.
collect_ignore = ["right_calls.py", "wrong_calls.py"]


def program() -> Path:
    """The program of the same build as the package: others may round the last digit differently."""
    path = Path(os.environ.get("BSM", ROOT / "target" / "debug" / "bsm"))
    if not path.exists():
        pytest.skip("no program: python/check builds it")
    return path


@pytest.fixture(autouse=True)
def at_the_root(monkeypatch: pytest.MonkeyPatch) -> None:
    """Documents and examples name their files from the root of the repository."""
    monkeypatch.chdir(ROOT)
