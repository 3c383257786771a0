"""Cameras."""

from __future__ import annotations

from typing import Any, Optional

import numpy as np
from numpy.typing import ArrayLike

from . import _core
from .errors import UsageError


class Camera:
    """A camera: where it is, where it looks, and how directions become pixels.

    ``eye``, ``look_at``: points in metres. ``up``: a direction. ``yfov``: vertical field of view in degrees. ``name``:
    a camera of the file, by name or index. What is left out comes from the scene's first camera. Further flags of a
    camera are keywords too: ``projection``, ``fov``, ``shift``, ``intrinsics``, ``clip``, ``stereo``, ``velocity``,
    ``aperture``, ``focus``, ``blades``.

    >>> Camera(eye=(0, 1, 3), look_at=(0, 1, 0), yfov=40)
    Camera(eye=(0, 1, 3), look_at=(0, 1, 0), yfov=40)
    """

    def __init__(
        self,
        name: Optional[str] = None,
        *,
        eye: Optional[ArrayLike] = None,
        look_at: Optional[ArrayLike] = None,
        up: Optional[ArrayLike] = None,
        yfov: Optional[float] = None,
        **flags: Any,
    ) -> None:
        given = {"camera": name, "eye": eye, "look_at": look_at, "up": up, "yfov": yfov, **flags}
        self.flags = {key: value for key, value in given.items() if value is not None}
        """Keyword arguments of ``render`` that give this camera."""

    @classmethod
    def from_matrix(
        cls,
        world_from_camera: ArrayLike,
        K: Optional[ArrayLike] = None,
        size: Optional[tuple[int, int]] = None,
        convention: str = "opengl",
    ) -> Camera:
        """The camera with a pose, and perhaps intrinsics, of another program.

        ``world_from_camera``: 4x4, a rotation and a position. ``K``: 3x3, in pixels, from the top left corner of a
        picture of ``size`` (width, height). ``convention``: axes of the camera, ``"opengl"`` (y up, looks along -z;
        also Blender's and glTF's) or ``"opencv"`` (y down, looks along z).

        Raises UsageError for matrices that are not finite, that scale, shear or mirror, and for skewed ``K``.
        """
        if convention not in ("opengl", "opencv"):
            raise UsageError("convention", f"'{convention}' is none", "choose from opengl, opencv")
        pose = _matrix(world_from_camera, 4, "world_from_camera")
        k = None if K is None else _matrix(K, 3, "K")
        camera = cls(**_core.camera_settings(pose, k, convention == "opencv"))
        if size is not None:
            camera.flags["size"] = tuple(size)
        return camera

    def __repr__(self) -> str:
        text_of = lambda value: "Camera(...)" if isinstance(value, Camera) else repr(value)
        return f"Camera({', '.join(f'{name}={text_of(value)}' for name, value in self.flags.items())})"


def _matrix(values: ArrayLike, size: int, name: str) -> list[list[float]]:
    matrix = np.asarray(values, dtype=np.float64)
    if matrix.shape != (size, size):
        raise UsageError(name, f"has the shape {matrix.shape}", f"give a matrix of {size}x{size}")
    return matrix.tolist()
