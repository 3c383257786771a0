"""What tests of the Python module share: the scenes, and the program to compare with."""

import os
import pathlib
import subprocess
import sys

import numpy as np
import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCENES = ROOT / "scenes"
CORNELL = str(SCENES / "cornell_box.gltf")
PROGRAM = os.environ.get("WAVEPATH_BINARY", str(ROOT / "build" / "host" / "wavepath"))


def run_program(*words, **options):
    return subprocess.run([PROGRAM, *map(str, words)], check=True, capture_output=True, text=True, **options)


def run_python(text, **options):
    """A Python of its own, for what would harm this one."""
    return subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, timeout=120, **options)


def same_bits(a, b):
    """Equal as bits: NaN equals itself, and -0 is not 0."""
    return a.shape == b.shape and np.array_equal(a.view(np.uint32), b.view(np.uint32))


@pytest.fixture(scope="session")
def device():
    import wavepath

    usable = [info for info in wavepath.devices() if not info.missing]
    if not usable:
        if os.environ.get("WAVEPATH_REQUIRE_VULKAN", "0") not in ("", "0"):
            pytest.fail("WAVEPATH_REQUIRE_VULKAN is set, but there is no Vulkan device")
        pytest.skip("no Vulkan device")
    return wavepath.Device(os.environ.get("WAVEPATH_DEVICE", ""))


@pytest.fixture()
def cornell(device):
    import wavepath

    return wavepath.Scene(CORNELL, device=device, size=(48, 48), spp=4)
