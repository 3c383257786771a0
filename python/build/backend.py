"""The build backend of pyproject.toml (PEP 517, PEP 660): configures and builds with CMake, and packs a wheel.

It uses the standard library alone. CMake, Ninja, a compiler, pybind11 and the libraries of wavepath must be installed;
`./run python` installs them on Debian. It builds in the folder of `./run python` where that is for the same Python,
else in build/pip. WAVEPATH_PIP_BUILD names another folder; where the module is built in it, nothing is built again, so
that others may use it meanwhile."""

import base64
import hashlib
import io
import os
import pathlib
import re
import subprocess
import sys
import sysconfig
import tarfile
import zipfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
STAMP = (1980, 1, 1, 0, 0, 0)  # of all files, so that the same sources give the same wheel


def _project():
    """Name, version and metadata; read by hand, because Python knows TOML only since 3.11."""
    text = (ROOT / "pyproject.toml").read_text()
    field = lambda name: re.search(rf'^{name} = "(.*)"$', text, re.M).group(1)
    requires = re.search(r"^dependencies = \[(.*)\]$", text, re.M).group(1)
    metadata = [
        "Metadata-Version: 2.1", f"Name: {field('name')}", f"Version: {field('version')}",
        f"Summary: {field('description')}", "License: MIT", f"Requires-Python: {field('requires-python')}",
        *(f"Requires-Dist: {one}" for one in re.findall(r'"([^"]+)"', requires)),
        "Description-Content-Type: text/markdown", "", (ROOT / field("readme")).read_text(),
    ]
    scripts = "".join(f"{name} = {target}\n" for name, target in
                      re.findall(r'^(\w+) = "([\w.]+:\w+)"$', text, re.M))
    return field("name"), field("version"), "\n".join(metadata), f"[console_scripts]\n{scripts}"


def _tag():
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    return f"{python}-{python}-{re.sub('[-.]', '_', sysconfig.get_platform())}"


def _run(*words):
    try:
        subprocess.run([str(word) for word in words], check=True)
    except FileNotFoundError:
        raise SystemExit(f"wavepath: {words[0]} is not installed; './run setup' installs what a build needs") from None


def _is_of_run(folder, python):
    """True for the folder that `./run python` builds in, if for this Python."""
    cache = folder / "CMakeCache.txt"
    lines = cache.read_text().splitlines() if cache.exists() else []
    values = {name: value for name, _, value in (re.split(r":\w+(=)", line, maxsplit=1) for line in lines
                                                  if re.match(r"\w+:\w+=", line))}
    return (values.get("WAVEPATH_PYTHON") == "ON" and values.get("CMAKE_HOME_DIRECTORY") == str(ROOT)
            and os.path.realpath(values.get("Python3_EXECUTABLE", "")) == os.path.realpath(python))


def _build(settings):
    """The build folder, built."""
    chosen = os.environ.get("WAVEPATH_PIP_BUILD")
    python = getattr(sys, "_base_executable", sys.executable)  # a virtual environment has no headers
    folder = pathlib.Path(chosen or ROOT / "build")
    options = [f"-D{name}={value}" for name, value in (settings or {}).items() if name.startswith("WAVEPATH_")]
    if not chosen and (options or not _is_of_run(folder, python)):
        folder = folder / "pip"
    if chosen and any(folder.glob("python/wavepath/_core*.so")):
        return folder
    if folder.name == "pip" or not (folder / "build.ninja").exists():
        _run("cmake", "-S", ROOT, "-B", folder, "-G", "Ninja", "-DWAVEPATH_PYTHON=ON", "-DWAVEPATH_TESTS=OFF",
             "-DWAVEPATH_VIEWER=OFF", f"-DPython3_EXECUTABLE={python}", *options)
    _run("cmake", "--build", folder, "--target", "wavepath_python", "wavepath_pictures")
    return folder


class _Wheel:
    """A zip archive that notes what goes into it."""

    def __init__(self, path, info):
        self._zip = zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED)
        self._info, self._record = info, []

    def add(self, name, content, mode=0o644):
        entry = zipfile.ZipInfo(name, STAMP)
        entry.external_attr = mode << 16
        entry.compress_type = zipfile.ZIP_DEFLATED
        self._zip.writestr(entry, content)
        digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
        self._record.append(f"{name},sha256={digest},{len(content)}")

    def close(self, metadata, scripts, tag):
        self.add(f"{self._info}/METADATA", metadata.encode())
        self.add(f"{self._info}/entry_points.txt", scripts.encode())
        self.add(f"{self._info}/WHEEL",
                 f"Wheel-Version: 1.0\nGenerator: wavepath\nRoot-Is-Purelib: false\nTag: {tag}\n".encode())
        self.add(f"{self._info}/licenses/LICENSE", (ROOT / "LICENSE").read_bytes())
        record = f"{self._info}/RECORD"
        self._zip.writestr(zipfile.ZipInfo(record, STAMP), "\n".join([*self._record, f"{record},,", ""]))
        self._zip.close()


def _pack(directory, fill):
    name, version, metadata, scripts = _project()
    file = f"{name}-{version}-{_tag()}.whl"
    wheel = _Wheel(pathlib.Path(directory) / file, f"{name}-{version}.dist-info")
    fill(wheel)
    wheel.close(metadata, scripts, _tag())
    return file


def get_requires_for_build_wheel(config_settings=None):
    return []


get_requires_for_build_sdist = get_requires_for_build_editable = get_requires_for_build_wheel


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    folder = _build(config_settings)
    stage = folder / "wheel"
    if stage.exists():
        import shutil
        shutil.rmtree(stage)
    _run("cmake", "--install", folder, "--component", "python", "--prefix", stage, "--strip")

    def fill(wheel):
        for path in sorted((stage / "wavepath").iterdir()):
            wheel.add(f"wavepath/{path.name}", path.read_bytes(), 0o755 if ".so" in path.name else 0o644)

    return _pack(wheel_directory, fill)


def build_editable(wheel_directory, config_settings=None, metadata_directory=None):
    """The build folder holds links to the sources: a path file is all that is installed."""
    folder = _build(config_settings)
    line = f"{(folder / 'python').resolve()}\n".encode()
    return _pack(wheel_directory, lambda wheel: wheel.add("wavepath.pth", line))


def build_sdist(sdist_directory, config_settings=None):
    """What git knows."""
    name, version, metadata, _ = _project()
    base = f"{name}-{version}"
    files = subprocess.run(["git", "-C", ROOT, "ls-files", "-z"], check=True, capture_output=True).stdout
    with tarfile.open(pathlib.Path(sdist_directory) / f"{base}.tar.gz", "w:gz", format=tarfile.PAX_FORMAT) as archive:
        for file in files.decode().split("\0"):
            if file and (ROOT / file).is_file():
                archive.add(ROOT / file, f"{base}/{file}", recursive=False)
        entry = tarfile.TarInfo(f"{base}/PKG-INFO")
        entry.size = len(metadata.encode())
        archive.addfile(entry, io.BytesIO(metadata.encode()))
    return f"{base}.tar.gz"
