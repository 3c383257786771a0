"""wavepath.render() gives the bits of `wavepath render`, and its checks and messages."""

import json
import subprocess

import numpy as np
import pytest
import wavepath
from conftest import CORNELL, PROGRAM, SCENES, run_program, same_bits

pytestmark = pytest.mark.usefixtures("device")

# Keywords, and the flags that say the same.
CASES = {
    "plain": (CORNELL, {"spp": 4, "size": (64, 64)}, ["--spp", "4", "--size", "64x64"]),
    "aovs": (CORNELL, {"spp": 4, "size": (48, 32), "aovs": ["albedo", "normal", "depth", "variance", "direct"]},
             ["--spp", "4", "--size", "48x32", "--aov", "albedo,normal,depth,variance,direct"]),
    "passes": (CORNELL, {"spp": 2, "size": (48, 32), "aovs": ["node", "material", "depth0", "normal0", "uv"]},
               ["--spp", "2", "--size", "48x32", "--aov", "node,material,depth0,normal0,uv"]),
    "camera": (CORNELL, {"spp": 2, "size": (40, 30), "eye": (0.1, 1.2, 3.0), "look_at": [0, 1, 0], "yfov": 38.5},
               ["--spp", "2", "--size", "40x30", "--eye", "0.1,1.2,3", "--look-at", "0,1,0", "--yfov", "38.5"]),
    "intrinsics": (CORNELL, {"spp": 2, "size": (40, 30), "intrinsics": np.array([40, 41, 19.5, 16])},
                   ["--spp", "2", "--size", "40x30", "--intrinsics", "40,41,19.5,16"]),
    "fisheye": (CORNELL, {"spp": 2, "size": (32, 32), "projection": "fisheye", "fov": 160},
                ["--spp", "2", "--size", "32x32", "--projection", "fisheye", "--fov", "160"]),
    "bidirectional": (CORNELL, {"spp": 4, "size": (32, 32), "integrator": "bidirectional", "max_depth": 4},
                      ["--spp", "4", "--size", "32x32", "--integrator", "bidirectional", "--max-depth", "4"]),
    "whitted": (CORNELL, {"spp": 2, "size": (32, 32), "integrator": "whitted"},
                ["--spp", "2", "--size", "32x32", "--integrator", "whitted"]),
    "hybrid": (CORNELL, {"spp": 2, "size": (32, 32), "integrator": "hybrid", "denoise": True},
               ["--spp", "2", "--size", "32x32", "--integrator", "hybrid", "--denoise"]),
    "denoised": (CORNELL, {"spp": 8, "size": (32, 32), "denoise": True, "specialize": False},
                 ["--spp", "8", "--size", "32x32", "--denoise", "--specialize", "off"]),
    "sampler": (CORNELL, {"samples": (2, 6), "size": (32, 32), "sampler": "stratified", "seed": 7, "filter": "box",
                          "direct": "nee"},
                ["--samples", "2:6", "--size", "32x32", "--sampler", "stratified", "--seed", "7", "--filter", "box",
                 "--direct", "nee"]),
    "crop": (CORNELL, {"spp": 2, "size": (48, 32), "crop": (8, 4, 20, 16), "clamp": 2.0},
             ["--spp", "2", "--size", "48x32", "--crop", "8,4,20,16", "--clamp", "2"]),
    "groups": (CORNELL, {"spp": 2, "size": (24, 24), "light_groups": "each", "transparent": True},
               ["--spp", "2", "--size", "24x24", "--light-groups", "each", "--transparent"]),
    "motion": (CORNELL, {"spp": 1, "size": (32, 24), "aovs": ["motion", "motion_back", "depth_min", "shadow"],
                         "camera_to": wavepath.Camera(eye=(0.1, 1, 3.0), look_at=(0, 1, 0)),
                         "camera_from": (0, 1.2, 3, 0, 1, 0), "integrator": "path"},
               ["--spp", "1", "--size", "32x24", "--aov", "motion,motion_back,depth_min,shadow", "--camera-to",
                "0.1,1,3,0,1,0", "--camera-from", "0,1.2,3,0,1,0", "--integrator", "path"]),
    "soft lamps": (CORNELL, {"spp": 2, "size": (24, 24), "sun": (30, 40), "sun_angle": 3.5},
                   ["--spp", "2", "--size", "24x24", "--sun", "30,40", "--sun-angle", "3.5"]),
    "environment": (str(SCENES / "showcase.glb"),
                    {"spp": 1, "size": (48, 27), "env": (0.4, 0.5, 0.6), "env_rotation": 90, "ground": True,
                     "aperture": 0.02, "integrator": "path"},
                    ["--spp", "1", "--size", "48x27", "--env", "0.4,0.5,0.6", "--env-rotation", "90", "--ground",
                     "--aperture", "0.02", "--integrator", "path"]),
}


@pytest.mark.parametrize("name", CASES)
def test_has_the_bits_of_the_command(name, tmp_path):
    scene, keywords, flags = CASES[name]
    ours, theirs = tmp_path / "ours.exr", tmp_path / "theirs.exr"
    result = wavepath.render(scene, **keywords)
    result.save(ours)
    run_program("render", scene, *flags, "-q", "-o", theirs)
    wanted = wavepath.read(theirs)
    assert set(result.channels) == {name for name in wanted.channels if not name.startswith("film.")}
    for channel in result.channels:
        assert same_bits(result.channel(channel), wanted.channel(channel)), channel
        assert same_bits(wavepath.read(ours).channel(channel), wanted.channel(channel)), channel


def test_shapes_and_types():
    result = wavepath.render(CORNELL, spp=2, size=(40, 24), aovs=["normal", "depth", "node", "ids"])
    assert result.image.shape == (24, 40, 4) and result.image.dtype == np.float32
    assert result.image.flags.c_contiguous and result.size == (40, 24)
    assert result.aov["normal"].shape == (24, 40, 3)
    assert result.aov["depth"].shape == (24, 40)
    assert result.aov["node"].dtype == np.int32 and result.aov["ids"].shape == (24, 40, 3)
    assert set(result.aov) == {"normal", "depth", "node", "ids", "material"}  # the material is one of the ids
    assert set(np.unique(result.aov["node"])) - {-1} <= set(result.names)
    assert result.stats["spp"] == 2 and result.spp == 2 and result.stop == "samples"
    with pytest.raises(KeyError, match="render with aovs"):
        result.aov["albedo"]
    assert np.asarray(result).shape == (24, 40, 4)


def test_arrays_outlive_the_result():
    image = wavepath.render(CORNELL, spp=1, size=(16, 16)).image
    copy = image.copy()
    wavepath.render(CORNELL, spp=1, size=(16, 16), seed=3)
    assert np.array_equal(image, copy)


def test_writes_what_the_command_writes(tmp_path):
    result = wavepath.render(CORNELL, spp=2, size=(32, 32), output=[tmp_path / "a.png", tmp_path / "a.exr"],
                             stats=tmp_path / "a.json", exposure="auto")
    run_program("render", CORNELL, "--spp", "2", "--size", "32x32", "-q", "-o", tmp_path / "b.png", "--exposure",
                "auto")
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes() == result.png(exposure="auto")
    assert json.loads((tmp_path / "a.json").read_text())["spp"] == 2
    assert wavepath.compare(tmp_path / "a.exr", result)["mse"] == 0.0
    result.save(tmp_path / "c.jpg", tonemap="agx")
    assert (tmp_path / "c.jpg").read_bytes()[:2] == b"\xff\xd8"
    html = result._repr_html_()
    assert html.startswith('<img src="data:image/jpeg;base64,') and "2 spp" in html


def test_parts_merge(tmp_path):
    whole = wavepath.render(CORNELL, spp=8, size=(32, 32), mergeable=True, integrator="path")
    for number, part in enumerate([(0, 4), (4, 8)]):
        wavepath.render(CORNELL, spp=8, samples=part, size=(32, 32), integrator="path").save(tmp_path / f"{number}.exr")
    wavepath.merge([tmp_path / "0.exr", tmp_path / "1.exr"], tmp_path / "all.exr")
    assert wavepath.compare(tmp_path / "all.exr", whole)["mse"] == 0.0


REFUSED = {
    "unknown": ({"spq": 4}, "--spq", "did you mean '--spp'?|--spp"),
    "wrong choice": ({"sampler": "sobl"}, "--sampler", "sobol"),
    "not a number": ({"spp": "many"}, "--spp", "number"),
    "negative": ({"spp": -1}, "--spp", ""),
    "NaN": ({"eye": (0, float("nan"), 0)}, "--eye", ""),
    "infinite": ({"look_at": np.array([np.inf, 0, 0])}, "--look-at", ""),
    "short list": ({"eye": (1, 2)}, "--eye", ""),
    "size": ({"size": (0, 4)}, "--size", ""),
    "nested": ({"eye": [[1, 2, 3]]}, "eye", "list"),
    "object": ({"spp": object()}, "spp", "number"),
    "true for a number": ({"spp": True}, "--spp", "value"),
    "list for a switch": ({"half": [1, 2]}, "--half", "on or off"),
    "replay": ({"pixel": (1, 1)}, "--pixel", ""),
    "film": ({"frames": "0:3"}, "--frames", ""),
    "viewer": ({"tev": "localhost"}, "--tev", "callback"),
    "files so far": ({"save_every": 1.0}, "--save-every", "callback"),
    "motion to nothing": ({"aovs": ["motion"]}, "--aov motion", "--camera-to"),
    "motion without channels": ({"camera_to": (0, 1, 3, 0, 1, 0)}, "--camera-to", "--aov motion"),
    "camera without a place": ({"camera_to": wavepath.Camera(yfov=40)}, "camera_to", "eye"),
    "biased": ({"strict": True, "denoise": True}, "--denoise", ""),
    "aov": ({"aovs": ["albdo"]}, "--aov", "albedo"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_refuses(name):
    keywords, where, remedy = REFUSED[name]
    with pytest.raises(wavepath.UsageError) as caught:
        wavepath.render(CORNELL, size=(16, 16), **{"spp": 1, **keywords}) if "size" not in keywords else \
            wavepath.render(CORNELL, spp=1, **keywords)
    error = caught.value
    assert error.file.startswith(where), error
    assert any(part in error.remedy + error.problem for part in remedy.split("|"))
    assert str(error) == f"{error.file}: {error.problem}; {error.remedy}"
    assert isinstance(error, wavepath.Error) and isinstance(error, ValueError)


def test_messages_are_those_of_the_command(tmp_path):
    for keywords, flags in [({"sampler": "sobl"}, ["--sampler", "sobl"]), ({"spp": 0}, ["--spp", "0"]),
                            ({"camera": "nowhere"}, ["--camera", "nowhere"]),
                            ({"integrator": "whitted", "guide": True}, ["--integrator", "whitted", "--guide"])]:
        with pytest.raises(wavepath.Error) as caught:
            wavepath.render(CORNELL, **keywords)
        failed = subprocess.run([PROGRAM, "render", CORNELL, *flags, "-o", str(tmp_path / "a.exr")],
                                capture_output=True, text=True, check=False)
        assert failed.stderr.splitlines()[-1] == f"wavepath: error: {caught.value}"


def test_files_that_do_not_work(tmp_path):
    with pytest.raises(wavepath.Error, match="does not exist; check the name"):
        wavepath.render(tmp_path / "none.glb")
    broken = tmp_path / "broken.gltf"
    broken.write_text("{")
    with pytest.raises(wavepath.Error) as caught:
        wavepath.render(broken)
    assert caught.value.file == str(broken)
    with pytest.raises(wavepath.Error, match="none"):
        wavepath.render(CORNELL, spp=1, size=(8, 8), output=tmp_path / "none" / "a.exr")
    result = wavepath.render(CORNELL, spp=1, size=(8, 8))
    with pytest.raises(wavepath.Error):
        result.save(tmp_path / "a.bmp")
    with pytest.raises(wavepath.UsageError, match="no channel"):
        result.channel("albedo.R")


def test_commands():
    about = wavepath.info(CORNELL)
    assert about["triangles"] > 0 and about["cameras"]
    assert any(device["name"] for device in wavepath.info()["devices"]) if isinstance(wavepath.info(), dict) \
        else wavepath.info()
    result = wavepath.render(CORNELL, spp=2, size=(16, 16))
    assert wavepath.compare(result, result.image)["relmse"] == 0.0
    assert wavepath.compare(result, result.image * 1.5)["mse"] > 0.0
    with pytest.raises(wavepath.UsageError, match="shape"):
        wavepath.compare(result, np.zeros((4, 4)))
    with pytest.raises(wavepath.Error):
        wavepath.compare(result, np.zeros((4, 4, 3), np.float32))


def test_the_module_is_the_program(tmp_path):
    import sys

    done = subprocess.run([sys.executable, "-m", "wavepath", "render", CORNELL, "--spp", "2", "--size", "16x16", "-q",
                           "-o", str(tmp_path / "a.exr")], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    assert wavepath.compare(tmp_path / "a.exr", wavepath.render(CORNELL, spp=2, size=(16, 16)))["mse"] == 0.0
    assert "PASS" in {case["verdict"] for case in wavepath.selftest(only=["empty scene"])}
