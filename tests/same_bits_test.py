#!/usr/bin/env python3
"""That benchmarks/same_bits.py sees every bit of a picture: on a file of OpenEXR's, and on files written here. No
renderer is run. Usage: same_bits_test.py SOURCE_DIR"""

import base64
import pathlib
import struct
import subprocess
import sys
import tempfile
import unittest
import zlib

SCRIPT = pathlib.Path(sys.argv[1]) / "benchmarks/same_bits.py"
sys.path.insert(0, str(SCRIPT.parent))

import same_bits  # noqa: E402

NONE, ZIPS, ZIP = 0, 2, 3
UINT, HALF, FLOAT = range(3)
FORMATS = {UINT: "I", HALF: "H", FLOAT: "I"}  # words, so that tests choose bits
FLOAT_ONE, HALF_ONE = 0x3F800000, 0x3C00
WIDTH, HEIGHT = 5, 37  # two whole blocks of ZIP and a part
CHANNELS = {"R": FLOAT, "Z": HALF, "film.00": UINT}

# Written by OpenEXR 3.1: 5x17 pixels in ZIP, with n = x + 8 y in channels f (float, n), h (half, -n) and u (uint,
# 4,000,000,000 + n). The block of the last line did not shrink and is stored as it is.
OPENEXR_FILE = """
    di8xAQIAAABjaGFubmVscwBjaGxpc3QANwAAAGYAAgAAAAAAAAABAAAAAQAAAGgAAQAAAAAAAAABAAAAAQAAAHUAAAAAAAAAAAABAAAAAQAAAABjb21w
    cmVzc2lvbgBjb21wcmVzc2lvbgABAAAAA2RhdGFXaW5kb3cAYm94MmkAEAAAAAAAAAAAAAAABAAAABAAAABkaXNwbGF5V2luZG93AGJveDJpABAAAAAA
    AAAAAAAAAAQAAAAQAAAAbGluZU9yZGVyAGxpbmVPcmRlcgABAAAAAHBpeGVsQXNwZWN0UmF0aW8AZmxvYXQABAAAAAAAgD9zY3JlZW5XaW5kb3dDZW50
    ZXIAdjJmAAgAAAAAAAAAAAAAAHNjcmVlbldpbmRvd1dpZHRoAGZsb2F0AAQAAAAAAIA/AEkBAAAAAAAANAMAAAAAAAAAAAAA4wEAAHheY2hoYGBoaDjg
    ACKB4LXYK/GXEi8kn4s2NEwoWJCwIQAkxcDQ8VjukfxDhQeK90UZGDh+CHyQeKHw4AAQTLitdkv9psYNzeuiDgc8dgRsiFiRsAAkMeOy3iX9iwYXDM8D
    jWqp6ajoKQEaCAQKp81OmZ+0OGF5XHRBwpKYFRFrQjYEgCQ0Dtsdsj/ocMBxv+gBhyM2JyzOmFwwAEkY7Hbb5b7TY4fndtEHCk9kXki8EfkgAJKw2Oy3
    yX9jwIbA9UBXMf1j+cP2i+PHBCBoWB22KnxlxIrI5aICH4TeibwReyWRAZLgWBy3KH5hwoLE+aIKD5TuqdxRu6VxAyQxYXbarPSZGTMyp4saXDA6Z3LG
    7JSFB0hcYnLepPyJBRMK+4EedNrnssdtl8cOkMSC7rKu8s6Kjsp20YANQetC1oStitAASWg01zXVNzY0NNaLJixImpcyJ21WxgyQxIbqtqr2yo6KznLR
    gglFfSU9ZV0VHCAJi+K+ov7CCQUT84Fhtd/xgAMI2rQ0NT1x2wWFkw7aQyF7Q2ND4z0sEtzA+Gu8jUWCFyRxEyFxyA4K+UBRfgOLBD9I4joWCQGQxDUs
    EoIgiatYJIRAEldIkRAGSVwmRUIEJHGJFAlRkMRFwhIAQ7WHfhAAAAAtAAAAeF5jaGhorG+qa65tqekAggfZ07KmZ87ImJkuetgWCkUbgOCC2y4oBABq
    wBhv
"""


def picture():
    """Words by channel and pixel."""
    return {"R": [FLOAT_ONE + i for i in range(WIDTH * HEIGHT)], "Z": [HALF_ONE + i for i in range(WIDTH * HEIGHT)],
            "film.00": [2654435761 * i % 2**32 for i in range(WIDTH * HEIGHT)]}


def compress(data):
    ordered = data[0::2] + data[1::2]
    deltas = bytes([ordered[0]]) + bytes((b - a + 128) % 256 for a, b in zip(ordered, ordered[1:]))
    packed = zlib.compress(deltas)
    return packed if len(packed) < len(data) else data


def attribute(name, kind, value):
    return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<I", len(value)) + value


def write(path, words, channels=None, compression=ZIP, comment=""):
    channels = channels or CHANNELS
    entries = b"".join(n.encode() + b"\0" + struct.pack("<4I", kind, 0, 1, 1) for n, kind in sorted(channels.items()))
    header = struct.pack("<II", 20000630, 2) + attribute("channels", "chlist", entries + b"\0")
    header += attribute("compression", "compression", bytes([compression])) + attribute("comment", "string",
                                                                                        comment.encode())
    header += attribute("dataWindow", "box2i", struct.pack("<4i", 0, 0, WIDTH - 1, HEIGHT - 1)) + b"\0"
    lines = same_bits.BLOCK_LINES[compression]
    blocks = []
    for top in range(0, HEIGHT, lines):
        data = b"".join(struct.pack(f"<{WIDTH}{FORMATS[kind]}", *words[n][y * WIDTH:(y + 1) * WIDTH])
                        for y in range(top, min(top + lines, HEIGHT)) for n, kind in sorted(channels.items()))
        packed = compress(data) if compression else data
        blocks.append(struct.pack("<iI", top, len(packed)) + packed)
    at, table = len(header) + 8 * len(blocks), b""
    for block in blocks:
        table += struct.pack("<Q", at)
        at += len(block)
    path.write_bytes(header + table + b"".join(blocks))


class SameBits(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.a, self.b = self.folder / "a.exr", self.folder / "b.exr"

    def compare(self, change, at, **other):
        """Writes a picture, and it again with one word changed."""
        words = picture()
        write(self.a, words, **other)
        for channel, word in change.items():
            words[channel][at] = word
        write(self.b, words, **other)
        return same_bits.compare(self.a, self.b)

    def test_reads_what_openexr_wrote(self):
        self.a.write_bytes(base64.b64decode(OPENEXR_FILE))
        exr = same_bits.Exr(self.a)
        self.assertEqual((exr.size, exr.channels), ((5, 17), [("f", FLOAT), ("h", HALF), ("u", UINT)]))
        n = [[x + 8 * y for x in range(5)] for y in range(17)]
        self.assertEqual(exr.pixels(), b"".join(
            struct.pack("<5f5e5I", *r, *(-v for v in r), *(4000000000 + v for v in r)) for r in n))

    def test_equal_pictures_are_equal_whatever_else_the_files_say(self):
        write(self.a, picture(), comment="a")
        for compression in (ZIP, ZIPS, NONE):
            write(self.b, picture(), comment="another", compression=compression)
            self.assertEqual(same_bits.compare(self.a, self.b), [])

    def test_names_channel_count_and_first_pixel(self):
        for compression in (ZIP, ZIPS, NONE):
            lines = self.compare({"R": FLOAT_ONE}, 7 + WIDTH * 30, compression=compression)
            self.assertEqual(len(lines), 1)
            self.assertRegex(lines[0], r"^R: 1 of 185 values differ, first at 2,31: .*\(0x3f80009d\) became 1 "
                                       r"\(0x3f800000\)$")
        lines = self.compare({"Z": 0, "film.00": 1}, 0)
        self.assertRegex(lines[0], "^Z: 1 of 185 values differ, first at 0,0: 1 ")
        self.assertRegex(lines[1], "^film.00: 1 of 185 values differ, first at 0,0: 0x00000000 became 0x00000001$")

    def test_counts_all_values(self):
        words = picture()
        write(self.a, words)
        words["R"] = [w ^ 1 for w in words["R"]]
        write(self.b, words)
        self.assertRegex(same_bits.compare(self.a, self.b)[0], "^R: 185 of 185 values differ, first at 0,0")

    def test_bits_count_not_values(self):
        for old, new in ((0x00000000, 0x80000000), (0x7FC00000, 0x7FC00001), (0x7FC00000, 0xFFC00000), (1, 2)):
            words = picture()
            words["R"][100] = old
            write(self.a, words)
            self.assertEqual(same_bits.compare(self.a, self.a), [])
            words["R"][100] = new
            write(self.b, words)
            self.assertIn("R: 1 of 185 values differ, first at 0,20", same_bits.compare(self.a, self.b)[0])

    def test_channels_must_be_the_same(self):
        write(self.a, picture())
        write(self.b, picture(), channels={"R": FLOAT, "Z": FLOAT})
        self.assertEqual(same_bits.compare(self.a, self.b), ["channels: -Z (half) -film.00 (uint) +Z (float)"])

    def test_folders_must_have_the_same_files(self):
        for name in "old", "new", "empty":
            (self.folder / name).mkdir()
        old, new = self.folder / "old", self.folder / "new"
        write(old / "a.exr", picture())
        self.assertEqual(len(same_bits.compare(old, new)), 1)
        self.assertEqual(len(same_bits.compare(new, self.folder / "empty")), 1)
        write(new / "a.exr", picture())
        self.assertEqual(same_bits.compare(old, new), [])
        (old / "1.txt").write_text("one\ntwo\n")
        (new / "1.txt").write_text("one\nthree\n")
        self.assertEqual(same_bits.compare(old, new), ["1.txt line 2: two became three"])

    def test_exit_code_and_broken_files(self):
        def run(a, b):
            return subprocess.run([sys.executable, SCRIPT, "--name", "case", a, b], capture_output=True, text=True)

        write(self.a, picture())
        self.assertEqual((run(self.a, self.a).returncode, run(self.a, self.a).stdout), (0, ""))
        self.b.write_bytes(self.a.read_bytes()[:-20])
        for b in self.b, self.folder / "missing.exr":
            result = run(self.a, b)
            self.assertEqual(result.returncode, 1, result)
            self.assertEqual(len(result.stdout.splitlines()), 1)
            self.assertTrue(result.stdout.startswith("case: "))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
