# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks of a stack's JSON by `lamina`: the result is a stack or an error.

The panel asks about the same stack many times a second, and a colour needs a solve, so the latest answers are
cached. Threads may ask too.
"""

import json

from ..base import native

KEPT = 64

_answers = {}  # (package, JSON) -> (stack, error)


def of(text):
    """(stack, None), or (None, lamina.StackError). Raises NativeMissingError."""
    lamina = native.require()
    answer = _answers.get((lamina, text))
    if answer is None:
        answer = _ask(lamina, text)
        for oldest in list(_answers)[: len(_answers) - KEPT + 1]:
            _answers.pop(oldest, None)
        _answers[lamina, text] = answer
    return answer


def is_quick(text):
    """True if `of` answers without a solve. Raises NativeMissingError."""
    return '"color"' not in text or (native.require(), text) in _answers


def forget():
    _answers.clear()


def _ask(lamina, text):
    try:
        stack = lamina.Stack.from_json(json.loads(text))
        stack.canonical()  # solves for colours now, so that later uses by the panel are quick
        return stack, None
    except lamina.StackError as error:
        return None, error
