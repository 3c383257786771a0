#!/usr/bin/env python3
"""Ground truth for training: views of a room with clean and noisy colour, depth, normals, ids, motion and cameras.

    ./run python examples/python/dataset.py SCENE FOLDER [VIEWS]

Writes FOLDER/00000.npz, ... and FOLDER/grid.png with twelve of them."""

import pathlib
import sys
import time

import numpy as np
import wavepath

WIDTH, HEIGHT, FOV = 160, 120, 60.0


def look_at(eye, target):
    """World from camera, axes as in OpenGL."""
    z = (eye - target) / np.linalg.norm(eye - target)
    x = np.cross([0.0, 1.0, 0.0], z)
    x /= np.linalg.norm(x)
    pose = np.eye(4)
    pose[:3] = np.stack([x, np.cross(z, x), z, eye], axis=1)
    return pose


def main(file, folder, count):
    folder.mkdir(parents=True, exist_ok=True)
    focal = HEIGHT / 2 / np.tan(np.radians(FOV / 2))
    k = np.array([[focal, 0, WIDTH / 2], [0, focal, HEIGHT / 2], [0, 0, 1]])
    scene = wavepath.Scene(file, size=(WIDTH, HEIGHT), integrator="path", max_depth=3)
    low, high = scene.bounds
    middle, reach = (low + high) / 2, (high - low) * [0.18, 0.05, 0.18]
    turns = np.linspace(0, 2 * np.pi, count, endpoint=False)
    eyes = [middle + reach * [np.cos(a), np.sin(3 * a), np.sin(a)] for a in turns]
    poses = [look_at(eye, eye + [np.cos(2 * a), -0.1, np.sin(2 * a)]) for eye, a in zip(eyes, turns)]
    cameras = [wavepath.Camera.from_matrix(pose, K=k) for pose in poses]
    moving = [wavepath.Camera.from_matrix(pose, K=k) for pose in poses]
    for camera, following in zip(moving, cameras[1:] + cameras[:1]):
        camera.flags["camera_to"] = following  # where motion goes

    start, grid = time.perf_counter(), []
    noisy = (result.image for result in scene.batch(cameras, spp=1, seed=1))
    exact = scene.batch(moving, spp=4, aovs=[*wavepath.GROUND_TRUTH, "material", "motion"])
    for i, (clean, one_sample) in enumerate(zip(exact, noisy)):
        np.savez_compressed(folder / f"{i:05}.npz", colour=clean.image[..., :3], noisy=one_sample[..., :3],
                            depth=clean.aov["depth0"], normal=clean.aov["normal0"], node=clean.aov["node"],
                            material=clean.aov["material"],
                            motion=clean.aov["motion"], K=k, world_from_camera=poses[i])
        if i % max(1, count // 12) == 0 and len(grid) < 12:
            colours = np.random.default_rng(0).random((256, 3))[(31 * clean.aov["node"] + clean.aov["material"]) % 256]
            colour = clean.image[..., :3] * (0.2 / max(clean.image[..., :3].mean(), 1e-6))
            shown = [np.clip(colour, 0, 1) ** 0.45, clean.aov["normal0"] / 2 + 0.5, colours]
            grid.append(np.concatenate(shown))
    seconds = time.perf_counter() - start
    print(f"{count} views in {seconds:.1f} s, {count / seconds:.1f} a second")
    import matplotlib.image
    matplotlib.image.imsave(folder / "grid.png", np.clip(np.concatenate(grid, axis=1), 0, 1))


if __name__ == "__main__":
    main(sys.argv[1], pathlib.Path(sys.argv[2]), int(sys.argv[3]) if len(sys.argv) > 3 else 200)
