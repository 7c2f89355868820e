"""Build the package with maturin, and add type information for names that only the compiled module defines.

`python python/backend.py [WHEEL]` writes the type information beside the sources. It reads the names from the compiled
module in the wheel, or from the installed package if no wheel is given.
"""

from __future__ import annotations

import inspect
import sys
import tempfile
import zipfile
from pathlib import Path
from typing import Any

# `python backend.py` only writes type information, so it does not need maturin.
if __name__ != "__main__":
    import maturin

    # Hooks that this file does not replace are imported by name. Maturin has no list of its hooks, so a star import
    # would also import `build_wheel` and `build_editable`, which are defined below.
    build_sdist = maturin.build_sdist
    get_requires_for_build_editable = maturin.get_requires_for_build_editable
    get_requires_for_build_sdist = maturin.get_requires_for_build_sdist
    get_requires_for_build_wheel = maturin.get_requires_for_build_wheel
    prepare_metadata_for_build_editable = maturin.prepare_metadata_for_build_editable
    prepare_metadata_for_build_wheel = maturin.prepare_metadata_for_build_wheel

SOURCES = Path(__file__).parent


def build_wheel(folder: str, settings: dict[str, Any] | None = None, metadata: str | None = None) -> str:
    """Build a wheel in two steps.

    The compiled module in the first wheel provides the type information for the second wheel. The second step does not
    compile the module again.
    """
    read_types(Path(folder, maturin.build_wheel(folder, settings, metadata)))
    return str(maturin.build_wheel(folder, settings, metadata))


def build_editable(folder: str, settings: dict[str, Any] | None = None, metadata: str | None = None) -> str:
    """Build an editable installation, which uses the sources directly."""
    name = str(maturin.build_editable(folder, settings, metadata))
    write_types(SOURCES)
    return name


def read_types(wheel: Path) -> None:
    """Write the type information from the compiled module in a wheel."""
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as built:
        with zipfile.ZipFile(wheel) as packed:
            packed.extractall(built)
        write_types(built)


def write_types(built: str | Path) -> None:
    """Write `_vocabulary.pyi` beside the sources. This file describes all names that `_vocabulary.py` creates at run time.

    * `built`: folder that contains the built package.
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
