"""Reads the colours of an OpenEXR picture: with the standard library, others than ours once oiiotool has unpacked
them."""

import array
import itertools
import pathlib
import struct
import subprocess
import tempfile
import zlib


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


def read_ours(path):
    """The same of a picture as `render` writes it, 32-bit floats in blocks of 16 compressed lines: width, height and an
    array for each of R, G, B. Needs no other program."""
    data = pathlib.Path(path).read_bytes()
    found, at = header(data)
    x0, y0, x1, y1 = struct.unpack("<4i", found["dataWindow"])
    width, height = x1 - x0 + 1, y1 - y0 + 1
    names = [entry.split(b"\0")[0] for entry in channel_entries(found["channels"])]
    if found["compression"] != b"\3" or names != [b"A", b"B", b"G", b"R"]:
        raise ValueError(f"{path}: has other channels than R, G, B and A, or another compression than ZIP")
    channels = {name: array.array("f") for name in names}
    for block in range((height + 15) // 16):
        start, = struct.unpack_from("<Q", data, at + 8 * block)
        _, size = struct.unpack_from("<2i", data, start)
        lines = min(16, height - 16 * block)
        raw, packed = 16 * width * lines, data[start + 8:start + 8 + size]
        if size < raw:
            summed = bytes(itertools.accumulate(zlib.decompress(packed), lambda a, b: (a + b - 128) & 255))
            half, packed = (raw + 1) // 2, bytearray(raw)
            packed[0::2], packed[1::2] = summed[:half], summed[half:]
        for line in range(lines):
            for c, name in enumerate(names):
                first = 4 * width * (4 * line + c)
                channels[name].frombytes(bytes(packed[first:first + 4 * width]))
    return width, height, [channels[name] for name in (b"R", b"G", b"B")]


def channel_entries(data):
    """Names and what follows of each channel of the attribute."""
    while data[0]:
        end = data.index(0) + 17
        yield data[:end]
        data = data[end:]
