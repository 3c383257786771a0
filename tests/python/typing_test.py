"""Types and examples of the module: stubs fit what is bound, docstrings tell the truth."""

import doctest
import importlib.util
import inspect
import os
import pathlib
import subprocess
import sys

import numpy as np
import pytest
import wavepath
from conftest import ROOT


ALLOWED = pathlib.Path(__file__).parent / "stubs_allowlist.txt"


@pytest.mark.skipif(importlib.util.find_spec("mypy") is None, reason="mypy is not installed")
@pytest.mark.parametrize("words", [["stubtest", "wavepath._core"], ["mypy", "-p", "wavepath"]], ids=["stubs", "types"])
def test_types(words, tmp_path):
    tool = ["mypy.stubtest", "--allowlist", str(ALLOWED)] if words[0] == "stubtest" else ["mypy", "--no-error-summary"]
    command = [sys.executable, "-m", *tool, *words[1:]]
    environment = {**os.environ, "MYPY_CACHE_DIR": str(tmp_path)}
    done = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path, env=environment, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


def test_is_marked_as_typed():
    assert (pathlib.Path(wavepath.__file__).parent / "py.typed").exists()


@pytest.mark.usefixtures("device")
@pytest.mark.parametrize("module", ["", "camera", "errors", "rendering", "result", "scene", "settings", "tools"])
def test_docstrings(module, monkeypatch):
    monkeypatch.chdir(ROOT)
    name = f"wavepath.{module}" if module else "wavepath"
    names = {"wavepath": wavepath, "np": np, "Camera": wavepath.Camera}
    failed, _ = doctest.testmod(sys.modules[name], extraglobs=names, optionflags=doctest.NORMALIZE_WHITESPACE)
    assert failed == 0


@pytest.mark.usefixtures("device")
def test_documents(monkeypatch, tmp_path):
    """The code blocks of docs/python.md run, one after the other."""
    text = (ROOT / "docs" / "python.md").read_text()
    blocks = [block.split("```")[0] for block in text.split("```python\n")[1:]]
    assert len(blocks) >= 3
    monkeypatch.chdir(tmp_path)
    (tmp_path / "scenes").symlink_to(ROOT / "scenes")
    names = {}
    for block in blocks:
        exec(compile(block, "docs/python.md", "exec"), names)  # noqa: S102


def test_everything_public_is_described():
    for name in wavepath.__all__:
        thing = getattr(wavepath, name)
        if inspect.isclass(thing) or inspect.isfunction(thing):
            assert thing.__doc__, name
