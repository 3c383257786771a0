#!/usr/bin/env python3
"""Pictures of docs/cameras_and_passes.md: document_pictures.py --assets FOLDER [--only NAME ...] [--program wavepath]

Renders the tiles of each of PICTURES and mounts them side by side in one PNG. FOLDER holds DamagedHelmet and
TransmissionTest of Khronos' glTF sample assets; the other scenes are of this repository."""

import argparse
import cmath
import colorsys
import math
import pathlib
import struct
import subprocess
import tempfile
import zlib

from same_bits import Exr

ROOT = pathlib.Path(__file__).resolve().parent.parent
GAP = 2  # pixels between tiles
SQUARE = 12  # pixels of a checkerboard
PIXELS = {2: 3, 6: 4}  # bytes by PNG's type of colour


def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def predicted(kind, left, up, corner):
    """PNG's filters."""
    if kind == 4:
        guess = left + up - corner
        return min((left, up, corner), key=lambda value: abs(guess - value))
    return (0, left, up, (left + up) // 2)[kind]


def read_png(path):
    """Rows of tuples of 8 bits a channel."""
    data, at, packed = path.read_bytes(), 8, b""
    while at < len(data):
        size, kind = struct.unpack_from(">I4s", data, at)
        body = data[at + 8:at + 8 + size]
        if kind == b"IHDR":
            width, height, bits, colour = struct.unpack_from(">IIBB", body)
        elif kind == b"IDAT":
            packed += body
        at += 12 + size
    assert bits == 8
    step = PIXELS[colour]
    raw, before, rows = zlib.decompress(packed), bytes(step * (width + 1)), []
    for y in range(height):
        start = y * (step * width + 1)
        row = bytearray(step)
        for i, value in enumerate(raw[start + 1:start + 1 + step * width], step):
            row.append(value + predicted(raw[start], row[i - step], before[i], before[i - step]) & 255)
        rows.append([tuple(row[i:i + step]) for i in range(step, len(row), step)])
        before = row
    return rows


def write_png(path, rows):
    """By the filter of each row that leaves the least."""
    step, before, packed = 3, bytes(3 * (len(rows[0]) + 1)), b""
    for pixels in rows:
        row = bytes(step) + b"".join(bytes(pixel) for pixel in pixels)
        tries = [bytes([kind]) + bytes(row[i] - predicted(kind, row[i - step], before[i], before[i - step]) & 255
                                       for i in range(step, len(row))) for kind in range(5)]
        packed += min(tries, key=lambda line: sum(min(value, 256 - value) for value in line[1:]))
        before = row
    header = struct.pack(">IIBBBBB", len(rows[0]), len(rows), 8, 2, 0, 0, 0)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(packed, 9))
                     + chunk(b"IEND", b""))


def grid(tiles, columns, colour=(255, 255, 255)):
    """Tiles of one size, in rows of so many, with gaps."""
    width, height = len(tiles[0][0]), len(tiles[0])
    rows = []
    for first in range(0, len(tiles), columns):
        if rows:
            rows += [[colour] * (columns * (width + GAP) - GAP)] * GAP
        for y in range(height):
            row = []
            for tile in tiles[first:first + columns]:
                row += ([colour] * GAP if row else []) + tile[y]
            rows.append(row)
    return rows


def over(picture, background):
    """A picture with alpha over background(x, y), both as they are encoded, as most programs do it."""
    return [[tuple((c * p[3] + b * (255 - p[3]) + 127) // 255 for c, b in zip(p[:3], background(x, y)))
             for x, p in enumerate(row)] for y, row in enumerate(picture)]


def checkerboard(x, y):
    return (205,) * 3 if (x // SQUARE + y // SQUARE) % 2 else (110,) * 3


def channels_of(path):
    """Values of each channel by name, row by row."""
    exr = Exr(path)
    data, found, at = exr.pixels(), {name: [] for name, _ in exr.channels}, 0
    for _ in range(exr.size[1]):
        for name, kind in exr.channels:
            code, size = {0: ("I", 4), 1: ("e", 2), 2: ("f", 4)}[kind]
            found[name].append(struct.unpack_from(f"<{exr.size[0]}{code}", data, at))
            at += size * exr.size[0]
    return found


class Renderer:
    def __init__(self, program, assets, folder):
        self.program, self.assets, self.folder, self.count = program, assets, folder, 0

    def file(self, scene, flags, extension):
        self.count += 1
        output = self.folder / f"{self.count}{extension}"
        path = self.assets / scene.removeprefix("ASSETS/") if scene.startswith("ASSETS/") else ROOT / scene
        subprocess.run([self.program, "render", path, *flags.split(), "-q", "-o", output], check=True)
        return output

    def png(self, scene, flags):
        return read_png(self.file(scene, flags, ".png"))

    def channels(self, scene, flags):
        return channels_of(self.file(scene, flags + " --compression zip", ".exr"))


HELMET = "ASSETS/DamagedHelmet/glTF-Binary/DamagedHelmet.glb"
SHOWCASE = "scenes/showcase.glb"


def soft_lamps(renderer):
    flags = "--sun 15,45 --ground --env 0.15,0.19,0.25 --size 240x200 --spp 64 --denoise --exposure -0.7 --sun-angle "
    return grid([renderer.png(HELMET, flags + degrees) for degrees in ("0", "3", "15")], 3)


def crop(renderer):
    """A rectangle within its display window, the tiles of a farm, and what is merged of them."""
    width, height = 256, 144
    flags = f"--size {width}x{height} --spp 64 --exposure 0 --crop "
    dark = (48, 48, 48)

    def place(canvas, left, top, picture):
        for y, row in enumerate(picture):
            canvas[top + y][left:left + len(row)] = [pixel[:3] for pixel in row]

    alone, tiles, whole = ([[dark] * (width + 8) for _ in range(height + 8)] for _ in range(3))
    place(alone, 4 + 96, 4 + 8, renderer.png(SHOWCASE, flags + "96,8,96,80"))
    for left in (0, width // 2):
        for top in (0, height // 2):
            tile = renderer.png(SHOWCASE, flags + f"{left},{top},{width // 2},{height // 2}")
            place(tiles, left + (8 if left else 0), top + (8 if top else 0), tile)
            place(whole, left + 4, top + 4, tile)
    return grid([alone, tiles, whole], 3)


def transparent(renderer):
    glass = renderer.png("ASSETS/TransmissionTest/glTF-Binary/TransmissionTest.glb",
                         "--transparent --integrator path --size 256x192 --spp 64")
    return over(glass, checkerboard)


def byte(value):
    return round(255 * min(max(value, 0.0), 1.0))


def encoded(value):
    """sRGB."""
    return byte(12.92 * value if value <= 0.0031308 else 1.055 * value ** (1 / 2.4) - 0.055)


def colour_of(number):
    """A colour for an id; none for nothing."""
    if number in (-1, 0.0):
        return (0.2, 0.2, 0.2)
    mixed = zlib.crc32(struct.pack("<f", number))
    return colorsys.hsv_to_rgb((mixed & 1023) / 1024, 0.45 + (mixed >> 10 & 63) / 160, 0.55 + (mixed >> 16 & 63) / 150)


def passes(renderer):
    flags = "--size 240x135 --spp 16 --aov node,material,normal0,uv,cryptomatte,motion,albedo"
    # The camera of the file is at 0,2.35,7.4 and looks at 0,0.86,0.
    found = renderer.channels(SHOWCASE, flags + " --camera-to 0.2,2.35,7.4,0,0.86,0")
    through = renderer.channels(SHOWCASE, "--size 240x135 --spp 16 --aov albedo --aov-through --integrator path")

    def tile(values, names, shown):
        return [[tuple(shown(*pixel)) for pixel in zip(*(values[name][y] for name in names))]
                for y in range(len(values["R"]))]

    def of_ids(*pairs):
        colour = [0.0] * 3
        for number, coverage in zip(pairs[::2], pairs[1::2]):
            colour = [c + coverage * part for c, part in zip(colour, colour_of(number))]
        return map(byte, colour)

    def of_motion(x, y):
        way = complex(x, y)
        return map(byte, colorsys.hsv_to_rgb(cmath.phase(way) / math.tau % 1.0, min(abs(way) / 12, 1.0), 1.0))

    letters = [f"CryptoObject{level:02}.{letter}" for level in range(3) for letter in "RGBA"]
    return grid([
        tile(found, ["id.node"], lambda n: map(byte, colour_of(float(n)))),
        tile(found, ["id.material"], lambda n: map(byte, colour_of(float(n)))),
        tile(found, ["N0.X", "N0.Y", "N0.Z"], lambda *n: (byte(0.5 + 0.5 * c) for c in n)),
        tile(found, ["uv.X", "uv.Y"], lambda u, v: (byte(u % 1.0), byte(v % 1.0), 0)),
        tile(found, letters, of_ids),
        tile(found, ["motion.X", "motion.Y"], of_motion),
        tile(found, ["albedo.R", "albedo.G", "albedo.B"], lambda *c: map(encoded, c)),
        tile(through, ["albedo.R", "albedo.G", "albedo.B"], lambda *c: map(encoded, c))], 4)


PICTURES = {"docs/cameras/soft_lamps.png": soft_lamps, "docs/cameras/crop.png": crop,
            "docs/cameras/transparent.png": transparent, "benchmarks/results/gallery/passes.png": passes}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--assets", required=True, type=pathlib.Path)
    parser.add_argument("--only", nargs="*", choices=[pathlib.Path(name).stem for name in PICTURES])
    parser.add_argument("--program", default=str(ROOT / "build" / "host" / "wavepath"))
    args = parser.parse_args()
    for name, make in PICTURES.items():
        if args.only is None or pathlib.Path(name).stem in args.only:
            with tempfile.TemporaryDirectory() as folder:
                write_png(ROOT / name, make(Renderer(args.program, args.assets.resolve(), pathlib.Path(folder))))
            print(name, (ROOT / name).stat().st_size, "bytes", flush=True)


if __name__ == "__main__":
    main()
