#!/usr/bin/env python3
"""Derives grey Sponza with a lamp inside from the Crytek Sponza, as one .glb; render it with --env 1,1,1.

All surfaces become Lambert's, of the same grey and without a texture, so that nothing but light transport is measured:
the sky through the roof, and one quad that shines down on the hall.
"""

import json
import pathlib
import sys

from gltf import Gltf, quad

GREY = (0.6, 0.6, 0.6)
LAMP = (12.0, 12.0, 12.0)


def sponza_lamp(source):
    """`source`: Sponza.gltf, its buffer beside it."""
    document = json.loads(source.read_text())
    g = Gltf("grey Sponza with a lamp")
    g.data = bytearray((source.parent / document["buffers"][0]["uri"]).read_bytes())
    for key in ("scene", "scenes", "nodes", "meshes", "accessors", "bufferViews"):
        g.doc[key] = document[key]
    g.doc["asset"]["copyright"] = document["asset"].get("copyright", "")
    grey = g.lambert("grey", GREY, doubleSided=True)
    for mesh in g.doc["meshes"]:
        for primitive in mesh["primitives"]:
            primitive["material"] = grey
    x, y, z, s = -3.0, 3.2, 0.0, 0.4
    lamp = quad((x - s, y, z - s), (x + s, y, z - s), (x + s, y, z + s), (x - s, y, z + s))
    g.mesh("lamp", lamp, g.emitter("lamp", LAMP))
    g.camera((4.0, 1.8, 0.2), (-10.0, 2.2, -0.3), yfov=1.1344640)
    return g


def main():
    if len(sys.argv) != 3:
        sys.exit("usage: sponza_lamp.py SPONZA.gltf FILE.glb")
    source, target = map(pathlib.Path, sys.argv[1:])
    target.parent.mkdir(parents=True, exist_ok=True)
    target.write_bytes(sponza_lamp(source).binary())
    print(target)


if __name__ == "__main__":
    main()
