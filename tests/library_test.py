#!/usr/bin/env python3
"""libwavepath.so as a program sees it that is built against an installed prefix.
Usage: library_test.py SOURCE_DIR BUILD_DIR COMPILER"""

import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

ROOT, BUILD, COMPILER = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), sys.argv[3]


def run(*words, **options):
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True, check=False, **options)
    if done.returncode:
        raise AssertionError(f"{' '.join(map(str, words))}: {done.stdout}{done.stderr}")
    return done.stdout


class InstalledLibrary(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        cls.prefix = pathlib.Path(cls.folder.name) / "prefix"
        for component in ("library", "development"):
            run("cmake", "--install", BUILD, "--prefix", cls.prefix, "--component", component)
        cls.library = next(cls.prefix.rglob("libwavepath.so")).resolve()
        cls.pkgconfig = next(cls.prefix.rglob("wavepath.pc")).parent

    def test_the_example_builds_and_runs(self):
        """By find_package(wavepath); it prints its own lines alone, and its pictures are whole."""
        build = pathlib.Path(self.folder.name) / "example"
        run("cmake", "-S", ROOT / "examples", "-B", build, "-G", "Ninja", f"-DCMAKE_PREFIX_PATH={self.prefix}",
            f"-DCMAKE_CXX_COMPILER={COMPILER}")
        run("cmake", "--build", build)
        pictures = build / "pictures"
        pictures.mkdir()
        done = subprocess.run([build / "turntable", ROOT / "scenes" / "cornell_box.gltf", pictures, "3"],
                              capture_output=True, text=True, check=False)
        if "no Vulkan" in done.stderr and os.environ.get("WAVEPATH_REQUIRE_VULKAN", "0") in ("", "0"):
            self.skipTest(done.stderr)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertEqual(len(done.stdout.splitlines()), 3)
        files = sorted(pictures.iterdir())
        self.assertEqual([file.name for file in files], ["view0.png", "view1.png", "view2.png"])
        self.assertEqual(len({file.read_bytes() for file in files}), 3)
        wrong = subprocess.run([build / "turntable", "none.glb", pictures], capture_output=True, text=True, check=False)
        self.assertEqual((wrong.returncode, wrong.stderr), (1, "none.glb: does not exist; check the name\n"))

    def test_pkg_config(self):
        source = pathlib.Path(self.folder.name) / "version.cpp"
        source.write_text("#include <cstdio>\n#include <wavepath/wavepath.h>\n"
                          "int main() { std::puts(wavepath::version()); }\n")
        environment = {**os.environ, "PKG_CONFIG_PATH": str(self.pkgconfig)}
        flags = run("pkg-config", "--cflags", "--libs", "wavepath", env=environment).split()
        program = source.with_suffix("")
        run(COMPILER, "-std=c++17", "-Wall", "-Wextra", "-Wpedantic", "-Werror", source, "-o", program, *flags,
            f"-Wl,-rpath,{self.library.parent}")
        self.assertEqual(run(program).strip(), run("pkg-config", "--modversion", "wavepath", env=environment).strip())

    def test_versions_agree(self):
        header = (ROOT / "include/wavepath/version.h").read_text()
        parts = [re.search(rf"WAVEPATH_VERSION_{part} (\d+)", header).group(1) for part in ("MAJOR", "MINOR", "PATCH")]
        version = ".".join(parts)
        self.assertIn(f"project(wavepath VERSION {version} ", (ROOT / "CMakeLists.txt").read_text())
        self.assertIn(f'version = "{version}"', (ROOT / "pyproject.toml").read_text())
        self.assertTrue(self.library.name.endswith(version))
        self.assertIn(f"SONAME               libwavepath.so.{parts[0]}", run("objdump", "-p", self.library))

    def test_only_the_interface_is_exported(self):
        for line in run("nm", "-DC", "--defined-only", self.library).splitlines():
            name = line.split(maxsplit=2)[2]
            self.assertRegex(name, r"wavepath_v0::|^WAVEPATH_\d+$")

    def test_headers_name_nothing_of_the_inside(self):
        everything = (ROOT / "include/wavepath/wavepath.h").read_text()
        for header in sorted((ROOT / "include/wavepath").glob("*.h")):
            text = header.read_text()
            with self.subTest(header=header.name):
                self.assertNotRegex(text, r"glm|nlohmann|tinygltf|\bVk[A-Z]|host/|kernels/|bvh/")
                if header.name not in ("wavepath.h", "export.h"):
                    self.assertIn(f"#include <wavepath/{header.name}>", everything)

    def test_no_window_comes_along(self):
        needed = re.findall(r"NEEDED\s+(\S+)", run("objdump", "-p", self.library))
        self.assertFalse([name for name in needed if re.match(r"libglfw|libimgui|libX11|libOpenImageIO", name)])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
