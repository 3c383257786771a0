#!/usr/bin/env python3
"""Man pages and completion that packages have: all that the program tells of its flags, and as shells and man take it.
The program whose window is a package of its own. Usage: packages_test.py SOURCE_DIR WAVEPATH WAVEPATH_WITHOUT_WINDOW"""

import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT, WAVEPATH, WITHOUT_WINDOW = pathlib.Path(sys.argv[1]), sys.argv[2], sys.argv[3]
sys.path.insert(0, str(ROOT / "docs" / "site"))
from help_text import commands_of, read  # noqa: E402


def run(*words, **options):
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True, check=False, **options)
    if done.returncode:
        raise AssertionError(f"{' '.join(map(str, words))}: {done.stdout}{done.stderr}")
    return done


def complete(script, *words):
    """What the completion of bash offers for the last word."""
    line = f"source {script}; COMP_WORDS=({' '.join(repr(word) for word in words)}); COMP_CWORD={len(words) - 1}; "
    return run("bash", "-c", line + '_wavepath; printf "%s\\n" "${COMPREPLY[@]}"').stdout.split()


class ManPages(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        cls.pages = pathlib.Path(cls.folder.name)
        run(sys.executable, "-B", ROOT / "packaging" / "man_pages.py", WAVEPATH, cls.pages)

    def test_each_command_has_a_page_with_all_its_flags(self):
        commands = [name for name, _ in commands_of(WAVEPATH)]
        self.assertGreater(len(commands), 8)
        self.assertEqual({page.stem for page in self.pages.iterdir()},
                         {"wavepath", *(f"wavepath-{command}" for command in commands)})
        for command in commands:
            text = (self.pages / f"wavepath-{command}.1").read_text().replace("\\-", "-")
            for flag in read(WAVEPATH, command).flags():
                with self.subTest(command=command, flag=flag.head):
                    for name in flag.names():
                        self.assertRegex(text, rf"\\f[BI]{re.escape(name)}\\fR")

    def test_man_reads_them_without_a_warning(self):
        if not shutil.which("groff"):
            self.skipTest("groff is missing")
        for page in sorted(self.pages.iterdir()):
            with self.subTest(page=page.name):
                done = run("groff", "-man", "-Tutf8", "-wall", "-K", "utf8", page)
                self.assertEqual(done.stderr, "")


class Completion(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        cls.files = {}
        for shell in ("bash", "zsh"):
            cls.files[shell] = pathlib.Path(cls.folder.name) / shell
            text = run(sys.executable, "-B", ROOT / "packaging" / "completion.py", WAVEPATH, shell).stdout
            cls.files[shell].write_text(text)

    def test_bash(self):
        script = self.files["bash"]
        self.assertEqual(complete(script, "wavepath", "sel"), ["selftest"])
        self.assertIn("--env-rotation", complete(script, "wavepath", "render", "--env"))
        self.assertIn("stratified", complete(script, "wavepath", "render", "--sampler", ""))
        self.assertEqual(complete(script, "wavepath", "render", "--bits", ""), ["8", "16"])
        self.assertEqual(complete(script, "wavepath", "render", "scene"), [])  # a file
        for command, _ in commands_of(WAVEPATH):
            names = {name for flag in read(WAVEPATH, command).flags() for name in flag.names() if name.startswith("-")}
            self.assertLessEqual(names, {*complete(script, "wavepath", command, "-"),
                                         *complete(script, "wavepath", command, "--")})

    def test_zsh(self):
        text = self.files["zsh"].read_text()
        for name in ("--env-rotation", "--sampler"):
            self.assertIn(name, text)
        if shutil.which("zsh"):
            run("zsh", "-n", self.files["zsh"])


class WithoutWindow(unittest.TestCase):
    def test_it_needs_no_library_of_a_window(self):
        needed = run("ldd", WITHOUT_WINDOW).stdout
        self.assertIn("libvulkan", needed)
        for library in ("libglfw", "libX11", "libimgui"):
            self.assertNotIn(library, needed)

    def test_it_has_all_commands(self):
        self.assertEqual(commands_of(WITHOUT_WINDOW), commands_of(WAVEPATH))
        self.assertIn("--listen", run(WITHOUT_WINDOW, "serve", "--help-all").stdout)

    def test_view_is_the_other_program(self):
        words = [WITHOUT_WINDOW, "view", "scene.glb", "--size", "8x8"]
        with tempfile.TemporaryDirectory() as folder:
            alone = subprocess.run(words, env={"PATH": folder}, capture_output=True, text=True, check=False)
            self.assertEqual(alone.returncode, 1)
            self.assertEqual(alone.stderr.count("\n"), 1)
            self.assertIn("install the package wavepath-view", alone.stderr)
            window = pathlib.Path(folder) / "wavepath-view"
            window.write_text("#!/bin/sh\necho window: $*\n")
            window.chmod(0o755)
            self.assertEqual(run(*words, env={"PATH": folder}).stdout, "window: view scene.glb --size 8x8\n")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
