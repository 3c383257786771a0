"""A scene that stays on its device: many pictures, cameras, edits, jobs."""

import base64
import json

import numpy as np
import pytest
import wavepath
from conftest import CORNELL, SCENES, same_bits

pytestmark = pytest.mark.usefixtures("device")


def image_of(scene, **flags):
    return scene.render(**flags).image


def test_second_pictures_have_the_bits_of_first_ones(cornell):
    first = image_of(cornell)
    other = image_of(cornell, max_depth=1, seed=5, size=(32, 16))
    assert other.shape == (16, 32, 4)
    assert same_bits(first, image_of(cornell))
    assert same_bits(first, wavepath.render(CORNELL, size=(48, 48), spp=4).image)
    assert same_bits(other, wavepath.render(CORNELL, size=(32, 16), spp=4, max_depth=1, seed=5).image)


def test_cameras(cornell):
    whole = image_of(cornell)
    assert len(cornell.cameras) >= 1
    assert same_bits(whole, image_of(cornell, camera=cornell.cameras[0]))
    with pytest.raises(wavepath.UsageError, match="no camera of the scene"):
        cornell.cameras["kamera"]
    with pytest.raises(wavepath.UsageError, match="does not exist"):
        cornell.cameras[99]
    camera = wavepath.Camera(eye=(0, 1, 2.5), look_at=(0, 1, 0), yfov=50)
    moved = image_of(cornell, camera=camera)
    assert not np.array_equal(whole, moved)
    cornell.camera = camera
    assert same_bits(moved, image_of(cornell))


def test_motion_goes_to_the_camera_of_each_picture(cornell):
    plain = image_of(cornell)
    left, right = (wavepath.Camera(eye=(x, 1, 2.5), look_at=(x, 1, 0)) for x in (-0.2, 0.2))
    for camera, other in ((left, right), (right, left)):
        motion = cornell.render(camera, aovs=["motion"], camera_to=other).aov["motion"]
        assert motion.shape == (48, 48, 2)
        alone = wavepath.render(CORNELL, camera, size=(48, 48), spp=4, aovs=["motion"], camera_to=other)
        assert np.abs(alone.aov["motion"] - motion).max() < 0.01
        assert np.sign(motion[..., 0].mean()) == (-1 if camera is left else 1)
    assert same_bits(plain, image_of(cornell))


def test_groups_of_lights_add_up(cornell):
    result = cornell.render(light_groups="each", crop=(4, 8, 32, 16))
    assert result.image.shape == (16, 32, 4) and result.groups
    assert result.size == (32, 16) and result.place == (4, 8, 48, 48)
    assert np.allclose(sum(result.groups.values()), result.image[..., :3], rtol=1e-5, atol=1e-6)
    assert cornell.render().groups == {} and cornell.render().place == (0, 0, 48, 48)


def pose(eye, forward, up):
    z = -np.asarray(forward, float) / np.linalg.norm(forward)
    x = np.cross(up, z)
    x /= np.linalg.norm(x)
    matrix = np.eye(4)
    matrix[:3, 0], matrix[:3, 1], matrix[:3, 2], matrix[:3, 3] = x, np.cross(z, x), z, eye
    return matrix


def test_camera_of_a_matrix(cornell):
    eye, forward = np.array([0.1, 1.1, 2.5]), np.array([0.05, -0.1, -1.0])
    matrix = pose(eye, forward, (0, 1, 0))
    look_at = wavepath.Camera(eye=eye, look_at=eye + forward, yfov=40)
    focal = 24 / np.tan(np.radians(20))
    k = np.array([[focal, 0, 24], [0, focal, 24], [0, 0, 1]])
    ours = wavepath.Camera.from_matrix(matrix, K=k, size=(48, 48))
    expected, found = image_of(cornell, camera=look_at), image_of(cornell, camera=ours)
    assert np.abs(expected - found).mean() < 0.02 * expected.mean()
    flipped = matrix @ np.diag([1.0, -1.0, -1.0, 1.0])
    opencv = wavepath.Camera.from_matrix(flipped, K=k, size=(48, 48), convention="opencv")
    assert same_bits(found, image_of(cornell, camera=opencv))


@pytest.mark.parametrize("matrix, k, problem", [
    (np.full((4, 4), np.nan), None, "not finite"),
    (np.eye(3), None, "shape"),
    (np.eye(4) * 2, None, "last row"),
    (np.diag([2.0, 1, 1, 1]), None, "scales or shears"),
    (np.diag([-1.0, 1, 1, 1]), None, "mirrors"),
    (np.eye(4), np.full((3, 3), np.inf), "not finite"),
    (np.eye(4), [[1, 0.5, 0], [0, 1, 0], [0, 0, 1]], "skewed"),
    (np.eye(4), np.eye(4), "shape"),
])
def test_refuses_cameras(matrix, k, problem):
    with pytest.raises(wavepath.UsageError, match=problem):
        wavepath.Camera.from_matrix(matrix, K=k)


def test_materials(cornell):
    before = image_of(cornell)
    names = list(cornell.materials)
    material = cornell.materials[names[0]]
    was = material.base_color
    assert len(was) == 4 and 0 <= material.roughness <= 1
    material.base_color = (0.9, 0.1, 0.1, 1.0)
    material.roughness = 0.3
    assert material.base_color == pytest.approx((0.9, 0.1, 0.1, 1.0)) and material.roughness == pytest.approx(0.3)
    assert not np.array_equal(before, image_of(cornell))
    assert material.roughness == pytest.approx(0.3)
    rough = cornell.materials[names[0]]
    rough.base_color = was
    rough.roughness = 1.0
    assert cornell.update()
    assert cornell.last_update and cornell.update() == {}


def test_an_edit_that_is_taken_back_leaves_no_trace(cornell):
    before = image_of(cornell)
    material, node = cornell.materials[0], cornell.nodes[0]
    colour, matrix = material.base_color, node.matrix
    moved = matrix.copy()
    moved[0, 3] += 0.1
    with cornell.edit():
        material.base_color = (0.2, 0.3, 0.9, 1)
        node.matrix = moved
    assert np.array_equal(node.matrix, moved)
    assert not np.array_equal(before, image_of(cornell))
    with cornell.edit():
        material.base_color = colour
        node.matrix = None
    assert np.array_equal(node.matrix, matrix)
    assert same_bits(before, image_of(cornell))
    node.visible = False
    assert not node.visible and not np.array_equal(before, image_of(cornell))
    node.visible = True
    assert same_bits(before, image_of(cornell))


def spot_of(folder, **changes):
    """The scene of a spot, with other fields of its light."""
    document = json.loads((SCENES / "analytic" / "spot_light.gltf").read_text())
    light = document["extensions"]["KHR_lights_punctual"]["lights"][0]
    cones = changes.pop("spot", {})
    light.update(changes)
    light["spot"].update(cones)
    file = folder / "spot.gltf"
    file.write_text(json.dumps(document))
    return file


def test_lights_are_edited_to_the_bits_of_a_file(device, tmp_path):
    options = {"size": (24, 24), "spp": 2, "env": "black"}
    scene = wavepath.Scene(SCENES / "analytic" / "spot_light.gltf", device=device, **options)
    before = image_of(scene)
    light = scene.lights["spot"]
    assert np.allclose(light.intensity, (10, 5, 2.5)) and light.range == 0 and light.radius == 0
    assert np.allclose(np.radians(light.cones), (0.2, 0.6))
    assert light.node.index == 2 and {"intensity", "cones", "node"} <= set(dir(light))

    def file_with(**changes):
        return wavepath.render(spot_of(tmp_path, **changes), **options).image

    light.intensity *= 2
    light.range = 1.5
    assert same_bits(image_of(scene), file_with(intensity=20.0, range=1.5))
    light.range = 0
    light.cones = np.degrees((0.1, 0.3))
    scene.nodes["spot"].matrix = scene.nodes["spot"].matrix  # poses the file again, which knows of no edit
    narrow = image_of(scene)
    of_file = file_with(intensity=20.0, spot={"innerConeAngle": 0.1, "outerConeAngle": 0.3})
    assert np.allclose(narrow, of_file, rtol=1e-4)
    assert not np.array_equal(narrow, before)
    light.cones = np.degrees((0.2, 0.6))
    light.intensity = (10, 5, 2.5)
    assert np.allclose(image_of(scene), before, rtol=1e-4)
    light.radius = 0.2
    soft = wavepath.render(SCENES / "analytic" / "spot_light.gltf", lamp_radius=0.2, **options).image
    assert np.allclose(image_of(scene), soft, rtol=1e-4) and not np.allclose(soft, before, rtol=1e-3)
    scene.environment = (0.1, 0.1, 0.1)
    image_of(scene)
    assert light.radius == 0.2
    scene.nodes["spot"].visible = False
    image_of(scene)
    assert not scene.lights
    with pytest.raises(wavepath.UsageError, match="no light now"):
        light.intensity = 1
    scene.nodes["spot"].visible = True
    image_of(scene)
    assert light.radius == 0.2


def test_lights_keep_their_nodes_when_others_are_hidden(device):
    scene = wavepath.Scene(SCENES / "analytic" / "lights_of_all_sizes.gltf", device=device, size=(8, 8), spp=1)
    sun = scene.lights["directional"]
    scene.nodes["point"].visible = False
    assert np.allclose(sun.intensity, 0.01)
    sun.intensity = 3
    sun.angle = 0.5
    scene.nodes["point"].visible = True
    assert np.allclose(scene.lights["point"].intensity, 10) and scene.lights["point"].radius == 0
    assert np.allclose(scene.lights["directional"].intensity, 3) and sun.angle == pytest.approx(0.5)
    floor = SCENES / "analytic" / "point_light.gltf"
    added = wavepath.Scene(floor, device=device, size=(8, 8), spp=4, sun=(60, 40), env="black")
    assert added.lights["sun"].node is None
    added.lights["point"].intensity = 0
    before = image_of(added)[..., :3]
    added.lights["sun"].intensity *= 4
    assert before.mean() > 0 and np.allclose(image_of(added)[..., :3], 4 * before, rtol=1e-4)


def test_environments(device):
    scene = wavepath.Scene(SCENES / "showcase.glb", device=device, size=(32, 18), spp=1, integrator="path")
    scene.environment = (0.5, 0.5, 0.5)
    grey = image_of(scene)
    assert same_bits(grey, wavepath.render(SCENES / "showcase.glb", env=(0.5, 0.5, 0.5), size=(32, 18), spp=1,
                                           integrator="path").image)
    scene.environment = wavepath.Environment("sky", rotation=40, intensity=2)
    assert not np.array_equal(grey, image_of(scene))
    scene.environment = np.full((8, 16, 3), 0.5, np.float32)
    assert np.abs(image_of(scene) - grey).mean() < 0.2
    with pytest.raises(wavepath.UsageError, match="not finite"):
        scene.environment = np.full((8, 16, 3), np.nan, np.float32)
    with pytest.raises(wavepath.Error):
        scene.environment = "none.hdr"
        scene.render()


def test_added_meshes(cornell):
    before = image_of(cornell)
    low, high = cornell.bounds
    middle, reach = (low + high) / 2 * [1, 1, 0.2], 0.2 * (high - low).min()  # before the blocks
    vertices = middle + reach * np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
    faces = [[0, 2, 1], [0, 3, 2]]  # towards the camera, since it is single-sided
    material = wavepath.Material(base_color=(0, 1, 0), emission=(5, 0, 0))
    node = cornell.add_mesh("card", vertices, faces, material=material)
    result = cornell.render(aovs=["node"])
    assert (result.aov["node"] == node.index).any() and result.names[node.index] == "card"
    assert not np.array_equal(before, result.image)
    node.remove()
    assert same_bits(before, image_of(cornell))
    for bad, problem in [((vertices, [[0, 1, 4]]), "outside"), ((vertices[:, :2], faces), "shape"),
                         ((vertices, np.zeros((0, 3))), ""), ((vertices * np.nan, faces), "not finite")]:
        with pytest.raises(wavepath.UsageError, match=problem):
            cornell.add_mesh("bad", *bad)


def test_textures(cornell):
    before = image_of(cornell)
    material = cornell.materials[0]
    material.base_color_texture = np.zeros((4, 4, 3), np.uint8)
    image_of(cornell)  # meshes without coordinates show one texel, or another error: no crash
    with pytest.raises(wavepath.UsageError, match="values"):
        material.base_color_texture = np.zeros((4, 4, 5), np.uint8)
    with pytest.raises(ValueError):
        material.base_color_texture = np.zeros(4, np.uint8)
    assert before.shape == (48, 48, 4)


@pytest.mark.parametrize("change, problem", [
    (lambda scene: setattr(scene.materials[0], "roughnes", 0.5), "roughness"),
    (lambda scene: setattr(scene.materials[0], "roughness", float("nan")), "not finite"),
    (lambda scene: setattr(scene.materials[0], "roughness", 2), "cannot be"),
    (lambda scene: setattr(scene.materials[0], "base_color", (1, 2)), "4 values"),
    (lambda scene: scene.materials[0].colour, "no field"),
    (lambda scene: setattr(scene.nodes[0], "matrix", np.full((4, 4), np.nan)), ""),
    (lambda scene: setattr(scene.nodes[0], "matrix", np.zeros((4, 4))), ""),
    (lambda scene: setattr(scene.nodes[0], "matrix", np.eye(3)), "shape"),
    (lambda scene: scene.nodes["nowhere"], "no node"),
    (lambda scene: scene.lights["lamp"], "no light"),
    (lambda scene: scene.render(animation="walk"), ""),
    (lambda scene: scene.render(ground=True), "another scene"),
])
def test_refuses_edits(cornell, change, problem):
    before = image_of(cornell)
    with pytest.raises(wavepath.Error, match=problem):
        change(cornell)
    assert same_bits(before, image_of(cornell))


@pytest.mark.parametrize("field, value, problem", [
    ("intensity", (1, 2), "3 values"),
    ("intensity", -1, "negative"),
    ("intensity", float("nan"), "not finite"),
    ("range", -1, "negative"),
    ("cones", (40, 20), "not in order"),
    ("cones", (0, 100), "not in order"),
    ("radius", -1, "no such radius"),
    ("angle", 1, "spot light, which has no 'angle'"),
    ("intensty", 1, "did you mean intensity"),
])
def test_refuses_edits_of_lights(device, field, value, problem):
    scene = wavepath.Scene(SCENES / "analytic" / "spot_light.gltf", device=device, size=(16, 16), spp=1)
    before = image_of(scene)
    with pytest.raises(wavepath.Error, match=problem):
        setattr(scene.lights["spot"], field, value)
    assert same_bits(before, image_of(scene))


def test_batch(cornell):
    cameras = [wavepath.Camera(eye=(x, 1, 2.5), look_at=(0, 1, 0)) for x in (-0.2, 0.0, 0.2)]
    pictures = [result.image for result in cornell.batch(cameras, spp=2)]
    assert len(pictures) == 3
    for camera, picture in zip(cameras, pictures):
        assert same_bits(picture, image_of(cornell, camera=camera, spp=2))
    seeds = [result.stats["seed"] for result in cornell.batch(cameras, spp=1, seed="frame")]
    assert seeds == [0, 1, 2]
    early = cornell.batch(cameras * 100, spp=1)
    next(early)
    early.close()
    with pytest.raises(wavepath.Error):
        list(cornell.batch([wavepath.Camera(eye=(0, float("nan"), 0))]))


def test_progressive(cornell):
    finished = image_of(cornell, spp=64)
    pictures = list(cornell.progressive(spp=64, every=0.01))
    assert same_bits(pictures[-1].image, finished)
    assert all(a.spp <= b.spp for a, b in zip(pictures, pictures[1:]))
    spp = 0
    for count, picture in enumerate(cornell.progressive(spp=100000, every=0.05)):
        spp = picture.spp
        if count == 1:
            cornell.camera = wavepath.Camera(eye=(0, 1, 2.0), look_at=(0, 1, 0))
        if count == 3:
            break
    assert 0 < spp < 100000
    assert same_bits(image_of(cornell, camera=cornell.cameras[0], spp=64), finished)


def test_jobs(cornell):
    job = cornell.start(spp=4)
    assert same_bits(job.result(timeout=60).image, image_of(cornell)) and job.done()
    long = cornell.start(spp=60000)
    with pytest.raises(TimeoutError):
        long.result(timeout=0.05)
    long.cancel()
    assert long.done()
    wrong = cornell.start(sampler="none")
    with pytest.raises(wavepath.UsageError, match="--sampler"):
        wrong.result()


def test_progress_ends_a_render(cornell):
    seen = []

    def stop_soon(progress):
        seen.append(progress.fraction)
        return len(seen) < 3

    result = cornell.render(spp=60000, progress=stop_soon)
    assert result.stop == "interrupted" and 0 < result.spp < 60000 and seen == sorted(seen)

    def fail(progress):
        raise ZeroDivisionError("in a callback")

    with pytest.raises(ZeroDivisionError):
        cornell.render(spp=60000, progress=fail)
    assert cornell.render(spp=60000, time=0.2, progress=True).stop == "time"


def variants_file(folder):
    """A floor that is grey, or red or green by variants."""
    corners = np.array([[-1, 0, 1], [1, 0, 1], [1, 0, -1], [-1, 0, 1], [1, 0, -1], [-1, 0, -1]], np.float32)
    colors = [[0.5, 0.5, 0.5, 1], [0.8, 0.1, 0.1, 1], [0.1, 0.8, 0.1, 1]]
    mappings = [{"material": 1, "variants": [0]}, {"material": 2, "variants": [1]}]
    primitive = {"attributes": {"POSITION": 0}, "material": 0,
                 "extensions": {"KHR_materials_variants": {"mappings": mappings}}}
    document = {
        "asset": {"version": "2.0"}, "extensionsUsed": ["KHR_materials_variants"],
        "extensions": {"KHR_materials_variants": {"variants": [{"name": "red"}, {"name": "green"}]}},
        "nodes": [{"mesh": 0}], "meshes": [{"primitives": [primitive]}],
        "materials": [{"pbrMetallicRoughness": {"baseColorFactor": color, "metallicFactor": 0}} for color in colors],
        "accessors": [{"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 6}],
        "bufferViews": [{"buffer": 0, "byteLength": corners.nbytes}],
        "buffers": [{"byteLength": corners.nbytes,
                     "uri": "data:;base64," + base64.b64encode(corners.tobytes()).decode()}],
    }
    file = folder / "variants.gltf"
    file.write_text(json.dumps(document))
    return file


def test_variants_of_materials(tmp_path):
    file = variants_file(tmp_path)
    flags = dict(env="white", size=(8, 8), spp=1, max_depth=1, eye=(0, 2, 0.1), look_at=(0, 0, 0))
    scene = wavepath.Scene(file, **flags)
    assert scene.variants == ["red", "green"] and scene.variant is None
    pictures = {}
    for name in (None, "red", "green", None, "green", "red"):
        scene.variant = name
        assert scene.variant == name
        pictures.setdefault(name, image_of(scene))
        assert same_bits(pictures[name], image_of(scene))
        assert same_bits(pictures[name], wavepath.render(file, variant=name, **flags).image)
    assert not np.array_equal(pictures["red"], pictures["green"])
    assert same_bits(pictures["green"], image_of(wavepath.Scene(file, variant="green", **flags)))
    with pytest.raises(wavepath.UsageError, match="'blue', which the file does not have.*red"):
        scene.variant = "blue"
    with pytest.raises(wavepath.Error, match="has no variant 'blue'; choose one of 'red', 'green'"):
        wavepath.render(file, variant="blue", **flags)
