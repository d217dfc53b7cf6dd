# SPDX-License-Identifier: GPL-3.0-or-later
"""Base of operators that cancel a running worker."""


class Cancelling:
    """`jobs` is the module whose running() is the worker to cancel."""

    jobs = None

    @classmethod
    def poll(cls, _context):
        return cls.jobs.running() is not None

    def execute(self, _context):
        self.jobs.running().cancel()
        return {"FINISHED"}
