"""Copy the last picture of each executed notebook to docs/img for the gallery. Build the book before you run this script."""

import json
import re
from pathlib import Path

ROOT = Path(__file__).parents[2]


def pictures(notebook):
    """Yield the SVG pictures of an executed notebook."""
    for cell in notebook["cells"]:
        for output in cell.get("outputs", []):
            lines = output.get("data", {}).get("image/svg+xml")
            if lines is not None:
                yield "".join(lines)


for path in sorted((ROOT / "target/jupyter_execute/python/notebooks").glob("*.ipynb")):
    *_, last = pictures(json.loads(path.read_text(encoding="utf-8")))
    # The metadata contain the time at which the picture was drawn.
    last = re.sub(r" <metadata>.*?</metadata>\n", "", last, flags=re.DOTALL)
    (ROOT / f"docs/img/notebook-{path.stem.replace('_', '-')}.svg").write_text(last, encoding="utf-8")
