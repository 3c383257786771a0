#!/usr/bin/env python3
"""Scenes that are made on demand: the same bytes each time, with what was asked for in them, and wavepath reads them;
and every answer of a caustic scene has its scene. Usage: scene_makers_test.py SOURCE_DIR WAVEPATH_BINARY"""

import json
import math
import pathlib
import struct
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(sys.argv[1])
WAVEPATH = sys.argv[2]
SCENES = ROOT / "scenes"
SPONZA = ROOT.parent / "shared/scenes/Sponza/Sponza.gltf"
ROOM = ROOT.parent / "shared/scenes/HotelRoom/HotelRoom-plain.glb"
sys.path.insert(0, str(SCENES))

import rooms  # noqa: E402


def make(folder, script, *arguments):
    command = [sys.executable, "-B", SCENES / script, *map(str, arguments)]
    subprocess.run(command, check=True, cwd=folder, capture_output=True)


def read_glb(data):
    """The document, and a function that reads an accessor of floats or indices."""
    length = struct.unpack("<I", data[12:16])[0]
    document = json.loads(data[20:20 + length])
    body = data[28 + length:]

    def read(index):
        accessor = document["accessors"][index]
        kind = {5126: "f", 5123: "H", 5125: "I"}[accessor["componentType"]]
        width = {"SCALAR": 1, "VEC3": 3}[accessor["type"]]
        first = document["bufferViews"][accessor["bufferView"]]["byteOffset"]
        values = struct.unpack_from(f"<{accessor['count'] * width}{kind}", body, first)
        return list(zip(*[iter(values)] * width)) if width > 1 else list(values)

    return document, read


def area(a, b, c):
    u, v = [y - x for x, y in zip(a, b)], [y - x for x, y in zip(a, c)]
    return math.hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]) / 2


def flux(document, read):
    """In the channel in which each light is brightest."""
    total = 0.0
    for mesh in document["meshes"]:
        primitive = mesh["primitives"][0]
        material = document["materials"][primitive["material"]]
        radiance = max(material.get("emissiveFactor", [0]))
        radiance *= material.get("extensions", {}).get("KHR_materials_emissive_strength", {}).get("emissiveStrength", 1)
        if radiance:
            p, i = read(primitive["attributes"]["POSITION"]), read(primitive["indices"])
            total += math.pi * radiance * sum(area(*(p[v] for v in i[k:k + 3])) for k in range(0, len(i), 3))
    for light in document.get("extensions", {}).get("KHR_lights_punctual", {"lights": []})["lights"]:
        cone = 1 - math.cos(light["spot"]["outerConeAngle"]) if light["type"] == "spot" else 2
        total += 2 * math.pi * cone * light["intensity"]
    return total


class SceneMakers(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def info(self, path):
        result = subprocess.run([WAVEPATH, "info", path, "--json"], capture_output=True, text=True)
        self.assertEqual(result.returncode, 0, result.stderr)
        return json.loads(result.stdout)

    def house(self, name, *flags):
        make(self.folder, "many_lights.py", name, *flags)
        return (self.folder / name).read_bytes()

    def test_the_same_numbers_give_the_same_house(self):
        first = self.house("a.glb", "--count", 500, "--seed", 7)
        self.assertEqual(first, self.house("b.glb", "--count", 500, "--seed", 7))
        self.assertNotEqual(first, self.house("c.glb", "--count", 500, "--seed", 8))

    def test_a_house_has_the_lights_that_were_asked_for(self):
        for count, punctual, side in ((300, 0.2, 2), (1000, 0.0, 3)):
            with self.subTest(count=count):
                house = self.house("h.glb", "--count", count, "--punctual", punctual, "--rooms", side)
                document, read = read_glb(house)
                lights = document.get("extensions", {}).get("KHR_lights_punctual", {"lights": []})["lights"]
                self.assertEqual(len(lights), round(count * punctual))
                info = self.info(self.folder / "h.glb")
                self.assertEqual(info["lights"]["punctual"], len(lights))
                bodies = count - len(lights)  # of four triangles, or two where it is a panel
                self.assertTrue(2 * bodies < info["lights"]["emissive_triangles"] < 4 * bodies)
                wanted = rooms.FLUX_PER_ROOM * side * side / (1 - rooms.OUTSIDE)
                self.assertAlmostEqual(flux(document, read), wanted, delta=0.05)

    def test_scenes_that_are_hard_for_shadow_techniques(self):
        for name, lamps, punctual in (("sphere_lamp", 224, 0), ("tree", 0, 1), ("rails", 0, 1)):
            with self.subTest(scene=name):
                for copy in "ab":
                    make(self.folder, "shadow_scenes.py", name, f"{copy}.glb")
                self.assertEqual((self.folder / "a.glb").read_bytes(), (self.folder / "b.glb").read_bytes())
                lights = self.info(self.folder / "a.glb")["lights"]
                self.assertEqual((lights["emissive_triangles"], lights["punctual"]), (lamps, punctual))
                document, _ = read_glb((self.folder / "a.glb").read_bytes())
                self.assertEqual(any(m.get("alphaMode") == "MASK" for m in document["materials"]), name == "tree")

    def test_a_room_has_mirrors(self):
        for copy in "ab":
            make(self.folder, "mirrors.py", f"{copy}.glb")
        self.assertEqual((self.folder / "a.glb").read_bytes(), (self.folder / "b.glb").read_bytes())
        document, _ = read_glb((self.folder / "a.glb").read_bytes())
        self.assertEqual(sum(m["pbrMetallicRoughness"]["metallicFactor"] for m in document["materials"]), 1)
        make(self.folder, "mirrors.py", "facing", "f.glb")
        document, _ = read_glb((self.folder / "f.glb").read_bytes())
        mirror = [m["name"] for m in document["materials"]].index("mirror")
        mirrors = [p for m in document["meshes"] for p in m["primitives"] if p["material"] == mirror]
        self.assertEqual(len(mirrors), 3)

    def test_things_move_in_a_room(self):
        for copy in "ab":
            make(self.folder, "moving.py", f"{copy}.glb")
        self.assertEqual((self.folder / "a.glb").read_bytes(), (self.folder / "b.glb").read_bytes())
        document, _ = read_glb((self.folder / "a.glb").read_bytes())
        (animation,) = document["animations"]
        moved = {document["nodes"][c["target"]["node"]]["name"] for c in animation["channels"]}
        self.assertEqual((animation["name"], moved), ("move", {"crate", "ball", "bar"}))
        self.info(self.folder / "a.glb")

    def test_a_room_gets_a_spot(self):
        if not ROOM.exists():
            self.skipTest("no shared/scenes beside the repository")
        make(self.folder, "shadow_scenes.py", "room_spot", ROOM, "r.glb")
        info = self.info(self.folder / "r.glb")
        self.assertEqual(info["lights"]["punctual"], 1)
        self.assertGreater(info["triangles"], 90000)

    def test_every_scene_can_be_read(self):
        paths = sorted(p for kind in ("rooms", "caustics") for p in (SCENES / kind).glob("*.glb"))
        self.assertGreater(len(paths), 15)
        for path in paths:
            with self.subTest(path=path.name):
                lights = self.info(path)["lights"]
                self.assertGreater(lights["punctual"] + lights["emissive_triangles"], 0)

    def test_every_answer_has_its_scene(self):
        answers = json.loads((SCENES / "caustics/expected.json").read_text())
        self.assertGreaterEqual(len(answers), 10)
        for name, answer in answers.items():
            with self.subTest(scene=name):
                self.assertTrue((SCENES / f"caustics/{name}.glb").exists())
                self.assertIn(answer["seen"], ("straight", "diffuse", "specular"))
                self.assertTrue(all(v > 0 for v in answer["expected"]))

    def test_sponza_becomes_grey_and_gets_a_lamp(self):
        if not SPONZA.exists():
            self.skipTest("no shared/scenes beside the repository")
        make(self.folder, "sponza_lamp.py", SPONZA, "s.glb")
        info = self.info(self.folder / "s.glb")
        self.assertEqual(info["lights"]["emissive_triangles"], 2)
        document, _ = read_glb((self.folder / "s.glb").read_bytes())
        self.assertEqual(len(document["materials"]), 2)
        self.assertNotIn("images", document)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
