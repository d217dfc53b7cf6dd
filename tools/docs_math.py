# SPDX-License-Identifier: GPL-3.0-or-later
"""A Sphinx renderer that converts formulas to MathML when the site is built, so that pages load no external script."""

import re

from docutils import nodes
from latex2mathml.converter import convert

THIN_SPACE = '<mspace width="0.17em"/>'
FUNCTION = "<mi>(?:cos|ln|sin|sinh|tan|tanh)</mi>"


def setup(app):
    app.add_html_math_renderer("mathml", (_inline, None), (_block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def _inline(writer, node):
    writer.body.append(_mathml(node, "inline"))
    raise nodes.SkipNode


def _block(writer, node):
    writer.body.append(_mathml(node, "block"))
    raise nodes.SkipNode


def _mathml(node, display):
    """The formula, with thin spaces between a named function and what stands before and after, as LaTeX has them."""
    formula = re.sub(f"(?<=</m[in]>)(?={FUNCTION})", THIN_SPACE, convert(node.astext(), display=display))
    return re.sub(f"({FUNCTION})(?=<m[in]>)", rf"\1{THIN_SPACE}", formula)
