"""Sphinx configuration of the book, which `just book` builds.

The book is a site that contains README, docs and executed notebooks, and can be searched and read offline.
docs/README.md is the table of contents: each heading is a part of the book, and each link below it is a chapter.
The pages of docs/reference end with the help texts and schemas that the program prints.
"""

import html
import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

from docutils.nodes import SkipNode

ROOT = Path(__file__).parents[2]
KATEX = ROOT / "docs/katex"

# python/check builds the package in this folder.
sys.path.insert(0, str(ROOT / "python"))
autodoc_member_order = "groupwise"
autodoc_typehints = "none"
napoleon_use_ivar = True

project = "bsm"
root_doc = "README"
include_patterns = ["README.md", "CONTRIBUTING.md", "docs/**.md", "python/notebooks/*.py"]
exclude_patterns = ["target", ".git", "crates"]
extensions = ["myst_nb", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 4
# Sphinx executes a notebook whenever it reads the notebook, and python/check forces it to read all notebooks. The cache
# of myst-nb is not used, because it writes notebooks without outputs.
nb_custom_formats = {".py": ["jupytext.reads", {"fmt": "py:percent"}]}
nb_execution_mode = "force"
nb_execution_raise_on_error = True
# Time limit of a cell [s]. The slowest cell takes 5 s on two idle cores.
nb_execution_timeout = 300
nb_merge_streams = True
html_theme = "furo"
html_title = "bsm: ball screws"
html_static_path = [str(KATEX / "katex.css"), "book.css"]
html_css_files = ["katex.css", "book.css"]
html_copy_source = False
html_math_renderer = "katex"
# Two warnings are suppressed. Code fences contain file names (`csv loads.csv`) or state how tests run them (`sh long`),
# and several classes of the Python package have attributes with the same name, such as `message`.
suppress_warnings = ["misc.highlighting_failure", "ref.python"]
html_show_copyright = False
html_permalinks_icon = "#"


def prepare_kernel():
    """Configure the kernel of the notebooks so that it can import the package and draws pictures as SVG."""
    profile = ROOT / "target/ipython/profile_default"
    profile.mkdir(parents=True, exist_ok=True)
    settings = 'c.InlineBackend.figure_formats = {"svg"}\nc.IPKernelApp.log_level = "ERROR"\n'
    (profile / "ipython_kernel_config.py").write_text(settings, encoding="utf-8")
    os.environ["IPYTHONDIR"] = str(profile.parent)
    os.environ["PYTHONPATH"] = str(ROOT / "python")
    os.environ.pop("MPLBACKEND", None)


def program():
    """Return the first existing program: the path in `BSM`, the release build, or the debug build."""
    for place in os.environ.get("BSM", ""), ROOT / "target/release/bsm", ROOT / "target/debug/bsm":
        if Path(place).is_file():
            return place
    raise FileNotFoundError("build the program first: cargo build -p bsm-cli")


def said(*arguments):
    return subprocess.run([program(), *arguments], capture_output=True, text=True, check=True).stdout


def leaves(schema):
    """Return all values of a JSON Schema that have a description, by name.

    Some results repeat the inputs of the case. These inputs are omitted.
    """
    found = {}
    for name, entry in schema.get("properties", {}).items():
        if name in ("inputs", "case"):
            continue
        found |= {name: entry} if "description" in entry else leaves(entry)
    for part in schema.get("anyOf", []) + ([schema["items"]] if "items" in schema else []):
        found |= leaves(part)
    return found


def table(schema, above=None):
    """Return a Markdown table of the names in a JSON Schema, with their permitted values and meanings.

    Rows in `above` are omitted, and only their names are listed below the table. New rows are added to `above`.
    """
    repeated = []
    bounds = {"exclusiveMinimum": "> ", "minimum": "≥ ", "exclusiveMaximum": "< ", "maximum": "≤ ", "default": "default "}
    rows = ["| name | value | meaning |", "|---|---|---|"]
    for name, entry in leaves(schema).items():
        kinds = entry.get("enum", entry.get("type", []))
        kinds = [str(kind) for kind in (kinds if isinstance(kinds, list) else [kinds]) if kind not in (None, "null")]
        rules = [f"{sign}{entry[key]}".removesuffix(".0") for key, sign in bounds.items() if key in entry]
        row = f"| `{name}` | {'; '.join([', '.join(kinds), *rules])} | {entry['description']} |".replace("$", r"\$")
        if above is not None and row in above:
            repeated.append(f"`{name}`")
            continue
        rows.append(row)
    if above is not None:
        above.update(rows[2:])
    if repeated:
        rows += ["", f"These results are described in the tables above: {', '.join(repeated)}."]
    return "\n".join(rows) + "\n"


def units():
    """Return a Markdown table that lists the units of each quantity."""
    rows = ["## Units", "", "| quantity | units at the end of a name (units of the vocabulary first) |", "|---|---|"]
    for quantity, endings in json.loads(said("schema", "units")).items():
        rows.append(f"| {quantity} | {' '.join(f'`{unit}`' for unit in endings)} |")
    return "\n".join(rows) + "\n"


def commands():
    summary = said("--help")
    names = re.findall(r"^  (\w+) ", summary.split("Commands:")[1].split("Options:")[0], re.MULTILINE)
    for name in names:
        if name != "help":
            yield f"## bsm {name}\n\n```text\n{said(name, '--help')}```\n"


def outputs():
    names = {"output": "bsm solve, bsm sweep"}
    names |= {name: f"bsm solve --show {name}" for name in ("slip", "jam", "optimum", "ratings")}
    names |= {name: f"bsm {name}" for name in ("nut", "axis", "select", "fit")}
    anchors = {command: command.replace(",", "").replace(" ", "-") for command in names.values()}
    yield "Sections: " + ", ".join(f"[{command}](#{anchor})" for command, anchor in anchors.items()) + ".\n"
    above = set()
    for name, command in names.items():
        yield f"## {command}\n\n{table(json.loads(said('schema', name)), above)}"


GENERATED = {
    "docs/reference/commands": lambda: "\n".join(commands()),
    "docs/reference/inputs": lambda: table(json.loads(said("schema", "input"))) + "\n" + units(),
    "docs/reference/outputs": lambda: "\n".join(outputs()),
}


def contents():
    """Yield a hidden table of contents for each heading of docs/README.md with links below it."""
    text = (ROOT / "docs/README.md").read_text(encoding="utf-8")
    yield "\n```{toctree}\n:hidden:\nContents </docs/README.md>\n```\n"
    seen = {"README.md"}
    for part in text.split("\n## ")[1:]:
        title, body = part.split("\n", 1)
        lines = []
        for label, address in re.findall(r"\[([^]]+)\]\(([^)#]+\.(?:md|py))[^)]*\)", body):
            path = os.path.relpath(ROOT / "docs" / address, ROOT)
            if path not in seen:
                seen.add(path)
                lines.append(f"{label[0].upper()}{label[1:]} </{path}>")
        if lines:
            chapters = "\n".join(lines)
            yield f"\n```{{toctree}}\n:hidden:\n:caption: {title}\n{chapters}\n```\n"


def read(_app, name, source):
    if name in GENERATED:
        # These sentences only apply outside the book.
        outside = r" (In a clone of the repository, this page|The documentation site that `just book` builds)[^.]*\."
        source[0] = re.sub(outside, "", source[0]) + "\n" + GENERATED[name]()
    if name == "README":
        source[0] += "".join(contents())
    if name.startswith("python/notebooks/"):
        stem = name.rsplit("/", 1)[1]
        source[0] += f"\n# %% [markdown]\n# Download the executed {{nb-download}}`notebook <{stem}.ipynb>` or the {{download}}`script <{stem}.py>`.\n"


def formula(self, node, form):
    """Write a formula with the same markup as rustdoc. The script in docs/katex renders this markup."""
    self.body.append(form.format(html.escape(node.astext(), quote=False)))
    raise SkipNode


def finish(app, error):
    if not error:
        shutil.copy(Path(app.outdir, "README.html"), Path(app.outdir, "index.html"))


def setup(app):
    prepare_kernel()
    inline = lambda self, node: formula(self, node, "<code>${}$</code>")
    block = lambda self, node: formula(self, node, '<pre class="language-math"><code>{}</code></pre>')
    app.add_html_math_renderer("katex", (inline, None), (block, None))
    script = (KATEX / "header.html").read_text(encoding="utf-8")
    app.add_js_file(None, body=re.sub("</?script>", "", script))
    app.connect("source-read", read)
    app.connect("build-finished", finish)
