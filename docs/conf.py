# SPDX-License-Identifier: GPL-3.0-or-later
"""The documentation site. `make docs` builds it into build/docs; a warning is an error."""

import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tools"))

project = "Lamina"
author = "the Lamina contributors"
release = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["version"]
copyright = "the Lamina contributors, GPL-3.0-or-later"

extensions = ["myst_parser", "sphinx.ext.autodoc", "docs_docstrings", "docs_math"]
default_role = "code"
myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 3
source_suffix = {".md": "markdown"}
html_theme = "furo"
html_title = f"Lamina {release}"
html_math_renderer = "mathml"
html_static_path = ["_static"]
html_css_files = ["math.css"]
autodoc_member_order = "bysource"
autodoc_typehints = "description"
autodoc_typehints_description_target = "documented"
