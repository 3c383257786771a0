"""A program that runs beside Blender: its lines on stderr, its progress, and its end."""

import fcntl
import os
import re
import signal
import struct
import subprocess
import termios
import threading

PROGRESS = re.compile(r"(\d+) %\s+(\d+)/(\d+) spp")
CLEAR = "\r\x1b[K"


class Process:
    """stderr is a terminal to the program, so that wavepath tells its progress every 100 ms and not every 5 s."""

    def __init__(self, command, environment=None):
        ours, theirs = os.openpty()
        try:
            fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("4H", 50, 4000, 0, 0))
            self._child = subprocess.Popen(
                command,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=theirs,
                start_new_session=True,  # Ctrl-C in a terminal is for Blender, which passes it on
                env={**os.environ, "TERM": "xterm", **(environment or {})},
            )
        except BaseException:
            os.close(ours)
            raise
        finally:
            os.close(theirs)
        self.fraction = 0.0
        self.status = ""
        self.lines = []
        self._reader = threading.Thread(target=self._read, args=(ours,), daemon=True)
        self._reader.start()

    def wait(self, seconds):
        """The exit code, or None if it still runs after this time."""
        try:
            code = self._child.wait(seconds)
        except subprocess.TimeoutExpired:
            return None
        self._reader.join(5)
        return code

    def interrupt(self):
        self._signal(signal.SIGINT)

    def kill(self):
        self._signal(signal.SIGKILL)

    def _signal(self, number):
        if self._child.poll() is None:
            try:
                os.killpg(self._child.pid, number)
            except ProcessLookupError:
                pass

    def _read(self, terminal):
        pending = ""
        with open(terminal, "rb", buffering=0) as stream:
            while True:
                try:
                    data = stream.read(1 << 16)
                except OSError:  # a terminal's way to tell that nobody writes any more
                    data = b""
                if not data:
                    break
                pending += data.decode("utf-8", "replace")
                *whole, pending = re.split(r"\r?\n|\r\x1b\[K", pending)
                for line in whole:
                    self._line(line)
                found = PROGRESS.search(pending)
                if found:
                    self._progress(found)
        self._line(pending)

    def _line(self, line):
        found = PROGRESS.search(line)
        if found:
            self._progress(found)
        elif line.strip():
            self.lines.append(line.strip())

    def _progress(self, found):
        self.fraction = int(found[1]) / 100
        self.status = found.string[found.start(2) :].strip()
