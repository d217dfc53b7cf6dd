# SPDX-License-Identifier: GPL-3.0-or-later
"""What a package index shows of a wheel: README.md with absolute addresses, the project's page and the contact.

The addresses stand in [tool.lamina] of pyproject.toml alone. What is empty there is left out.
"""

import re
import subprocess
import sys

RELATIVE = re.compile(r"\]\((?!#|[a-z]+:)([^)\s]+)\)")


def missing(fields):
    """A sentence about the fields that are to be filled in, or None."""
    empty = [name for name in ("website", "contact", "pictures") if not fields[name]]
    return f"[tool.lamina] of pyproject.toml: {', '.join(empty)}: still empty, left out" if empty else None


def described(metadata, fields):
    """The text of METADATA with the addresses of `fields`: website, contact and pictures."""
    head, blank, text = metadata.partition("\n\n")
    if fields["website"]:
        head += f"\nProject-URL: Homepage, {fields['website']}"
    if fields["contact"]:
        head += f"\nMaintainer-email: {fields['contact']}"
    if fields["pictures"]:
        base = fields["pictures"].rstrip("/")
        text = RELATIVE.sub(lambda link: f"]({base}/{link[1]})", text)
    return head + blank + text


def describe(wheel, fields):
    """Rewrite METADATA inside a wheel."""
    folder = wheel.parent / "unpacked"
    _run("unpack", "--dest", folder, wheel)
    inside = next(folder.iterdir())
    metadata = next(inside.glob("*.dist-info/METADATA"))
    metadata.write_text(described(metadata.read_text(encoding="utf-8"), fields), encoding="utf-8")
    wheel.unlink()
    _run("pack", "--dest-dir", wheel.parent, inside)


def _run(command, *arguments):
    subprocess.run([sys.executable, "-m", "wheel", command, *map(str, arguments)], check=True,
                   stdout=subprocess.DEVNULL)
