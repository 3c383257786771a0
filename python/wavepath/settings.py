"""From keyword arguments to settings by the names of the flags of ``wavepath render``."""

from __future__ import annotations

import os
from typing import Any, Mapping

from .camera import Camera
from .errors import UsageError

_ALIASES = {"aovs": "aov", "env": "env", "environment": "env", "denoised": "denoise"}


def _other_camera(name: str, camera: Camera) -> Any:
    """``camera_to`` and ``camera_from``, which know where a camera stands and looks, and its name."""
    flags: dict[str, Any] = dict(camera.flags)
    if set(flags) == {"camera"}:
        return str(flags["camera"])
    if {"eye", "look_at"} <= set(flags):
        return [float(x) for key in ("eye", "look_at", "up") if key in flags for x in flags[key]]
    raise UsageError(name, "takes a camera by its name, or with eye and look_at", "give these")


def _plain(name: str, value: Any) -> Any:
    """The value as bool, int, float, str, or a list of these."""
    if isinstance(value, (bool, int, float, str)):
        return value
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if isinstance(value, Camera):
        return _other_camera(name, value)
    if hasattr(value, "tolist"):  # NumPy's numbers and arrays
        value = value.tolist()
        if isinstance(value, (bool, int, float, str)):
            return value
    if isinstance(value, (list, tuple)):
        items = [_plain(name, item) for item in value]
        if not any(isinstance(item, list) for item in items):
            return items
    remedy = "give a number, a text, True or False, or a list of these"
    raise UsageError(name, f"cannot be {type(value).__name__}", remedy)


def settings_of(flags: Mapping[str, Any]) -> dict[str, Any]:
    """Settings of keyword arguments: ``None`` leaves a setting out, ``_`` stands for ``-``."""
    settings = {}
    for key, value in flags.items():
        if value is None:
            continue
        name = _ALIASES.get(key, key).replace("_", "-")
        if isinstance(value, (list, tuple)) and len(value) == 0:
            continue
        settings[name] = _plain(key, value)
    return settings
