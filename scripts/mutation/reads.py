"""Which shader files a command reads: by the time of the last access, or, where the file system keeps none, by inotify."""

import ctypes
import os
import struct

IN_OPEN, IN_ONESHOT = 0x20, 0x80000000


def _paths(shaders):
    for folder, _, names in os.walk(shaders):
        yield from (os.path.join(folder, name) for name in names if name.endswith(".wgsl"))


class AccessTimes:
    """Sets the time of access of every file to 0; whoever reads it changes that."""

    def __init__(self, shaders):
        self.paths = list(_paths(shaders))
        for path in self.paths:
            os.utime(path, ns=(0, os.stat(path).st_mtime_ns))

    def read(self):
        return [path for path in self.paths if os.stat(path).st_atime_ns != 0]

    def close(self):
        pass


class Inotify:
    """Watches every file until it is opened once. Only Linux has it."""

    def __init__(self, shaders):
        libc = ctypes.CDLL(None, use_errno=True)
        self.fd = libc.inotify_init1(os.O_NONBLOCK | os.O_CLOEXEC)
        if self.fd < 0:
            raise OSError(ctypes.get_errno(), "inotify_init1")
        self.watched = {}
        for path in _paths(shaders):
            watch = libc.inotify_add_watch(self.fd, os.fsencode(path), ctypes.c_uint32(IN_OPEN | IN_ONESHOT))
            if watch < 0:
                os.close(self.fd)
                raise OSError(ctypes.get_errno(), "inotify_add_watch")
            self.watched[watch] = path

    def read(self):
        opened = set()
        while True:
            try:
                events = os.read(self.fd, 1 << 16)
            except BlockingIOError:
                return sorted(opened)
            at = 0
            while at < len(events):
                watch, mask, _, length = struct.unpack_from("iIII", events, at)
                at += struct.calcsize("iIII") + length
                if mask & IN_OPEN and watch in self.watched:
                    opened.add(self.watched[watch])

    def close(self):
        os.close(self.fd)


def names(method, shaders, action):
    """The result of `action`, and the names (without .wgsl) of the shader files that were read meanwhile; none without a method."""
    if method is None:
        return action(), None
    watch = method(shaders)
    try:
        result = action()
        read = watch.read()
    finally:
        watch.close()
    return result, sorted(os.path.relpath(path, shaders)[: -len(".wgsl")].replace(os.sep, "/") for path in read)


def works(method, folder):
    """Does a method see, in this folder, which of two files is read?"""
    files = {name: os.path.join(folder, name + ".wgsl") for name in ("left", "taken")}
    for path in files.values():
        with open(path, "w", encoding="utf-8") as file:
            file.write("text")

    def take():
        with open(files["taken"], encoding="utf-8") as file:
            file.read()

    try:
        return names(method, folder, take)[1] == ["taken"]
    except (OSError, AttributeError):
        return False
    finally:
        for path in files.values():
            os.remove(path)


def method(folder):
    """The first method that works in a folder, or none."""
    return next((one for one in (AccessTimes, Inotify) if works(one, folder)), None)
