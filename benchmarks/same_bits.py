#!/usr/bin/env python3
"""Compares pictures bit by bit: every channel of two EXR files, or every file of two folders. Attributes of EXR files
do not count; size and channels do. Files of other kinds must have the same bytes. Each difference is a line; the exit
code says whether there was one.

Usage: same_bits.py [--name NAME] OTHER THIS

This is a reader of its own, so that it compares what lies in the file: libraries convert half and uint to float, and
may change the payload of a NaN."""

import argparse
import itertools
import pathlib
import struct
import sys
import zlib

SAMPLE_BYTES = {0: 4, 1: 2, 2: 4}  # pixel types: uint, half, float
TYPE_NAMES = {0: "uint", 1: "half", 2: "float"}
BLOCK_LINES = {0: 1, 2: 1, 3: 16}  # compressions: none, ZIPS, ZIP
FILES_THAT_COUNT = ("*.exr", "*.txt")


def text(data, at):
    end = data.index(0, at)
    return data[at:end].decode(), end + 1


class Exr:
    """The channels of a file with a single part of scan lines, in the file's order (by name), and its blocks by
    line."""

    def __init__(self, path):
        self.data = pathlib.Path(path).read_bytes()
        magic, version = struct.unpack_from("<II", self.data)
        if magic != 20000630 or version & 0x1A00:  # tiles, deep data, several parts
            raise ValueError(f"{path}: not an EXR file of scan lines")
        attributes, at = {}, 8
        while self.data[at]:
            name, at = text(self.data, at)
            _, at = text(self.data, at)
            (size,) = struct.unpack_from("<I", self.data, at)
            attributes[name] = self.data[at + 4:at + 4 + size]
            at += 4 + size
        self.compression = attributes["compression"][0]
        if self.compression not in BLOCK_LINES:
            raise ValueError(f"{path}: compression {self.compression} is not ZIP, ZIPS or none")
        left, self.top, right, bottom = struct.unpack("<4i", attributes["dataWindow"])
        self.size = right - left + 1, bottom - self.top + 1
        self.channels = self.read_channels(path, attributes["channels"])
        self.line_bytes = self.size[0] * sum(SAMPLE_BYTES[kind] for _, kind in self.channels)
        self.blocks = self.find_blocks(path, at + 1)

    @staticmethod
    def read_channels(path, data):
        channels, at = [], 0
        while data[at]:
            name, at = text(data, at)
            kind, _, x_sampling, y_sampling = struct.unpack_from("<4I", data, at)
            if (x_sampling, y_sampling) != (1, 1):
                raise ValueError(f"{path}: channel {name} is subsampled")
            channels.append((name, kind))
            at += 16
        return channels

    def find_blocks(self, path, table):
        lines = BLOCK_LINES[self.compression]
        blocks = {}
        for offset in struct.unpack_from(f"<{-(-self.size[1] // lines)}Q", self.data, table):
            y, size = struct.unpack_from("<iI", self.data, offset)
            blocks[y - self.top] = self.data[offset + 8:offset + 8 + size]
        if sorted(blocks) != list(range(0, self.size[1], lines)):
            raise ValueError(f"{path}: blocks of lines are missing")
        return blocks

    def pixels(self):
        """The bytes of all lines from the top; in a line, channel by channel."""
        return b"".join(self.unpack(self.blocks[y], y) for y in sorted(self.blocks))

    def unpack(self, block, y):
        size = min(BLOCK_LINES[self.compression], self.size[1] - y) * self.line_bytes
        if self.compression and len(block) < size:  # a block that does not shrink is stored as it is
            # Every byte is stored as its difference to the one before, plus 128. The bytes at even places come first,
            # then those at odd places.
            deltas = zlib.decompress(block)
            values = bytes(v & 255 for v in itertools.accumulate(deltas, lambda a, b: a + b - 128))
            half = (len(values) + 1) // 2
            block = bytearray(len(values))
            block[0::2], block[1::2] = values[:half], values[half:]
        if len(block) != size:
            raise ValueError(f"the block of line {y} holds {len(block)} bytes instead of {size}")
        return block


def show(kind, value):
    bits = f"0x{int.from_bytes(value, 'little'):0{2 * len(value)}x}"
    return bits if kind == 0 else f"{struct.unpack('<e' if kind == 1 else '<f', value)[0]:g} ({bits})"


def compare_exr(other, this):
    """Lines, one for each channel that differs."""
    other, this = Exr(other), Exr(this)
    if other.size != this.size:
        return ["size: {}x{} became {}x{}".format(*other.size, *this.size)]
    if other.channels != this.channels:
        gone, new = (sorted(set(a) - set(b)) for a, b in ((other.channels, this.channels),
                                                          (this.channels, other.channels)))
        told = [f"{sign}{name} ({TYPE_NAMES[kind]})" for sign, some in (("-", gone), ("+", new)) for name, kind in some]
        return ["channels: " + " ".join(told)]
    if (other.compression, other.blocks) == (this.compression, this.blocks):
        return []
    return compare_pixels(other.pixels(), this.pixels(), other.size, other.channels)


def compare_pixels(a, b, size, channels):
    counts, first = dict.fromkeys(channels, 0), {}
    at = 0
    for y in range(size[1]):
        for channel in channels:
            step = SAMPLE_BYTES[channel[1]]
            end = at + size[0] * step
            if a[at:end] != b[at:end]:
                places = [i for i in range(at, end, step) if a[i:i + step] != b[i:i + step]]
                counts[channel] += len(places)
                i = places[0]
                first.setdefault(channel, ((i - at) // step, y, *(show(channel[1], v[i:i + step]) for v in (a, b))))
            at = end
    return ["{}: {} of {} values differ, first at {},{}: {} became {}".format(
        channel[0], counts[channel], size[0] * size[1], *first[channel]) for channel in channels if counts[channel]]


def compare_bytes(other, this):
    a, b = pathlib.Path(other).read_bytes(), pathlib.Path(this).read_bytes()
    if a == b:
        return []
    for i, (line_a, line_b) in enumerate(itertools.zip_longest(a.splitlines(), b.splitlines(), fillvalue=b"nothing"),
                                         1):
        if line_a != line_b:
            return [f"line {i}: {line_a.decode(errors='replace').strip()} became "
                    f"{line_b.decode(errors='replace').strip()}"]
    return ["ends of lines differ"]


def compare(other, this):
    """Lines, none if the two files or folders are equal."""
    other, this = pathlib.Path(other), pathlib.Path(this)
    if not other.is_dir():
        return (compare_exr if other.suffix == ".exr" else compare_bytes)(other, this)
    names = [sorted({f.name for kind in FILES_THAT_COUNT for f in folder.glob(kind)}) for folder in (other, this)]
    if names[0] != names[1]:
        return ["files: {} became {}".format(*(" ".join(n) or "nothing" for n in names))]
    if not names[0]:
        return ["there is nothing to compare"]
    return [f"{name} {line}" for name in names[0] for line in compare(other / name, this / name)]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--name", help="put before every line")
    parser.add_argument("other")
    parser.add_argument("this")
    args = parser.parse_args()
    try:
        lines = compare(args.other, args.this)
    except (OSError, ValueError, KeyError, IndexError, struct.error, zlib.error) as error:
        lines = [str(error)]
    for line in lines:
        print(f"{args.name}: {line}" if args.name else line)
    return 1 if lines else 0


if __name__ == "__main__":
    sys.exit(main())
