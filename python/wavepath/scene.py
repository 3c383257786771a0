"""Scenes: files that stay on a device while pictures of them are rendered and things about them change."""

from __future__ import annotations

import atexit
import contextlib
import os
import queue
import threading
import weakref
from collections.abc import Mapping
from typing import Any, Callable, Generic, Iterable, Iterator, Optional, TypeVar, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core, rendering
from .camera import Camera, _matrix
from .errors import Error, Interrupted, UsageError
from .nearest import suggestion
from .result import Result
from .settings import settings_of

GROUND_TRUTH = ["depth0", "normal0", "node", "uv"]
"""AOVs through the centres of pixels, without filter, lens or shutter: what training data usually wants."""

_T = TypeVar("_T")
CameraArgument = Union[None, str, int, Camera]  # a camera, or the name or index of one of the file


class Named(Mapping, Generic[_T]):
    """Things of a scene, by name or by index. Of several with one name, the first is meant."""

    def __init__(self, kind: str, names: list[str], make: Callable[[int], _T]) -> None:
        self._kind, self._names, self._make = kind, names, make

    def __getitem__(self, key: Union[str, int]) -> _T:
        if isinstance(key, str):
            if key not in self._names:
                raise UsageError(key, f"is no {self._kind} of the scene", suggestion(key, self._names))
            return self._make(self._names.index(key))
        if not 0 <= key < len(self._names):
            raise UsageError(f"{self._kind} {key}", "does not exist", f"the scene has {len(self._names)}")
        return self._make(key)

    def __contains__(self, key: object) -> bool:
        return key in self._names if isinstance(key, str) else isinstance(key, int) and 0 <= key < len(self._names)

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)

    def __repr__(self) -> str:
        return f"<{len(self)} {self._kind}s: {', '.join(self._names)}>"


class Node:
    """A node of the scene."""

    def __init__(self, scene: Scene, index: int) -> None:
        self._scene, self.index = scene, index

    @property
    def matrix(self) -> NDArray[np.float64]:
        """4x4, relative to the parent, as glTF has it. ``None`` sets it back to the file's."""
        return np.array(self._scene._core.matrix(self.index))

    @matrix.setter
    def matrix(self, value: Optional[ArrayLike]) -> None:
        self._scene._touch()
        if value is None:
            self._scene._core.reset_matrix(self.index)
        else:
            self._scene._core.set_matrix(self.index, _matrix(value, 4, "matrix"))

    @property
    def visible(self) -> bool:
        """False hides the node and its children."""
        return self._scene._core.is_visible(self.index)

    @visible.setter
    def visible(self, value: bool) -> None:
        self._scene._touch()
        self._scene._core.set_visible(self.index, bool(value))

    def remove(self) -> None:
        """Remove a mesh that ``add_mesh`` added."""
        self._scene._touch()
        self._scene._core.remove_mesh(self.index)

    def __repr__(self) -> str:
        return f"<Node {self.index} '{self._scene._core.nodes()[self.index]}'>"


class SceneMaterial:
    """A material of the scene. Its fields are attributes: numbers, tuples, and arrays for textures.

    ``base_color`` (4), ``metallic``, ``roughness``, ``emission`` (3, radiance), ``transmission``, ``ior``, ``coat``,
    ...: ``dir(material)`` lists them. ``base_color_texture`` and others are set from arrays of height x width x 1 to 4,
    uint8 or float; they cannot be read.
    """

    _scene: Scene
    index: int

    def __init__(self, scene: Scene, index: int) -> None:
        object.__setattr__(self, "_scene", scene)
        object.__setattr__(self, "index", index)

    def __getattr__(self, name: str) -> Union[float, tuple[float, ...]]:
        if name.startswith("_"):
            raise AttributeError(name)
        value = self._scene._core.material(self.index, name)
        return value[0] if len(value) == 1 else tuple(value)

    def __setattr__(self, name: str, value: Any) -> None:
        self._scene._touch()
        if name in _core.material_textures():
            self._scene._core.set_texture(self.index, name, np.asarray(value))
        else:
            self._scene._core.set_material(self.index, name, np.asarray(value, dtype=np.float64).ravel().tolist())

    def __dir__(self) -> list[str]:
        return [*_core.material_fields(), *_core.material_textures(), "index"]

    def __repr__(self) -> str:
        return f"<Material {self.index} '{self._scene._core.materials()[self.index]}'>"


class Material:
    """A material for ``add_mesh``, by the fields of ``SceneMaterial``: ``Material(base_color=(1, 0, 0, 1))``."""

    def __init__(self, **fields: Any) -> None:
        if "base_color" in fields and len(fields["base_color"]) == 3:
            fields["base_color"] = (*fields["base_color"], 1.0)
        self.fields = {"metallic": 0.0, **fields}


class Light:
    """A light of the scene. Its fields are attributes.

    ``intensity``: an array of red, green and blue, in candela, or in lux if the light is directional; a single number
    is white. ``range``: metres at which a lamp has faded to nothing, 0 = nowhere. ``cones``: inner and outer half angle
    of a spot, in degrees. ``radius``: metres, or ``angle``: degrees across of a directional light, 0 = hard shadows.
    Its node moves and hides it; ``node`` is None for a sun or lamp that wavepath has added.

    >>> scene = wavepath.Scene("scenes/analytic/spot_light.gltf")
    >>> scene.lights[0].intensity *= 2
    """

    _scene: Scene
    name: str
    node: Optional[Node]

    def __init__(self, scene: Scene, name: str, index: int) -> None:
        object.__setattr__(self, "_scene", scene)
        object.__setattr__(self, "_index", index)
        object.__setattr__(self, "name", name)
        object.__setattr__(self, "node", Node(scene, index) if index < len(scene._core.nodes()) else None)

    def __getattr__(self, field: str) -> Any:
        if field.startswith("_"):
            raise AttributeError(field)
        value = self._scene._core.light(self._index, field)
        return np.array(value) if field == "intensity" else value[0] if len(value) == 1 else tuple(value)

    def __setattr__(self, field: str, value: Any) -> None:
        values = np.asarray(value, dtype=np.float64).ravel().tolist()
        if field == "intensity" and len(values) == 1:
            values = values * 3
        self._scene._touch()
        self._scene._core.set_light(self._index, field, values)

    def __dir__(self) -> list[str]:
        return [*_core.light_fields(), "name", "node"]

    def __repr__(self) -> str:
        return f"<Light '{self.name}'>"


class Environment:
    """Light from all directions. ``source``: a picture file, ``"studio"``, ``"sky"``, ``"black"``, ``"white"``, a
    radiance (r, g, b), or an array of height x width x 3 (lat-long, linear). ``rotation``: degrees about +Y."""

    def __init__(self, source: Any, *, rotation: float = 0.0, intensity: float = 1.0) -> None:
        self.source, self.rotation, self.intensity = source, rotation, intensity


class Scene:
    """A scene that stays on a device.

    ``file``: .gltf or .glb. ``device``: a ``Device`` that scenes share; by default one is opened. ``flags``: about the
    scene (``env``, ``animation``, ``at``, ``ground``, ``sun``), and defaults of its pictures (``spp``, ``size``).

    >>> scene = wavepath.Scene("scenes/cornell_box.gltf", size=(64, 64), spp=4)
    >>> scene.render(max_depth=2).image.shape
    (64, 64, 4)

    Edits (materials, nodes, environment) are noted, and done by the next picture: only what they touch is packed and
    uploaded again. Pictures have the bits of a file that says the same. Threads may share a scene; its pictures are
    rendered one after the other.
    """

    def __init__(self, file: Any, *, device: Optional[_core.Device] = None, **flags: Any) -> None:
        self.file = os.fspath(file)
        self._flags: dict[str, Any] = {"variant": flags.pop("variant", None)}  # not a default, so that None is none
        self._core = _core.Session(self.file, settings_of(flags), device)
        if self._flags["variant"] is not None:
            self._check_variant(self._flags["variant"])
        self._version = 0  # of what is to be seen; progressive() starts again when it changes
        self._camera: CameraArgument = None
        self.last_update: dict[str, float] = {}
        """What the latest ``update`` did again, in milliseconds."""

    def _touch(self) -> None:
        self._version += 1

    @property
    def device(self) -> _core.Device:
        """The device that the scene is on."""
        return self._core.device()

    @property
    def cameras(self) -> Named[Camera]:
        """Cameras of the file."""
        return Named("camera", self._core.cameras(), lambda index: Camera(str(index)))

    @property
    def nodes(self) -> Named[Node]:
        """Nodes of the file, and meshes that were added."""
        return Named("node", self._core.nodes(), lambda index: Node(self, index))

    @property
    def materials(self) -> Named[SceneMaterial]:
        """Materials of the file, and those that were added."""
        return Named("material", self._core.materials(), lambda index: SceneMaterial(self, index))

    @property
    def lights(self) -> Named[Light]:
        """Lights of visible nodes, and a sun or lamp that wavepath has added."""
        lights = self._core.lights()
        return Named("light", [name for name, _ in lights], lambda index: Light(self, *lights[index]))

    @property
    def bounds(self) -> NDArray[np.float64]:
        """2x3: the corners of the box around all vertices, in metres."""
        return np.array(self._core.bounds())

    @property
    def camera(self) -> CameraArgument:
        """The camera of pictures that name none; None is the file's."""
        return self._camera

    @camera.setter
    def camera(self, camera: CameraArgument) -> None:
        self._camera = camera
        self._touch()

    @property
    def time(self) -> float:
        """Moment of the animation, in seconds."""
        return float(self._flags.get("at", 0.0))

    @time.setter
    def time(self, seconds: float) -> None:
        self._flags["at"] = float(seconds)
        self._touch()

    @property
    def variants(self) -> list[str]:
        """Names of the variants of materials that the file has."""
        return list(self._core.variants())

    @property
    def variant(self) -> Optional[str]:
        """The variant of materials that is shown; None is the file's own materials."""
        return self._flags.get("variant")

    @variant.setter
    def variant(self, name: Optional[str]) -> None:
        if name is not None:
            self._check_variant(name)
        self._flags["variant"] = name
        self._touch()

    def _check_variant(self, name: str) -> None:
        if name not in self.variants:
            raise UsageError("variant", f"is {name!r}, which the file does not have", f"choose one of {self.variants}")

    def set_environment(self, environment: Any, *, rotation: float = 0.0, intensity: float = 1.0) -> None:
        """Light the scene by another environment: see ``Environment``."""
        if not isinstance(environment, Environment):
            environment = Environment(environment, rotation=rotation, intensity=intensity)
        source = environment.source
        self._touch()
        if isinstance(source, np.ndarray) and source.ndim == 3:
            self._core.set_environment(source, environment.intensity, environment.rotation)
            return
        self._flags.update(env=source, env_rotation=environment.rotation, env_intensity=environment.intensity)

    environment = property(None, set_environment, doc="Set to an ``Environment``, or to its source.")

    def add_mesh(
        self,
        name: str,
        vertices: ArrayLike,
        faces: ArrayLike,
        *,
        normals: Optional[ArrayLike] = None,
        uvs: Optional[ArrayLike] = None,
        material: Union[None, Material, SceneMaterial] = None,
        matrix: ArrayLike = np.eye(4),
    ) -> Node:
        """Add triangles. ``vertices``: count x 3, metres. ``faces``: count x 3 indices. Returns their node.

        They are seen from the side where their vertices turn counter-clockwise; ``Material(double_sided=True)`` is seen
        from both.
        """
        points = _rows("vertices", vertices, 3, np.float32)
        triangles = _rows("faces", faces, 3, np.int64)
        if len(triangles) and (triangles.min() < 0 or triangles.max() >= len(points)):
            raise UsageError("faces", f"name vertices outside 0 to {len(points) - 1}", "mend the indices")
        if not isinstance(material, SceneMaterial):
            material = self._add_material(name, material or Material())
        self._touch()
        index = self._core.add_mesh(
            name, points, triangles.astype(np.uint32),
            None if normals is None else _rows("normals", normals, 3, np.float32),
            None if uvs is None else _rows("uvs", uvs, 2, np.float32),
            material.index, _matrix(matrix, 4, "matrix"),
        )
        return Node(self, index)

    def _add_material(self, name: str, wanted: Material) -> SceneMaterial:
        material = SceneMaterial(self, self._core.add_material(name))
        for field, value in wanted.fields.items():
            setattr(material, field, value)
        return material

    def update(self) -> dict[str, float]:
        """Do the edits that were noted; returns what was done again, in milliseconds."""
        self.last_update = dict(self._core.update())
        return self.last_update

    @contextlib.contextmanager
    def edit(self) -> Iterator[Scene]:
        """Several edits that are done at once, at the end of the ``with``."""
        yield self
        self.update()

    def _settings(self, camera: CameraArgument, flags: dict[str, Any]) -> dict[str, Any]:
        return settings_of({**self._flags, **_camera_flags(self._camera if camera is None else camera), **flags})

    def render(
        self, camera: CameraArgument = None, *, progress: rendering.ProgressArgument = None, **flags: Any
    ) -> Result:
        """Render a picture. ``flags``: those of ``wavepath render``, ``-`` written ``_``.

        ``progress``: a function that is called with a ``Progress`` about every 100 ms, and ends the render by returning
        False; True shows a bar, if tqdm is installed. Ctrl-C raises ``Interrupted`` with the picture so far.
        """
        settings = self._settings(camera, flags)
        return rendering.run(lambda **hooks: self._core.render(settings, **hooks), progress)

    def start(self, camera: CameraArgument = None, **flags: Any) -> Job:
        """Begin to render in another thread."""
        return Job(self._core, self._settings(camera, flags))

    def batch(
        self, cameras: Iterable[CameraArgument], *, seed: Union[None, int, str] = None, **flags: Any
    ) -> Iterator[Result]:
        """Pictures of many cameras, one after the other, in constant memory.

        The next one is rendered while you use the one before. ``seed="frame"`` gives each its own seed, so that noise
        differs.
        """
        cameras = iter(cameras)
        job: Optional[Job] = None
        count = 0
        try:
            for camera in cameras:
                own = {} if seed is None else {"seed": count if seed == "frame" else seed}
                following = self._settings(camera, {**flags, **own})
                finished = job.result() if job else None
                job = Job(self._core, following)
                count += 1
                if finished is not None:
                    yield finished
            if job is not None:
                last, job = job, None
                yield last.result()
        finally:
            if job is not None:
                job.cancel()

    def progressive(
        self, camera: CameraArgument = None, *, every: float = 0.5, **flags: Any
    ) -> Iterator[Result]:
        """The picture as it converges, about every ``every`` seconds, and at last the finished one.

        A change of ``scene.camera`` or of the scene between two pictures starts it again.
        """
        job: Optional[Job] = None
        try:
            while True:
                version = self._version
                job = Job(self._core, self._settings(camera, flags), every, lambda: self._version == version)
                for result in job.pictures():
                    yield result
                    if self._version != version:
                        break
                else:
                    return
                job.cancel()
        finally:
            if job is not None:
                job.cancel()


def _camera_flags(camera: CameraArgument) -> dict[str, Any]:
    if camera is None:
        return {}
    return camera.flags if isinstance(camera, Camera) else {"camera": str(camera)}


def _rows(name: str, values: ArrayLike, width: int, dtype: Any) -> NDArray[Any]:
    array = np.ascontiguousarray(values, dtype=dtype)
    if array.ndim != 2 or array.shape[1] != width:
        raise UsageError(name, f"have the shape {array.shape}", f"give an array of count x {width}")
    return array


_running: weakref.WeakSet[Job] = weakref.WeakSet()


@atexit.register
def _end_jobs() -> None:
    """Python ends threads that want its lock while it shuts down, and C++ cannot be ended so."""
    for job in list(_running):
        job.cancel()


class Job:
    """A render in another thread."""

    def __init__(
        self, core: _core.Session, settings: dict[str, Any], every: Optional[float] = None,
        goes_on: Callable[[], bool] = lambda: True,
    ) -> None:
        self.progress: Optional[_core.Progress] = None
        """How far it is; None before it renders."""
        self._cancelled, self._done = threading.Event(), threading.Event()
        self._pictures: queue.Queue[Optional[Result]] = queue.Queue()
        self._result: Optional[Result] = None
        self._failure: Optional[BaseException] = None

        def note(progress: _core.Progress) -> bool:
            self.progress = progress
            return not self._cancelled.is_set() and goes_on()

        def run() -> None:
            hooks: dict[str, Any] = {} if every is None else {
                "picture": lambda picture: self._pictures.put(Result(picture)), "every": every}
            try:
                if not self._cancelled.is_set():
                    self._result = rendering.run(lambda **own: core.render(settings, **own, **hooks), note)
            except BaseException as failure:  # which is for who asks for the result
                self._failure = failure
            self._done.set()
            self._pictures.put(None)

        self._thread = threading.Thread(target=run, name="wavepath", daemon=True)
        _running.add(self)
        self._thread.start()

    def done(self) -> bool:
        """True if it has ended."""
        return self._done.is_set()

    def cancel(self) -> None:
        """End it with what it has, and wait for that."""
        self._cancelled.set()
        self._thread.join()

    def result(self, timeout: Optional[float] = None) -> Result:
        """Wait for the picture. Raises TimeoutError after ``timeout`` seconds, and what the render raised."""
        try:
            if not self._done.wait(timeout):
                raise TimeoutError(f"not done after {timeout} s")
        except KeyboardInterrupt:
            self.cancel()
            raise Interrupted(self._result) from None
        if self._failure is not None:
            raise self._failure
        if self._result is None:
            raise Error("job", "was cancelled before it began", "start another one")
        return self._result

    def pictures(self) -> Iterator[Result]:
        """Pictures so far as they come, then the finished one."""
        while True:
            picture = self._pictures.get()
            if picture is None:
                break
            yield picture
        yield self.result()


def render(scene: Any, camera: CameraArgument = None, *, progress: rendering.ProgressArgument = None,
           **flags: Any) -> Result:
    """Render one picture of a file, as ``wavepath render`` does, to the same bits.

    ``scene``: .gltf or .glb. ``flags``: every flag of ``wavepath render`` (``wavepath render --help-all``), ``-``
    written ``_``: ``spp=64``, ``size=(1280, 720)``, ``aovs=["albedo", "node"]``, ``max_depth=4``, ``denoise=True``,
    ``output="a.exr"``. ``progress``: as in ``Scene.render``.

    >>> r = wavepath.render("scenes/cornell_box.gltf", spp=4, size=(64, 64), aovs=["normal"])
    >>> r.image.dtype, r.image.shape, r.aov["normal"].shape
    (dtype('float32'), (64, 64, 4), (64, 64, 3))
    """
    settings = settings_of({**_camera_flags(camera), **flags})
    file = os.fspath(scene)
    return rendering.run(lambda **hooks: _core.render(file, settings, **hooks), progress)
