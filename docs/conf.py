"""Configuration of the documentation."""

import importlib.metadata
import os
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent / "_ext"))
import executed

project = "stickslip"
author = "The stickslip authors"
project_copyright = "2026, The stickslip authors"
release = importlib.metadata.version("stickslip")
version = release

extensions = [
    "examples",
    "gallery",
    "generated",
    "mathml",
    "myst_nb",
    "notebooks",
    "numpydoc",
    "records",
    "sidebar",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinxcontrib.bibtex",
]
exclude_patterns = ["_build", "_ext", "_templates", "ratios.md"]
templates_path = ["_templates"]
default_role = "py:obj"

autosummary_generate = True
autodoc_member_order = "bysource"
autodoc_typehints = "none"  # numpydoc sections state types, shapes and units
numpydoc_show_class_members = False

myst_enable_extensions = ["amsmath", "deflist", "dollarmath", "fieldlist"]
myst_heading_anchors = 3

# where pages find `benchmarks`
os.environ["PYTHONPATH"] = os.pathsep.join(
    filter(None, (str(Path(__file__).parents[1]), os.environ.get("PYTHONPATH")))
)
os.environ["STICKSLIP_FILES"] = str(Path(__file__).parent / "howto/files")  # that pages download
nb_execution_in_temp = True  # examples that write files leave none behind
nb_execution_cache_path = executed.kept()
nb_execution_mode = "cache"
nb_execution_raise_on_error = True
nb_execution_timeout = -1  # none: on a loaded machine a cell takes as long as it takes
nb_merge_streams = True
nb_output_stderr = "remove"  # what an empty cache has to say is no part of a page
nb_ipywidgets_js: dict[str, dict[str, str]] = {}  # pages load nothing from the network
nb_render_image_options = {"width": "100%"}

bibtex_bibfiles = ["../src/stickslip/friction/references.bib"]
bibtex_default_style = "plain"

html_theme = "furo"
html_static_path = ["_static"]
html_css_files = ["page.css"]
html_title = f"stickslip {release}"
html_math_renderer = "mathml"
html_copy_source = False
html_show_sphinx = False
