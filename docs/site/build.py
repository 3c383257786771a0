#!/usr/bin/env python3
"""The documentation site, as pages that open from a disk:

    ./run site [FOLDER]
    docs/site/build.py --program build/host/wavepath [--out build/site] [--strict]

Copies the documents into a temporary folder, adds the pages that are made of something else (commands of --help,
C++ of the headers, gallery of its table), and runs Sphinx on it. --strict makes warnings errors."""

import argparse
import importlib.util
import pathlib
import shutil
import subprocess
import sys
import tempfile

import command_pages
import cpp_pages
import pages

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent


def missing(program):
    """What is not there, and where it comes from."""
    if not program.is_file():
        return f"{program} does not exist; build it, or name another one by --program"
    packages = {"python3-sphinx": "sphinx", "python3-myst-parser": "myst_parser", "furo": "furo"}
    absent = [package for package, module in packages.items() if importlib.util.find_spec(module) is None]
    absent += [] if shutil.which("dot") else ["graphviz"]
    return f"needs {', '.join(absent)}; install what is missing" if absent else ""


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=ROOT / "build" / "host" / "wavepath", type=pathlib.Path)
    parser.add_argument("--out", default=ROOT / "build" / "site", type=pathlib.Path)
    parser.add_argument("--strict", action="store_true")
    args = parser.parse_args()
    out = args.out.resolve()
    if problem := missing(args.program):
        sys.exit(f"wavepath: error: site: {problem}")
    with tempfile.TemporaryDirectory() as work:
        stage = pages.Stage(ROOT, pathlib.Path(work) / "pages")
        pages.write(stage)
        command_pages.write(stage, args.program.resolve())
        cpp_pages.write(stage)
        strict = ["-W", "--keep-going"] if args.strict else []
        command = [sys.executable, "-B", "-m", "sphinx", "-b", "html", "-n", "-q", *strict, "-c", HERE,
                   "-d", pathlib.Path(work) / "notes", stage.folder, out]
        done = subprocess.run(command, check=False)
    if done.returncode == 0:
        print(out / "index.html")
    return done.returncode


if __name__ == "__main__":
    sys.exit(main())
