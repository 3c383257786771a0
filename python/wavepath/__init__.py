"""wavepath: reference images of glTF scenes, path traced on a GPU or on the CPU.

>>> import wavepath
>>> r = wavepath.render("scenes/cornell_box.gltf", spp=4, size=(64, 64))
>>> r.image.shape, r.stats["spp"]
((64, 64, 4), 4)

``Scene`` keeps a scene on a device, for many pictures and for edits. docs/python.md tells more.
"""

from . import _core
from ._core import Device, DeviceInfo, Progress, devices
from .camera import Camera
from .errors import Error, Interrupted, UsageError
from .result import Result, read
from .scene import GROUND_TRUTH, Environment, Job, Material, Scene, render
from .tools import bench, compare, info, merge, selftest, study

_core._set_errors(Error, UsageError)

__version__: str = _core.version
__all__ = [
    "GROUND_TRUTH", "Camera", "Device", "DeviceInfo", "Environment", "Error", "Interrupted", "Job", "Material",
    "Progress", "Result", "Scene", "UsageError", "bench", "compare", "devices", "info", "merge", "read", "render",
    "selftest", "study",
]
