"""What the module does to the process that it lives in: nothing. Threads, fork, signals, streams, memory."""

import gc
import os
import re
import signal
import threading
import time

import numpy as np
import pytest
import wavepath
from conftest import CORNELL, run_python, same_bits

pytestmark = pytest.mark.usefixtures("device")


def in_threads(*functions):
    failures = []

    def run(function):
        try:
            function()
        except BaseException as failure:
            failures.append(failure)

    threads = [threading.Thread(target=run, args=(function,)) for function in functions]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(120)
        assert not thread.is_alive()
    assert not failures, failures


def test_threads_share_a_scene_and_a_device(device, cornell):
    other = wavepath.Scene(CORNELL, device=device, size=(32, 32), spp=2)
    expected, of_other = cornell.render().image, other.render().image
    pictures = {}

    def repeat(name, scene):
        pictures[name] = [scene.render().image for _ in range(5)]

    in_threads(lambda: repeat(0, cornell), lambda: repeat(1, cornell), lambda: repeat(2, other))
    assert all(same_bits(picture, expected) for name in (0, 1) for picture in pictures[name])
    assert all(same_bits(picture, of_other) for picture in pictures[2])


def test_two_devices_render_beside_each_other():
    scenes = [wavepath.Scene(CORNELL, size=(32, 32), spp=4) for _ in range(2)]
    expected = scenes[0].render().image
    pictures = [None, None]

    def repeat(which):
        for _ in range(4):
            pictures[which] = scenes[which].render().image

    in_threads(lambda: repeat(0), lambda: repeat(1))
    assert same_bits(pictures[0], expected) and same_bits(pictures[1], expected)


def test_other_threads_run_meanwhile(cornell):
    counted = 0
    done = threading.Event()

    def count():
        nonlocal counted
        while not done.is_set():
            counted += 1
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    cornell.render(spp=60000, time=0.5)
    done.set()
    thread.join()
    assert counted > 50


def test_scenes_are_released_while_others_render(device, cornell):
    job = cornell.start(spp=60000, time=1.0)
    for _ in range(3):
        wavepath.Scene(CORNELL, device=device)  # dropped at once
        gc.collect()
    job.cancel()


FORK = """
import os, sys, wavepath
wavepath.render({scene!r}, spp=1, size=(8, 8))
child = os.fork()
if child == 0:
    try:
        wavepath.render({scene!r}, spp=1, size=(8, 8))
    except wavepath.Error as error:
        os._exit(3 if "forked" in str(error) and "spawn" in error.remedy else 4)
    os._exit(5)
print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
"""

FORK_WITH_SCENE = """
import gc, os, wavepath
scene = wavepath.Scene({scene!r}, spp=1, size=(8, 8))
scene.render()
child = os.fork()
if child == 0:
    try:
        scene.materials[0].roughness = 0.5
    except wavepath.Error:
        del scene
        gc.collect()
        os._exit(3)
    os._exit(4)
print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
scene.render()
"""

FORK_FIRST = """
import os, wavepath
child = os.fork()
if child == 0:
    os._exit(3 if wavepath.render({scene!r}, spp=1, size=(8, 8)).spp == 1 else 4)
print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
"""


@pytest.mark.parametrize("text", [FORK, FORK_WITH_SCENE, FORK_FIRST], ids=["render", "scene", "first"])
def test_fork(text):
    done = run_python(text.format(scene=CORNELL))
    assert (done.stdout.strip(), done.stderr) == ("3", "")


INTERRUPT = """
import os, signal, threading, wavepath
scene = wavepath.Scene({scene!r}, size=(64, 64))
before = signal.getsignal(signal.SIGINT)
threading.Timer(1.0, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
try:
    {call}
except wavepath.Interrupted as interrupted:
    assert isinstance(interrupted, KeyboardInterrupt)
    result = interrupted.result
    assert {check}
    assert signal.getsignal(signal.SIGINT) is before
    print(scene.render(spp=1, size=(8, 8)).spp)
"""


@pytest.mark.parametrize("call, check", [
    ("scene.render(spp=60000)", "result.stop == 'interrupted' and 0 < result.spp < 60000 and result.image.any()"),
    (f"wavepath.render({CORNELL!r}, spp=60000, size=(64, 64))", "result.image.shape == (64, 64, 4)"),
    ("scene.start(spp=60000).result()", "result.spp > 0"),
])
def test_ctrl_c_raises_interrupted_with_the_picture_so_far(call, check):
    done = run_python(INTERRUPT.format(scene=CORNELL, call=call, check=check))
    assert (done.stdout.strip(), done.stderr) == ("1", "")


LEFT_RUNNING = """
import wavepath
scene = wavepath.Scene({scene!r}, size=(64, 64))
job = scene.start(spp=60000)
pictures = scene.batch([None] * 3, spp=20000)
while job.progress is None:
    pass
raise SystemExit(5)
"""


def test_a_program_can_end_while_it_renders():
    done = run_python(LEFT_RUNNING.format(scene=CORNELL))
    assert (done.returncode, done.stdout, done.stderr) == (5, "", "")


QUIET = """
import os, signal, threading, wavepath
known = dict((s, signal.getsignal(s)) for s in (signal.SIGINT, signal.SIGTERM, signal.SIGPIPE, signal.SIGXFSZ))
cores = os.sched_getaffinity(0)
scene = wavepath.Scene({scene!r}, size=(64, 64), spp=64)
scene.render()
wavepath.info({scene!r})
assert known == dict((s, signal.getsignal(s)) for s in known)
kept = [os.sched_getaffinity(int(task)) == cores for task in os.listdir("/proc/self/task")]
assert all(kept) and len(kept) > 1, kept
names = [open(f"/proc/self/task/{{task}}/comm").read() for task in os.listdir("/proc/self/task")]
assert not any(name.startswith("worker") for name in names)
"""


def test_prints_nothing_and_leaves_signals_and_threads_alone():
    done = run_python(QUIET.format(scene=CORNELL))
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


def resident_kib():
    return int(re.search(r"VmRSS:\s+(\d+)", open("/proc/self/status").read()).group(1))


def test_many_renders_in_constant_memory(device):
    count = int(os.environ.get("WAVEPATH_MANY_RENDERS", "300"))
    scene = wavepath.Scene(CORNELL, device=device, size=(16, 16), spp=1)
    cameras = [wavepath.Camera(eye=(0.001 * i, 1, 2.5), look_at=(0, 1, 0)) for i in range(100)]
    for result in scene.batch(cameras):
        result.image
    gc.collect()
    before = resident_kib()
    for i in range(count):
        scene.materials[0].roughness = 0.5 + 0.4 * (i % 2)
        scene.render(cameras[i % 100]).image
    gc.collect()
    assert resident_kib() - before < 1024


def test_many_scenes_in_constant_memory(device):
    def once():
        wavepath.Scene(CORNELL, device=device, size=(16, 16), spp=1).render()

    for _ in range(10):
        once()
    gc.collect()
    before = resident_kib()
    for _ in range(40):
        once()
    gc.collect()
    assert resident_kib() - before < 4096


def test_errors_can_be_sent_to_other_processes():
    import pickle

    error = pickle.loads(pickle.dumps(wavepath.Error("a.glb", "is broken", "mend it")))
    assert (error.file, error.problem, error.remedy) == ("a.glb", "is broken", "mend it")


def test_a_signal_that_python_handles_does_not_end_a_render(cornell):
    seen = []
    before = signal.signal(signal.SIGUSR1, lambda *_: seen.append(1))
    try:
        threading.Timer(0.2, lambda: os.kill(os.getpid(), signal.SIGUSR1)).start()
        result = cornell.render(spp=60000, time=0.6)
    finally:
        signal.signal(signal.SIGUSR1, before)
    assert seen == [1] and result.stop == "time" and np.isfinite(result.image).all()


def test_a_callback_cannot_ask_its_own_device_for_more(device, cornell):
    other = wavepath.Scene(CORNELL, device=device, size=(8, 8), spp=1)
    caught = []

    def ask(progress):
        try:
            other.render()
        except wavepath.Error as error:
            caught.append(str(error))
        return False

    cornell.render(spp=60000, progress=ask)
    assert "callback" in caught[0]

    def drop(progress):
        nonlocal other
        other = None
        gc.collect()
        return False

    cornell.render(spp=60000, progress=drop)
    assert cornell.render(spp=1).spp == 1
