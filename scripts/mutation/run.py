"""Runs one command on a private copy of the shaders, with a time limit, and says what came of it."""

import os
import re
import shutil
import signal
import subprocess
import threading
import time

from . import suite

# What the program says of a shader that is no program: naga's message with its place and excerpt, or a pipeline that is refused.
INVALID = re.compile(r":\d+: error: |┌─ wgsl:\d|the pipeline .+ was refused")
# Lines that are no reason.
NOISE = re.compile(r"^adapter: |^\s*$|XDG_RUNTIME_DIR|judged by its own text|^\d+ cases? in |^note: run with|^warning: ")
# Exit codes of the program.
PASSED, FAILED, DEVICE_LOST, PANIC = 0, 1, 4, 101

# Kinds of results that a mutant running beside on the same device may have caused: they count only if they come twice.
PERHAPS_OTHERS = {"lost", "crash", "refused"}

# All running processes, so that an interrupt ends them.
_running, _lock = set(), threading.Lock()


class Stopped(Exception):
    """The campaign's time is up."""


class Result:
    """`kind`: passed, failed, invalid, hang, crash, lost or refused."""

    def __init__(self, kind, why, seconds):
        self.kind, self.why, self.seconds = kind, why, seconds


def kill_all():
    with _lock:
        for process in list(_running):
            _kill(process)


def _kill(process):
    try:
        os.killpg(process.pid, signal.SIGKILL)
    except (ProcessLookupError, PermissionError):
        pass


def _reason(lines):
    said = [line.strip() for line in lines if not NOISE.search(line)]
    return said[-1][:300] if said else ""


def run(probe, program, shaders, root, limit, environment, deadline=None):
    """Runs a probe; stops it at its first note of a failure.

    Raises Stopped if `deadline` (of time.monotonic) comes first.
    """
    begin = time.monotonic()
    until = begin + limit if deadline is None else min(begin + limit, deadline)
    if until <= begin:
        raise Stopped
    process = subprocess.Popen(
        probe.command(program, shaders), cwd=root, env=environment, start_new_session=True, text=True, encoding="utf-8", errors="replace",
        stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
    )  # fmt: skip
    with _lock:
        _running.add(process)
    late = threading.Event()

    def end():
        late.set()
        _kill(process)

    timer = threading.Timer(until - begin, end)
    timer.start()
    note, noted, lines = suite.FAILED_NOTE.get(probe.step), None, []
    try:
        for line in process.stderr:
            lines.append(line.rstrip("\n"))
            del lines[:-400]
            if noted is None and note and re.search(note, line):
                noted = line.strip()
                # The rest of the note has been written with its first line.
                _kill(process)
        code = process.wait()
    finally:
        timer.cancel()
        _kill(process)
        process.stderr.close()
        with _lock:
            _running.discard(process)
    seconds = time.monotonic() - begin
    if late.is_set():
        if deadline is not None and until == deadline:
            raise Stopped
        return Result("hang", f"no end within {limit:.0f} s", seconds)
    if any(INVALID.search(line) for line in lines):
        first = next(line for line in lines if INVALID.search(line))
        return Result("invalid", (noted or first).strip()[:300], seconds)
    if noted is not None:
        return Result("failed", noted[:300], seconds)
    if code == PASSED:
        return Result("passed", "", seconds)
    kinds = {FAILED: "failed", DEVICE_LOST: "lost", PANIC: "crash"}
    kind = kinds.get(code, "crash" if code < 0 or code > 100 else "refused")
    return Result(kind, _reason(lines) or f"exit code {code}", seconds)


def copy_of(shaders, folder):
    """A private copy of the shaders folder in `folder`."""
    target = os.path.join(folder, "shaders")
    shutil.copytree(shaders, target)
    return target
