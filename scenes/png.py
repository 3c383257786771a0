"""Writes a PNG of at most 16 colours, stored without compression, so that every zlib gives the same bytes."""

import struct
import zlib


def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def png(width, height, palette, pixel, alpha=()):
    """`palette`: up to 16 colours of three bytes. `pixel(x, y)`: index into it. `width` is even. `alpha`: a byte for
    the first colours; the others are opaque."""
    rows = bytearray()
    for y in range(height):
        rows.append(0)  # no filter
        rows += bytes(pixel(x, y) << 4 | pixel(x + 1, y) for x in range(0, width, 2))
    stream = bytearray(b"\x78\x01")
    for start in range(0, len(rows), 65535):
        block = rows[start:start + 65535]
        stream += struct.pack("<BHH", start + len(block) == len(rows), len(block), len(block) ^ 0xFFFF) + block
    stream += struct.pack(">I", zlib.adler32(bytes(rows)))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 4, 3, 0, 0, 0))
            + chunk(b"PLTE", b"".join(bytes(c) for c in palette))
            + (chunk(b"tRNS", bytes(alpha)) if alpha else b"") + chunk(b"IDAT", bytes(stream)) + chunk(b"IEND", b""))
