"""`pip install .` works without an index and with build isolation, and the installed module renders."""

import os
import pathlib
import subprocess
import sys

import pytest
from conftest import CORNELL, ROOT

pytestmark = [
    pytest.mark.usefixtures("device"),
    pytest.mark.skipif("WAVEPATH_PIP_BUILD" not in os.environ, reason="WAVEPATH_PIP_BUILD names no build folder"),
]
RENDER = f"import wavepath; print(wavepath.__file__, wavepath.render({CORNELL!r}, spp=1, size=(8, 8)).image.shape)"


@pytest.fixture(scope="module")
def environment(tmp_path_factory):
    folder = tmp_path_factory.mktemp("environment") / "venv"
    made = subprocess.run([sys.executable, "-m", "venv", "--system-site-packages", str(folder)], capture_output=True,
                          check=False)
    if made.returncode != 0:
        pytest.skip("this Python makes no virtual environments (python3-venv)")
    return folder


def run(environment, *words):
    clean = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True, check=False, cwd="/",
                          env={**clean, "PIP_NO_INDEX": "1", "PIP_DISABLE_PIP_VERSION_CHECK": "1"})
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.mark.parametrize("kind", ["wheel", "editable"])
def test_pip_install(environment, kind):
    python = environment / "bin" / "python"
    options = ["-e"] if kind == "editable" else []
    run(environment, python, "-m", "pip", "install", *options, ROOT)
    where, shape = run(environment, python, "-c", RENDER).split(" ", 1)
    assert shape.strip() == "(8, 8, 4)"
    assert pathlib.Path(where).is_relative_to(environment) == (kind == "wheel")
    assert "render" in run(environment, environment / "bin" / "wavepath", "--help")
