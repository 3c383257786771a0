"""Reads the colours of an OpenEXR picture with the standard library, once oiiotool has unpacked it."""

import pathlib
import struct
import subprocess
import tempfile


def header(data):
    """Attributes by name, and where they end."""
    at, found = 8, {}

    def word():
        nonlocal at
        end = data.index(0, at)
        text, at = data[at:end].decode(), end + 1
        return text

    while name := word():
        word()  # its type
        size, = struct.unpack_from("<i", data, at)
        found[name] = data[at + 4:at + 4 + size]
        at += 4 + size
    return found, at


def read_exr(path):
    """Width, height and a list of (r, g, b)."""
    with tempfile.TemporaryDirectory() as folder:
        plain = pathlib.Path(folder) / "plain.exr"
        subprocess.run(["oiiotool", path, "--ch", "R,G,B", "-d", "float", "--scanline", "--compression", "none", "-o",
                        plain],
                       check=True)
        data = plain.read_bytes()
    found, at = header(data)
    x0, y0, x1, y1 = struct.unpack("<4i", found["dataWindow"])
    width, height = x1 - x0 + 1, y1 - y0 + 1
    at += 8 * height  # of the lines' places
    pixels = []
    for _ in range(height):
        b, g, r = (struct.unpack_from(f"<{width}f", data, at + 8 + 4 * width * c) for c in range(3))
        pixels += zip(r, g, b)
        at += 8 + 12 * width
    return width, height, pixels
