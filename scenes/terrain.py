#!/usr/bin/env python3
"""Writes a hilly terrain of about N triangles as one .glb, to try scenes of any size: terrain.py N FILE.glb

Standard library only; 10 million triangles make a file of 180 MB. Too large to commit, so it is made when needed.
"""

import array
import json
import math
import struct
import sys


def write_terrain(triangles, path):
    side = max(1, round(math.sqrt(triangles / 2)))  # quads along one side
    row = side + 1
    step = 100.0 / side
    # Hills as a sum of waves along x, z and both diagonals: cheap, because each wave is a table of one dimension.
    waves = [(2.0, 3.0), (0.7, 11.0), (0.2, 41.0), (0.02, 397.0)]  # metres, per 100 metres

    def table(phase):
        return [sum(a * math.sin(2 * math.pi * f * i / side + phase * f) for a, f in waves) for i in range(2 * row)]

    along_x, along_z, along_sum = table(0.1), table(0.7), table(1.3)
    positions = array.array("f")
    lowest, highest = math.inf, -math.inf
    for j in range(row):
        z = j * step - 50.0
        for i in range(row):
            y = along_x[i] + along_z[j] + along_sum[i + j]
            positions.extend((i * step - 50.0, y, z))
            lowest, highest = min(lowest, y), max(highest, y)
    indices = array.array("I")
    for j in range(side):
        for i in range(side):
            a = j * row + i
            indices.extend((a, a + row, a + 1, a + 1, a + row, a + row + 1))

    position_bytes, index_bytes = len(positions) * 4, len(indices) * 4
    document = {
        "asset": {"version": "2.0", "generator": "wavepath scenes/terrain.py"},
        "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
        "materials": [{"pbrMetallicRoughness": {"baseColorFactor": [0.4, 0.45, 0.3, 1], "metallicFactor": 0}}],
        "buffers": [{"byteLength": position_bytes + index_bytes}],
        "bufferViews": [{"buffer": 0, "byteLength": position_bytes},
                        {"buffer": 0, "byteOffset": position_bytes, "byteLength": index_bytes}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": row * row, "type": "VEC3",
                       "min": [-50.0, lowest, -50.0], "max": [50.0, highest, 50.0]},
                      {"bufferView": 1, "componentType": 5125, "count": len(indices), "type": "SCALAR"}],
    }
    text = json.dumps(document, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    if sys.byteorder == "big":
        positions.byteswap()
        indices.byteswap()
    with open(path, "wb") as file:
        total = 12 + 8 + len(text) + 8 + position_bytes + index_bytes
        file.write(struct.pack("<III", 0x46546C67, 2, total))
        file.write(struct.pack("<II", len(text), 0x4E4F534A) + text)
        file.write(struct.pack("<II", position_bytes + index_bytes, 0x004E4942))
        positions.tofile(file)
        indices.tofile(file)
    return 2 * side * side


if __name__ == "__main__":
    if len(sys.argv) != 3 or not sys.argv[1].isdigit() or int(sys.argv[1]) < 2:
        sys.exit("usage: terrain.py TRIANGLES FILE.glb")
    print(f"{sys.argv[2]}: {write_terrain(int(sys.argv[1]), sys.argv[2])} triangles")
