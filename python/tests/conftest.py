"""Fixtures shared by the tests."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = ROOT / "examples"

# Only the type checker reads these files, so they are not collected as tests.
collect_ignore = ["right_calls.py", "wrong_calls.py"]


def program() -> Path:
    """Return the path of the program from the same build as the package, because another build may round the last digit
    differently."""
    path = Path(os.environ.get("BSM", ROOT / "target" / "debug" / "bsm"))
    if not path.exists():
        pytest.skip("no program: python/check builds it")
    return path


@pytest.fixture(autouse=True)
def at_the_root(monkeypatch: pytest.MonkeyPatch) -> None:
    """Run tests in the root of the repository, because documents and examples name their files from there."""
    monkeypatch.chdir(ROOT)
