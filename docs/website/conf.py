"""Settings of Sphinx for the documentation site; docs/website/make.py puts the pages together."""

import os
import sys
from pathlib import Path
from typing import Any

# docstrings of the compiled module keep the types of their arguments
os.environ["RBDYN_TYPES_IN_DOCSTRINGS"] = "1"
sys.path.insert(0, str(Path(__file__).resolve().parent))

import python_reference  # noqa: E402
import rbdyn  # noqa: E402

project, author, release = "rbdyn", "rbdyn authors", rbdyn.__version__
extensions = ["myst_parser", "sphinx.ext.autodoc"]
html_theme = "furo"
html_title = "rbdyn"
html_static_path = ["static"]
html_css_files = ["extra.css"]
html_copy_source = html_show_sourcelink = False
highlight_language = "text"
smartquotes = False
myst_heading_anchors = 4
autoclass_content = "both"
autodoc_member_order = "groupwise"
autodoc_typehints_format = "short"
python_use_unqualified_type_names = True
toc_object_entries_show_parents = "hide"


def short_signature(app: Any, what: str, name: str, of: Any, options: Any, signature: Any, result: Any) -> Any:
    short = python_reference.shortened
    return signature and short(signature), result and short(result)


def plain_docstring(app: Any, what: str, name: str, of: Any, options: Any, lines: list[str]) -> None:
    lines[:] = python_reference.escaped(lines)


def setup(app: Any) -> None:
    app.connect("autodoc-process-signature", short_signature)
    app.connect("autodoc-process-docstring", plain_docstring)
