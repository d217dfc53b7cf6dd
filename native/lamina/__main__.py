# SPDX-License-Identifier: GPL-3.0-or-later
import io
import sys

from .cli import main

# A name that the terminal's encoding lacks must not end a command whose file is written.
if isinstance(sys.stdout, io.TextIOWrapper) and sys.stdout.errors == "strict":
    sys.stdout.reconfigure(errors="backslashreplace")
sys.exit(main())
