# SPDX-License-Identifier: GPL-3.0-or-later
"""`--command lamina bake`: the materials of the open file, or of many files.

For each file: take its lock, open it, plan each material, check the place of the save, get the tables, build
the node groups in the order of the plans, save. The tables alone come from several processes, so the files do
not depend on the number of processes.
"""

import time
from contextlib import nullcontext

from ..base import messages, native
from . import blend_saving, report, selection, waiting, words
from .exit_codes import FAILED, INTERRUPTED, OK, USAGE, UsageError
from .file_lock import FileLock
from .finished_tables import FinishedTables
from .plan import Plan


def run(arguments):
    """Returns the exit code. Raises UsageError, NativeMissingError."""
    lamina = native.require()
    files, names = selection.split(arguments.names)
    names += arguments.materials
    files = selection.files(files) or [None]
    targets = selection.targets(files, arguments)
    stack = _stack(arguments)
    if not names and (stack is not None or arguments.over):
        raise UsageError("--stack and --over need names or patterns of the materials that they are for")
    with report.Report(arguments) as told, waiting.Interruptible():
        code, reason = OK, None
        try:
            with FinishedTables(arguments, told.complain, reads_only=arguments.dry_run) as tables:
                batch = _Batch(arguments, names, stack, targets, tables, told)
                try:
                    code = batch.open_file() if files == [None] else batch.files(files)
                except (KeyboardInterrupt, lamina.Cancelled):
                    code, reason = INTERRUPTED, batch.interruption()
        except UsageError as error:
            code, reason = USAGE, str(error)
        except (native.NativeMissingError, blend_saving.SaveError) as error:
            code, reason = FAILED, str(error)
        if reason is not None:
            told.complain(reason)
        return code if told.finish(code, reason) else code or FAILED


def _stack(arguments):
    """The stack of --stack, checked before any material is touched; None without one."""
    if arguments.stack is None:
        return None
    try:
        return native.require().Stack.load(arguments.stack)
    except (ValueError, OSError) as error:
        raise UsageError(f"--stack {arguments.stack}: {messages.sentence(error)}") from error


class _Batch:
    def __init__(self, arguments, names, stack, targets, tables, told):
        self._arguments, self._names, self._stack = arguments, names, stack
        self._targets, self._tables, self._told = targets, tables, told
        self._missed = dict.fromkeys(names)  # names that no file had so far, with the sentence for one file
        self._failed, self._saved, self._count = False, 0, 1
        self._fresh = {}  # files that were found up to date while looking ahead: records of their materials

    def open_file(self):
        """Bake the open file. Returns the exit code. Raises UsageError, SaveError."""
        self._file(None)
        if None not in self._targets and not self._arguments.dry_run:
            self._told.complain("nothing was saved (give --save or --output FILE.blend)")
        return FAILED if self._failed else OK

    def files(self, files):
        """Bake these files, one after the other. Returns the exit code."""
        self._count = len(files)
        if self._arguments.jobs > 1 and not self._arguments.dry_run:
            for file in files:
                self._look_ahead(file)
        for file in files:
            try:
                self._file(file)
            except Exception as error:  # the other files go on
                self._failed = True
                self._told.file(file, self._targets.get(file), "failed", messages.sentence(error))
        for name in filter(None, self._missed):
            self._failed = True
            self._told.complain(f"no material with layers matches {name!r} in any file")
        counts = ", ".join(f"{number} {status}" for status, number in self._told.counts().items())
        self._told.line(f"lamina: {self._count} files; materials: {counts or 'none'}")
        if not self._targets and not self._arguments.dry_run:
            self._told.complain(
                f"nothing was saved (give --save or --output FOLDER); finished bakes are in "
                f"{self._tables.folder}"
            )
        return FAILED if self._failed else OK

    def interruption(self):
        """The sentence about an interruption."""
        sentence = f"{self._saved} of {self._count} files are saved" if self._saved else "nothing was saved"
        kept = f"; finished bakes are in {self._tables.folder}" if self._tables.count else ""
        return f"interrupted: {sentence}{kept}"

    def _look_ahead(self, file):
        """Begin the bakes of a file, so that all processes have work. Problems are told later."""
        waiting.check()
        try:
            selection.open_file(file)
            plans = self._plans(file)
        except Exception:
            return
        if self._is_done(plans) and all(plan.is_fresh for plan in plans):
            self._fresh[file] = [report.record(plan, "up to date") for plan in plans]
        for plan in plans:
            if plan.wanted is not None and not plan.is_fresh:
                self._tables.begin(plan.wanted)

    def _file(self, file):
        """Bake one file, or the open one. Raises UsageError, SaveError, RefusedError, KeyboardInterrupt."""
        waiting.check()
        if file in self._fresh:
            for record in self._fresh[file]:
                self._told.material(file, record, "up to date")
            self._told.file(file, self._targets.get(file), "unchanged")
            return
        target = self._targets.get(file)
        if target is not None:
            blend_saving.check_writable(target)
        with FileLock(target) if target is not None and not self._arguments.dry_run else nullcontext():
            if file is not None:
                selection.open_file(file)
            saving = blend_saving.Saving(target) if target is not None else None
            plans = self._plans(file)
            if saving is not None:
                saving.check_space(sum(plan.growth for plan in plans))
            if self._arguments.dry_run:
                self._tell_only(file, target, plans)
                return
            self._make(file, plans)
            self._save(file, target, saving, plans)

    def _plans(self, file):
        """The plans of the selected materials. Raises UsageError for a name that the open file lacks."""
        with_stack = self._stack is None and not self._arguments.over
        materials, missed = selection.materials(self._names, with_stack)
        if file is None and missed:
            raise UsageError(next(iter(missed.values())))
        for name in set(self._missed) - set(missed):
            del self._missed[name]
        return [Plan(one, self._stack, self._arguments) for one in materials]

    def _is_done(self, plans):
        """True if nothing of the file is to be saved."""
        is_elsewhere = self._arguments.output is not None
        return not is_elsewhere and not any(plan.has_changed for plan in plans)

    def _make(self, file, plans):
        """Get the tables and build the node groups; a line for each material."""
        for plan in plans:
            if plan.wanted is not None and not plan.is_fresh:
                self._tables.begin(plan.wanted)
        left = list(plans)
        try:
            while left:
                waiting.check()
                self._make_one(file, left[0])
                left.pop(0)
        except BaseException:
            for plan in left:
                plan.undo()
            raise

    def _make_one(self, file, plan):
        lamina, seconds, status = native.require(), 0.0, "up to date"
        if plan.error is None and not plan.is_fresh:
            try:
                table = self._tables.get(plan.wanted)
                began = time.perf_counter()
                plan.apply(table.lut)
                seconds = table.seconds + time.perf_counter() - began
                status = "from the cache" if table.is_kept else "baked"
            except lamina.Cancelled:
                raise
            except Exception as error:  # the other materials go on
                plan.fail(error)
        if plan.error is not None:
            self._failed = True
            self._told.material(file, report.record(plan, "failed"), f"failed: {plan.reason}")
            return
        lost = f"; not carried over: {', '.join(plan.lost)}" if plan.lost else ""
        text = "up to date" if plan.is_fresh else words.bake(plan.material.lamina.result, seconds) + lost
        self._told.material(file, report.record(plan, status, seconds), text)

    def _save(self, file, target, saving, plans):
        if saving is None:
            self._told.file(file, None, "not saved")
        elif file is not None and self._is_done(plans):  # scripts may have changed the open file
            self._told.file(file, target, "unchanged")
        else:
            try:
                saving.save()
            except blend_saving.SaveError as error:
                if file is None:
                    self._told.file(None, target, "failed", str(error))
                raise
            self._saved += 1
            self._told.file(file, target, "saved")

    def _tell_only(self, file, target, plans):
        """What a run without --dry-run would do."""
        for plan in plans:
            if plan.error is not None:
                self._failed = True
                self._told.material(file, report.record(plan, "failed"), f"would fail: {plan.reason}")
                continue
            is_kept = not plan.is_fresh and not self._arguments.force and self._tables.has(plan.wanted)
            status = "up to date" if plan.is_fresh else "in the cache" if is_kept else "to be baked"
            self._told.material(
                file, report.record(plan, status), status + (f" ({plan.reason})" if plan.reason else "")
            )
            plan.undo()
        self._told.file(file, target, "not saved")
