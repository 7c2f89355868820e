"""Write the pictures of docs/guide/look.md: pictures.py FOLDER."""

import shutil
import sys
from pathlib import Path

from conftest import FLAGS, Server, Sheet, example
from playwright.sync_api import sync_playwright

# Each picture has a name, a case, the width and height of the window, a color scheme and a panel.
# If the panel is None, the picture shows the whole window.
PICTURES = [
    ("view", "feed_drive", 1280, 860, "light", None),
    ("view-ellipses", "feed_drive", 1280, 860, "light", "ellipses"),
    ("view-map", "feed_drive", 1280, 860, "light", "map"),
    ("view-nut", "nut_double", 1280, 860, "light", "nut"),
]


def main(folder: Path) -> None:
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=FLAGS)
        for name, case, width, height, scheme, panel in PICTURES:
            served = Server(example(case))
            size = {"width": width, "height": height}
            context = browser.new_context(viewport=size, color_scheme=scheme, reduced_motion="reduce")
            page = Sheet(context.new_page()).open(served.address)
            shown = page.locator("section.panel", has=page.locator(f"#h-{panel}")) if panel else page
            shown.screenshot(path=folder / f"{name}.png")
            context.close()
            served.end()
        browser.close()


if __name__ == "__main__":
    main(Path(sys.argv[1]))
