"""Builds the package with maturin, and adds the types of names that only the compiled part knows.

`python python/backend.py [WHEEL]` writes these types beside the sources, from the compiled part of a wheel or from the
installed one.
"""

from __future__ import annotations

import inspect
import sys
import tempfile
import zipfile
from pathlib import Path
from typing import Any

# `python backend.py` writes types without the build tool.
if __name__ != "__main__":
    import maturin

    # Hooks that this file does not replace are imported by name. Maturin has no list of its hooks, so a star import
    # would replace `build_wheel` and `build_editable` below.
    build_sdist = maturin.build_sdist
    get_requires_for_build_editable = maturin.get_requires_for_build_editable
    get_requires_for_build_sdist = maturin.get_requires_for_build_sdist
    get_requires_for_build_wheel = maturin.get_requires_for_build_wheel
    prepare_metadata_for_build_editable = maturin.prepare_metadata_for_build_editable
    prepare_metadata_for_build_wheel = maturin.prepare_metadata_for_build_wheel

SOURCES = Path(__file__).parent


def build_wheel(folder: str, settings: dict[str, Any] | None = None, metadata: str | None = None) -> str:
    """Build twice, because the compiled part of the first wheel knows the types for the second one. Nothing is compiled
    again."""
    read_types(Path(folder, maturin.build_wheel(folder, settings, metadata)))
    return str(maturin.build_wheel(folder, settings, metadata))


def build_editable(folder: str, settings: dict[str, Any] | None = None, metadata: str | None = None) -> str:
    """Build in place, so that the sources are used directly."""
    name = str(maturin.build_editable(folder, settings, metadata))
    write_types(SOURCES)
    return name


def read_types(wheel: Path) -> None:
    """Write the types that the compiled part of a wheel knows."""
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as built:
        with zipfile.ZipFile(wheel) as packed:
            packed.extractall(built)
        write_types(built)


def write_types(built: str | Path) -> None:
    """Write `_vocabulary.pyi` beside the sources, with everything that `_vocabulary.py` of a built package creates.

    * `built`: folder of the built package.
    """
    sys.path.insert(0, str(built))
    from ballscrew import _vocabulary as made

    lines = ["from typing import Any, Literal, TypedDict", "", "from ballscrew import _core", ""]
    lines += [f"{name} = {getattr(made, name)!r}".replace("typing.", "") for name in ("Model", "Control", "Friction", "Output")]
    lines += ["", "class Inputs(TypedDict, total=False):"]
    lines += [f"    {name}: {inspect.formatannotation(type_)}" for name, type_ in made.Inputs.__annotations__.items()]
    bases = {made.CaseFields: "(_core.Case)", made.SolutionFields: "(_core.Solution)"}
    for fields in (*bases, *made.SECTIONS):
        lines += ["", f"class {fields.__name__}{bases.get(fields, '')}:"]
        for name, value in vars(fields).items():
            if isinstance(value, property):
                type_ = inspect.formatannotation(value.fget.__annotations__["return"])
                lines += ["    @property", f"    def {name}(self) -> {type_}:", f'        """{value.__doc__}"""']
    lines += ["", "SECTIONS: tuple[type, ...]"]
    (SOURCES / "ballscrew" / "_vocabulary.pyi").write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    read_types(Path(sys.argv[1])) if len(sys.argv) > 1 else write_types(SOURCES)
