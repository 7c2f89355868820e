"""Run the code of documents and examples as written."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from conftest import ROOT

SHOWN = [ROOT / name for name in ("README.md", "python/README.md", "docs/guide/million-points.md")]
SCRIPTS = sorted((ROOT / "python" / "examples").glob("*.py"))


def run(path: Path) -> dict[str, Any]:
    """Run the code of a document, and return its variables."""
    blocks = re.findall(r"```python\n(.*?)```", path.read_text(encoding="utf-8"), re.DOTALL)
    assert blocks
    names: dict[str, Any] = {}
    for block in blocks:
        exec(compile(block, str(path), "exec"), names)
    return names


@pytest.mark.parametrize("path", SHOWN, ids=lambda path: str(path.relative_to(ROOT)))
def test_code_examples_of_a_document_run(path: Path) -> None:
    run(path)


def test_parts_solved_on_a_cluster_are_bit_identical_to_parts_in_an_object_store() -> None:
    names = run(ROOT / "docs" / "guide" / "scale-out.md")
    plan, store = names["plan"], Path(names["url"])
    assert plan.verify().complete and names["missing"] == [0, 1, 2] and names["bad"] == []
    for name in plan.files:
        assert (store / "data" / name).read_bytes() == (plan.folder / "data" / name).read_bytes()


@pytest.mark.parametrize("path", SCRIPTS, ids=lambda path: path.stem)
def test_an_example_runs_in_an_empty_folder(path: Path, tmp_path: Path) -> None:
    environment = {**os.environ, "MPLBACKEND": "Agg"}
    # The specification permits this time. Each example takes a few seconds.
    run = subprocess.run([sys.executable, path], cwd=tmp_path, env=environment, timeout=60, capture_output=True, text=True)
    assert run.returncode == 0, run.stderr
