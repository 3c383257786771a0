"""Receives a picture as the viewer tev does: wavepath connects, and sends all channels again and again."""

import socket
import struct
import threading

import numpy

CREATE_IMAGE, UPDATE_IMAGE = 4, 5
LONGEST_PACKET = 1 << 30


class Receiver:
    """Listens on a port of this machine. ``take()`` gives the newest whole picture, each but once."""

    def __init__(self):
        self._lock = threading.Lock()
        self._channels, self._size, self._rows = {}, (0, 0), 0
        self._whole = None
        self.problem = None
        self._listener = socket.create_server(("127.0.0.1", 0), backlog=1)
        self.address = "127.0.0.1:%d" % self._listener.getsockname()[1]
        self._connection = None
        self._thread = threading.Thread(target=self._serve, daemon=True)
        self._thread.start()

    def take(self):
        """Channels by name, each (height, width), top row first; or None if nothing has come since."""
        with self._lock:
            whole, self._whole = self._whole, None
        return whole

    def wait(self, seconds):
        """Until the sender, which has ended, has been read to its end. There is none if it ended early."""
        self._thread.join(0.2)
        if self._connection is not None:
            self._thread.join(seconds)

    def close(self):
        """Hang up, whatever is still under way."""
        for end in (self._connection, self._listener):
            if end is not None:
                try:
                    end.shutdown(socket.SHUT_RDWR)
                except OSError:
                    pass
                end.close()
        self._thread.join(5)

    def _serve(self):
        try:
            self._connection, _ = self._listener.accept()
            with self._connection, self._connection.makefile("rb", buffering=1 << 20) as stream:
                while True:
                    head = stream.read(4)
                    if len(head) < 4:
                        return
                    (length,) = struct.unpack("<I", head)
                    if not 6 <= length <= LONGEST_PACKET:
                        raise ValueError("a packet of %d bytes" % length)
                    packet = stream.read(length - 4)
                    if len(packet) < length - 4:
                        return
                    self._read(packet)
        except (OSError, ValueError, struct.error) as problem:
            self.problem = str(problem)

    def _read(self, packet):
        operation = packet[0]
        _, at = _text(packet, 2)
        if operation == CREATE_IMAGE:
            width, height, count = struct.unpack_from("<3I", packet, at)
            names, _ = _texts(packet, at + 12, count)
            self._size, self._rows = (width, height), 0
            self._channels = {name: numpy.zeros((height, width), numpy.float32) for name in names}
        elif operation == UPDATE_IMAGE:
            (count,) = struct.unpack_from("<I", packet, at)
            names, at = _texts(packet, at + 4, count)
            x, y, width, height = struct.unpack_from("<4I", packet, at)
            values = numpy.frombuffer(packet, "<f4", count * height * width, at + 16).reshape(count, height, width)
            for name, tile in zip(names, values):
                self._channels[name][y : y + height, x : x + width] = tile
            self._rows = y + height
            if self._rows == self._size[1]:
                with self._lock:
                    self._whole = {name: values.copy() for name, values in self._channels.items()}
        else:
            raise ValueError("operation %d, which is none of a render" % operation)


def _text(packet, at):
    end = packet.index(b"\0", at)
    return packet[at:end].decode(), end + 1


def _texts(packet, at, count):
    names = []
    for _ in range(count):
        name, at = _text(packet, at)
        names.append(name)
    return names, at
