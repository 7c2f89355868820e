"""Provide a browser and servers of the program to the tests of the page."""

import json
import os
import shutil
import subprocess
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, sync_playwright

ROOT = Path(__file__).resolve().parents[3]
BSM = str(ROOT / os.environ.get("BSM", "target/debug/bsm"))

# Flags for Chromium: its sandbox does not run as root, and WebGL runs on the CPU if there is no graphics card.
FLAGS = ["--no-sandbox", "--enable-unsafe-swiftshader"]

# Time limit for a page [ms], sufficient for a debug build on a busy machine.
PATIENCE = 120_000


# Times measured by tests, printed at the end of the run.
MEASURED: list[str] = []


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    for words in MEASURED:
        terminalreporter.write_line(words)


def example(name: str) -> Path:
    return ROOT / "examples" / f"{name}.json"


def bsm(*arguments: str | Path) -> str:
    """Return the output of the program. The exit code for a missing solution is accepted."""
    found = subprocess.run([BSM, *map(str, arguments)], capture_output=True, text=True, check=False)
    assert found.returncode in (0, 3), found.stderr
    return found.stdout


def solved(*arguments: str | Path) -> dict[str, object]:
    return json.loads(bsm("solve", *arguments, "--json"))


class Server:
    """The program, running as a server."""

    def __init__(self, case: Path, *arguments: str | Path) -> None:
        command = [BSM, "view", str(case), *map(str, arguments)]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        self.address = self.process.stdout.readline().strip()
        assert self.address.startswith("http://127.0.0.1:"), self.address

    def end(self) -> None:
        self.process.kill()
        self.process.wait()


@pytest.fixture(scope="session")
def browser() -> Iterator[Browser]:
    with sync_playwright() as playwright:
        path = shutil.which("chromium")
        browser = playwright.chromium.launch(executable_path=path, args=FLAGS)
        yield browser
        browser.close()


@pytest.fixture
def serve() -> Iterator[Callable[..., Server]]:
    running: list[Server] = []

    def start(case: Path, *arguments: str | Path) -> Server:
        running.append(Server(case, *arguments))
        return running[-1]

    yield start
    for served in running:
        served.end()


@pytest.fixture
def save_page(tmp_path: Path) -> Callable[..., str]:
    def save(*cases: Path) -> str:
        """Write the page as a file, and return its address."""
        out = tmp_path / f"{cases[0].stem}.html"
        command = [BSM, "view", *map(str, cases), "-o", str(out)]
        found = subprocess.run(command, capture_output=True, text=True, check=False)
        if "built without the solver that pages contain" in found.stderr:
            pytest.skip("bsm was built without the solver that pages contain; run crates/bsm-view/page-solver and build bsm again")
        assert found.returncode == 0, found.stderr
        return out.as_uri()

    return save


def settled(page: Page) -> None:
    """Wait until all panels are up to date."""
    page.wait_for_selector("html[data-settled]", state="attached", timeout=PATIENCE)


class Sheet:
    """A page with its errors and requests."""

    def __init__(self, page: Page) -> None:
        self.page, self.errors, self.requests = page, [], []
        page.on("pageerror", lambda error: self.errors.append(str(error)))
        page.on("console", lambda message: self.errors.append(message.text) if message.type == "error" else None)
        page.on("request", lambda request: self.requests.append(request.url))

    def open(self, address: str) -> Page:
        self.page.goto(address)
        settled(self.page)
        return self.page

    def again(self, act: Callable[[], object]) -> None:
        """Perform an action, and wait until the page is up to date."""
        self.page.evaluate("delete document.documentElement.dataset.settled")
        act()
        settled(self.page)


@pytest.fixture
def sheet(browser: Browser) -> Iterator[Callable[..., Sheet]]:
    contexts = []

    def new(width: int = 1300, scheme: str = "light", **options: object) -> Sheet:
        context = browser.new_context(
            viewport={"width": width, "height": 900}, color_scheme=scheme, reduced_motion="reduce", **options
        )
        contexts.append(context)
        return Sheet(context.new_page())

    yield new
    for context in contexts:
        context.close()
