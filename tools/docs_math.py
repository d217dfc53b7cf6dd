# SPDX-License-Identifier: GPL-3.0-or-later
"""A Sphinx renderer that converts formulas to MathML when the site is built, so that pages load no external script."""

from docutils import nodes
from latex2mathml.converter import convert


def setup(app):
    app.add_html_math_renderer("mathml", (_inline, None), (_block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def _inline(writer, node):
    writer.body.append(convert(node.astext()))
    raise nodes.SkipNode


def _block(writer, node):
    writer.body.append(convert(node.astext(), display="block"))
    raise nodes.SkipNode
