"""A picture with its channels and everything that was measured."""

from __future__ import annotations

import base64
import json
import os
from collections.abc import Mapping
from functools import cached_property
from typing import Any, Iterator, Optional, Union

import numpy as np
from numpy.typing import NDArray

from . import _core
from .settings import settings_of

_IDS = ("ids", "node", "material")
_NAMES = (
    "albedo", "normal", "depth", "position", "variance", "samples", "direct", "indirect", "emission", "roughness",
    "metallic", "ids", "node", "material", "depth0", "normal0", "position0", "geometric", "uv", "depth_min",
    "motion", "motion_back", "shadow", "environment", "ao", "denoised",
)


class Aovs(Mapping):
    """Arrays of AOVs by the names of ``--aov``: float32, height x width, or height x width x channels.

    ``node``, ``material`` and ``ids`` are int32. An array is made when it is asked for first.
    """

    def __init__(self, core: _core.Result) -> None:
        self._core = core
        self._arrays: dict[str, NDArray[Any]] = {}

    def __getitem__(self, name: str) -> NDArray[Any]:
        if name not in self._arrays:
            channels = self._core.channels_of(name)
            if not channels:
                raise KeyError(f"{name}: the picture has {', '.join(self) or 'no AOVs'}; render with aovs=[{name!r}]")
            make = self._core.ints if name in _IDS else self._core.floats
            self._arrays[name] = make(channels, True)
        return self._arrays[name]

    def __iter__(self) -> Iterator[str]:
        return (name for name in _NAMES if self._core.channels_of(name))

    def __len__(self) -> int:
        return sum(1 for _ in self)

    def __repr__(self) -> str:
        return f"<AOVs: {', '.join(self) or 'none'}>"


class Result:
    """A finished picture. Its arrays are yours: they outlive it, and nothing writes them again."""

    def __init__(self, core: _core.Result) -> None:
        self._core = core
        self.aov = Aovs(core)
        """AOVs by name, such as ``r.aov["normal"]``."""

    @cached_property
    def image(self) -> NDArray[np.float32]:
        """Linear radiance: float32, height x width x 4 (R, G, B, A), the top row first.

        A file without alpha gives three channels.
        """
        return self._core.floats([name for name in "RGBA" if name in self.channels])

    @cached_property
    def channels(self) -> list[str]:
        """Names of all channels, as in an EXR."""
        return self._core.channels

    def channel(self, name: str) -> NDArray[np.float32]:
        """One channel by its name in an EXR, such as ``"albedo.R"``: float32, height x width."""
        return self._core.floats([name], True)

    @cached_property
    def groups(self) -> dict[str, NDArray[np.float32]]:
        """Light of each group of ``light_groups``, which add up to the picture: float32, height x width x 3.

        >>> r = wavepath.render("scenes/cornell_box.gltf", spp=1, size=(8, 8), light_groups="each")
        >>> [light.shape for light in r.groups.values()]
        [(8, 8, 3)]
        """
        text = self._core.text("wavepath.light_groups")
        layers = json.loads(text) if text else {}
        return {name: self._core.floats([f"{layer}.{c}" for c in "RGB"]) for layer, name in layers.items()}

    @property
    def size(self) -> tuple[int, int]:
        """Width and height in pixels."""
        return self._core.width, self._core.height

    @property
    def place(self) -> tuple[int, int, int, int]:
        """Left, top, width, height: where the left top corner of a ``crop`` lies, and the size of the whole picture."""
        return self._core.place

    @property
    def spp(self) -> int:
        """Samples of each pixel."""
        return self._core.spp

    @property
    def error(self) -> float:
        """Estimated relative RMS error; NaN where there are too few samples."""
        return self._core.error

    @property
    def seconds(self) -> float:
        """Seconds of rendering, without loading and compiling."""
        return self._core.seconds

    @property
    def stop(self) -> str:
        """Why the render ended: ``"samples"``, ``"time"``, ``"target-error"`` or ``"interrupted"``."""
        return self._core.stop

    @property
    def warnings(self) -> list[str]:
        """Warnings, one of each kind."""
        return self._core.warnings

    @property
    def repeat(self) -> str:
        """The command that renders the same bits; empty after edits of the scene."""
        return self._core.repeat

    @cached_property
    def stats(self) -> dict[str, Any]:
        """The stats document (``--stats``): everything that was measured."""
        text = self._core.stats_text
        return json.loads(text) if text else {}

    @cached_property
    def nodes(self) -> dict[int, dict[str, Any]]:
        """Of each id in ``aov["node"]``: name, mesh and material."""
        return _table(self._core.text("wavepath.nodes"))

    @property
    def names(self) -> dict[int, str]:
        """Names of the ids in ``aov["node"]``; -1 (nothing was hit) is not among them."""
        return {number: _name(about) for number, about in self.nodes.items()}

    def save(self, file: Any, **settings: Any) -> None:
        """Write .exr, .hdr, .png or .jpg, as ``render -o FILE`` does.

        ``settings``: ``exposure``, ``tonemap``, ``bits``, ``half``, ``layers``, ``compression``, ``multi_part``.
        """
        self._core.save(os.fspath(file), settings_of(settings))

    def png(self, **settings: Any) -> bytes:
        """The picture as a PNG, through a tone curve (``exposure="auto"``, ``tonemap="agx"``, ``bits=16``)."""
        return self._core.encode("png", settings_of(settings))

    def jpg(self, **settings: Any) -> bytes:
        """The picture as a JPEG."""
        return self._core.encode("jpg", settings_of(settings))

    def __array__(self, dtype: Any = None, copy: Optional[bool] = None) -> NDArray[Any]:
        array = self.image if dtype is None else self.image.astype(dtype)
        return array.copy() if copy and array is self.image else array

    def __repr__(self) -> str:
        width, height = self.size
        return f"<wavepath.Result {width}x{height}, {self._line()}>"

    def _line(self) -> str:
        error = "" if np.isnan(self.error) else f", error {100 * self.error:.2g} %"
        return f"{self.spp} spp in {self.seconds:.2f} s{error}"

    def _repr_html_(self) -> str:
        picture = base64.b64encode(self.jpg(exposure="auto")).decode()
        width, height = self.size
        return (
            f'<img src="data:image/jpeg;base64,{picture}" width="{width}" height="{height}"/>'
            f"<br/>{width}x{height}, {self._line()}"
        )


def read(file: Any) -> Result:
    """Read a picture file with all its channels: .exr, .hdr, .png, .jpg and other formats. Values are linear."""
    return Result(_core.read(os.fspath(file)))


def _table(text: str) -> dict[int, dict[str, Any]]:
    if not text:
        return {}
    document = json.loads(text)
    if isinstance(document, list):
        return dict(enumerate(document))
    return {int(number): about for number, about in document.items()}


def _name(about: Union[str, dict[str, Any]]) -> str:
    return about if isinstance(about, str) else str(about.get("name", ""))
