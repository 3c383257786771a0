"""The other commands: compare, merge, info, study, bench, selftest."""

from __future__ import annotations

import json
import os
import pathlib
import subprocess
import sys
import tempfile
from typing import Any, Iterable, Union

import numpy as np
from numpy.typing import NDArray

from . import _core
from .errors import Error, UsageError
from .result import Result, read
from .settings import settings_of

Picture = Union[str, "os.PathLike[str]", Result, NDArray[Any]]


def _words(flags: dict[str, Any]) -> list[str]:
    words = []
    for name, value in settings_of(flags).items():
        if value is False:
            continue
        if isinstance(value, list):
            value = ("x" if name == "size" else ":" if name == "samples" else ",").join(map(str, value))
        words.append(f"--{name}" if value is True else f"--{name}={value}")
    return words


def compare(image: Picture, reference: Picture) -> dict[str, Any]:
    """How far a picture is from a reference: the document of ``wavepath compare --json``.

    Pictures are results, files, or arrays of height x width x 3 or 4 (linear). Keys: ``mse``, ``relmse``, ``mrse``,
    ``relative_rms``, ``psnr``, ``flip``, ``max``, ``p99.9``, ``mean_ratio``, ``nonfinite``.
    """
    if isinstance(image, (str, os.PathLike)) and isinstance(reference, (str, os.PathLike)):
        out, _, _ = _core.command(["compare", os.fspath(image), os.fspath(reference), "--json"])
        return json.loads(out)
    return json.loads(_core.compare(_pixels("image", image), _pixels("reference", reference)))


def _pixels(name: str, picture: Picture) -> NDArray[np.float32]:
    if isinstance(picture, (str, os.PathLike)):
        picture = read(picture)
    array = picture.image if isinstance(picture, Result) else np.asarray(picture)
    if array.ndim != 3 or array.shape[2] not in (3, 4):
        raise UsageError(name, f"has the shape {array.shape}", "give an array of height x width x 3")
    return np.ascontiguousarray(array[:, :, :3], dtype=np.float32)


def merge(parts: Iterable[Any], output: Any) -> str:
    """Join parts of one render (``samples=(a, b)``, saved as .exr) into ``output``. Returns what the command tells."""
    words = ["merge", *(os.fspath(part) for part in parts), "-o", os.fspath(output)]
    return _core.command(words)[1]


def info(scene: Any = None, **flags: Any) -> Any:
    """Without a scene: the devices. With one: its content, and the memory that a render needs, as a dict."""
    words = ["info", *([] if scene is None else [os.fspath(scene)]), "--json", *_words(flags)]
    return json.loads(_core.command(words)[0])


def _program(words: list[str]) -> str:
    """Runs the command line in a process of its own: these commands time things, and change what a process has."""
    done = subprocess.run([sys.executable, "-m", "wavepath", *words], capture_output=True, text=True,
                          env={**os.environ, "PYTHONPATH": os.pathsep.join(path for path in sys.path if path)})
    if done.returncode not in (0, 1) or not done.stdout.strip() and done.returncode:
        text = done.stderr.strip().splitlines()[-1:] or ["failed"]
        message = text[0].removeprefix("wavepath: error: ")
        where, _, rest = message.partition(": ")
        problem, _, remedy = rest.rpartition("; ")
        raise Error(where, problem or rest, remedy)
    return done.stdout


def selftest(*, only: Iterable[str] = (), **flags: Any) -> list[dict[str, Any]]:
    """Run the numerical suite on this device: a list of name, expected, measured, tolerance, verdict."""
    return json.loads(_program(["selftest", "--json", *(f"--only={name}" for name in only), *_words(flags)]))


def bench(scene: Any = None, **flags: Any) -> dict[str, Any]:
    """Rates of the kernels: the document of ``wavepath bench --json``."""
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder) / "bench.json"
        _program(["bench", *([] if scene is None else [os.fspath(scene)]), f"--json={file}", *_words(flags)])
        return json.loads(file.read_text())


def study(scene: Any, output: Any, **flags: Any) -> dict[str, Any]:
    """Render a grid of configurations against a converged reference: ``study.json`` of the folder ``output``."""
    _program(["study", os.fspath(scene), "-o", os.fspath(output), *_words(flags)])
    return json.loads((pathlib.Path(output) / "study.json").read_text())
