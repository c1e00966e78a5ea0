# `make docs` builds these pages offline; warnings are errors. What the program knows (keys, commands, terms) is asked of it while
# they are built (_ext/program.py), what the public headers say is Doxygen's.
import os
import pathlib
import re
import subprocess
import sys

here = pathlib.Path(__file__).parent
root = here.parent
build = pathlib.Path(os.environ.get("MODEBANK_BUILD", root / "build")).resolve()
sys.path[:0] = [str(here / "_ext"), str(build / "python")]
# programoutput runs `modebank` as users do.
os.environ["PATH"] = f"{build}{os.pathsep}{os.environ['PATH']}"
os.environ["COLUMNS"] = "100"

project = "modebank"
version = release = re.search(r"project\(modebank VERSION ([\d.]+)", (root / "CMakeLists.txt").read_text())[1]
author = "the authors of modebank"
copyright = author

extensions = ["myst_parser", "sphinx.ext.mathjax", "sphinx.ext.autodoc", "sphinxcontrib.bibtex", "sphinxcontrib.programoutput", "breathe",
              "program", "made"]
myst_enable_extensions = ["deflist", "dollarmath"]
myst_heading_anchors = 4
highlight_language = "none"  # of blocks that name no language
numfig = True  # equations by chapter of the explanation: (4.2)
numfig_secnum_depth = 1
bibtex_bibfiles = ["references.bib"]
bibtex_reference_style = "author_year"
breathe_projects = {"modebank": str(build / "api/xml")}
breathe_default_project = "modebank"
autodoc_typehints = "none"

# A link within these pages that leads nowhere is an error, and so is a name of ours; those of the standard library, of numpy and
# what a template is instantiated with are not ours to describe.
nitpicky = True
nitpick_ignore_regex = [("cpp:.*", ".*"), ("py:.*", r"(?!modebank).*")]
suppress_warnings = ["myst.xref_ambiguous"]

html_theme = "furo"
html_title = f"modebank {version}"
html_static_path = ["_static", "/usr/share/javascript/katex", "/usr/share/javascript/katex/contrib"]
html_css_files = ["katex.min.css", "modebank.css"]
# KaTeX (Debian's package) sets the formulas in the browser: it needs no network and a tenth of MathJax's files.
mathjax_path = "katex.min.js"
mathjax_options = {}
html_js_files = [("auto-render.js", {"defer": "defer"}), ("formulas.js", {"defer": "defer"})]
html_copy_source = False
html_show_sourcelink = False


def bundle_furo(app, error):
    """Debian's furo.js imports its neighbour, which browsers allow in modules alone and never from a file: esbuild joins the two."""
    script = pathlib.Path(app.outdir) / "_static/scripts/furo.js"
    if error is None and script.is_file() and "import " in script.read_text(encoding="utf-8")[:200]:
        subprocess.run(["esbuild", "--bundle", "--minify", "--log-level=warning", "--allow-overwrite", f"--outfile={script}", str(script)], check=True)


def setup(app):
    app.connect("build-finished", bundle_furo)
