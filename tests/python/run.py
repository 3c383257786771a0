"""Runs tests of the Python module by pytest, or tells what is missing and leaves with the code of a skipped test.
Usage: run.py MISSING TEST... MISSING: what the build lacked for the module; empty if it is built."""

import importlib.util
import sys

SKIPPED = 77

missing = [sys.argv[1]] if sys.argv[1] else []
missing += [f"{name} (python3-{name})" for name in ("numpy", "pytest") if importlib.util.find_spec(name) is None]
if missing:
    print(f"skipped: {', '.join(missing)} is missing for {sys.executable}")
    sys.exit(SKIPPED)

import pytest

sys.exit(pytest.main(["-q", "-p", "no:cacheprovider", "--durations=5", *sys.argv[2:]]))
