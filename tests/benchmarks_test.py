#!/usr/bin/env python3
"""The benchmark scripts' own arithmetic, on numbers with known answers, and that they start at all. No renderer is run.
Usage: benchmarks_test.py SOURCE_DIR"""

import array
import json
import math
import os
import pathlib
import struct
import subprocess
import sys
import tempfile
import unittest

BENCHMARKS = pathlib.Path(sys.argv[1]) / "benchmarks"
sys.path.insert(0, str(BENCHMARKS))

import contact_sheet  # noqa: E402
import error_time  # noqa: E402
import exr  # noqa: E402
import generated_scenes  # noqa: E402
import history  # noqa: E402
import light_table  # noqa: E402
import material_study  # noqa: E402
import old_new  # noqa: E402
import peer_cycles  # noqa: E402
import regret  # noqa: E402
import sample_assets  # noqa: E402
import scaling  # noqa: E402

# relMSE = 0.2 / seconds: what independent samples give.
HALVING = [{"seconds": 2.0**i, "relmse": 0.2 / 2.0**i, "spp": 2**i} for i in range(6)]


class Benchmarks(unittest.TestCase):
    def test_sample_assets_tells_what_a_copy_lacks(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "a.gltf"
            document = {"buffers": [{"uri": "a%20b.bin"}, {"uri": "data:,x"}], "animations": [{}, {}]}
            file.write_text(json.dumps(document))
            self.assertEqual(sample_assets.missing_files(file), ["a%20b.bin"])
            (file.parent / "a b.bin").write_bytes(b"version https://git-lfs.github.com/spec/v1\n")
            self.assertEqual(sample_assets.missing_files(file), ["a%20b.bin"])
            (file.parent / "a b.bin").write_bytes(b"x")
            self.assertEqual(sample_assets.missing_files(file), [])
            self.assertEqual(sample_assets.animations_of(file), 2)

    def test_sample_assets_makes_a_page(self):
        page = sample_assets.table([("A", "glTF/A.gltf", "rendered", "2 variants"), ("B", "B.glb", "refused", "a|b")],
                                   "a copy")
        self.assertIn("2 files of 2 assets\n(a copy)", page)
        self.assertIn("| B | B.glb | refused | a\\|b |", page)
        self.assertIn("| rendered | 1 |", page)

    def test_slope_of_independent_samples_is_minus_one(self):
        self.assertAlmostEqual(error_time.slope(HALVING), -1)

    def test_slope_is_of_the_last_three_octaves(self):
        late = [dict(p, relmse=1 if p["spp"] < 4 else p["relmse"]) for p in HALVING]
        self.assertAlmostEqual(error_time.slope(late), -1)

    def test_slope_begins_after_a_jump(self):
        better = [dict(p, relmse=p["relmse"] * (10 if p["spp"] < 8 else 1)) for p in HALVING]
        self.assertAlmostEqual(error_time.slope(better), -1)

    def test_samples_go_by_half_octaves(self):
        spp = [1]
        while spp[-1] < 48:
            spp.append(peer_cycles.half_octave_after(spp[-1]))
        self.assertEqual(spp, [1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48])

    def test_time_to_an_error_lies_between_the_points_around_it(self):
        seconds, measured = error_time.time_to(HALVING, 1e-2)
        self.assertAlmostEqual(seconds, 20)
        self.assertTrue(measured)

    def test_time_past_the_last_point_follows_the_slope_and_says_so(self):
        seconds, measured = error_time.time_to(HALVING, 1e-3)
        self.assertAlmostEqual(seconds, 200)
        self.assertFalse(measured)

    def test_an_error_reached_at_once_takes_the_first_run(self):
        self.assertEqual(error_time.time_to(HALVING, 0.5), (1.0, True))

    def test_summary_is_ours_by_theirs(self):
        slow = [dict(p, seconds=3 * p["seconds"]) for p in HALVING]
        for points in (HALVING, slow):
            for p in points:
                p["runs"] = [{"seconds": p["seconds"]}]
        result = error_time.summarize({"size": [1, 1]}, {"wavepath": HALVING, "cycles": slow})
        self.assertAlmostEqual(result["ratio"]["0.01"], 1 / 3)
        self.assertAlmostEqual(result["equal_spp"]["seconds_ratio"], 1 / 3)
        self.assertAlmostEqual(result["equal_spp"]["relmse_ratio"], 1)

    def test_history_names_scene_size_and_flags_and_tells_what_was_extrapolated(self):
        points = [dict(p, runs=[{"seconds": p["seconds"]}]) for p in HALVING]
        scene = error_time.summarize({"size": [4, 3]}, {"wavepath": points, "cycles": points}) | {"flags": "--guide"}
        told = dict(history.figures({"size": [4, 3], "scenes": {"box": scene}}, None))
        self.assertAlmostEqual(told["peers/box/4x3 --guide/wavepath/seconds_to_0.01"], 20)
        self.assertAlmostEqual(told["peers/box/4x3 --guide/cycles/seconds_to_0.001_by_slope"], 200)
        self.assertAlmostEqual(told["peers/box/4x3 --guide/ratio/relmse_at_32_spp"], 1)

    def test_history_grows_where_a_figure_changed(self):
        rows = history.add([], [("a", 1.0), ("b", 2.0)], "c1", "d1")
        rows = history.add(rows, [("a", 1.00001), ("b", 3.0)], "c2", "d2")
        self.assertEqual([tuple(row.values()) for row in rows],
                         [("a", "c1", "d1", "1"), ("b", "c1", "d1", "2"), ("b", "c2", "d2", "3")])

    def test_history_reads_what_is_kept(self):
        results = BENCHMARKS / "results"
        for device in ("llvmpipe", "h200"):
            with self.subTest(device=device):
                rows = history.read(results / device / "history.csv")
                self.assertEqual(list(rows[0]), history.COLUMNS)
                last = {row["metric"]: row["value"] for row in rows}
                for scene, document in json.loads((results / device / "bench.json").read_text()).items():
                    for metric, value in history.figures(document, scene):
                        self.assertEqual(last[metric], f"{value:.4g}", metric)

    def test_exponent_of_a_linear_cost_is_one(self):
        self.assertAlmostEqual(scaling.exponent([{"n": n, "seconds": 0.25 * n} for n in (16, 32, 64)]), 1)

    def test_old_and_new_are_compared_by_medians_and_by_pairs(self):
        pairs = [[{key: seconds for key in ("render", "wall", "cpu")} for seconds in pair]
                 for pair in ((1, 2), (4, 4), (2, 3))]
        row = old_new.ratios(pairs)
        self.assertEqual((row["old"], row["new"], row["ratio"], row["render"]), (2, 3, 1.5, 1.5))
        self.assertEqual((row["least"], row["most"], row["fastest"]), (1, 2, 2))

    def test_the_references_own_error_is_taken_off(self):
        # Squares of independent errors add up: 4 of the picture, 1 of each reference.
        self.assertAlmostEqual(error_time.net_error([5.0, 5.0], 2.0), 4.0)

    def test_a_row_holds_error_and_seconds_over_the_first_ones(self):
        measured = {("old", 16): {"error": 0.02, "seconds": 4.0}, ("new", 16): {"error": 0.005, "seconds": 6.0}}
        old, new = light_table.rows("cornell", "sobol", measured, ["old", "new"], [16])
        self.assertEqual(old, "| cornell | sobol | 16 | old | 2.000e-02 | 4.00 |  |  |  |")
        self.assertEqual(new, "| cornell | sobol | 16 | new | 5.000e-03 | 6.00 | 0.250 | 1.50 | **0.375** |")

    def test_processor_seconds_leave_out_what_one_sample_takes_to_prepare(self):
        points = [{"spp": n, "seconds": 9.0, "runs": [{"processor": 5.0 + 0.5 * n}]} for n in (1, 2, 4, 8)]
        peer_cycles.count_processor(points)
        for p in points:
            self.assertAlmostEqual(p["seconds"], 0.5 * p["spp"] / os.cpu_count())
            self.assertEqual(p["clock_seconds"], 9.0)

    def test_cycles_is_told_of_surfaces_without_a_specular_part(self):
        view = peer_cycles.view_of("mirror", None, None, (8, 6))
        self.assertEqual(view["lambert"], ["block", "floor", "lamp"])
        self.assertEqual(peer_cycles.without_specular(peer_cycles.ROOT / "scenes/cornell_box.gltf"),
                         ["green", "light", "red", "white"])

    def test_a_ball_is_counted_alone_and_its_ratio_tells_the_seeds_difference(self):
        width, height = material_study.SIZE
        ball = material_study.inside(0, 2)  # the first column, the last row
        self.assertTrue(all(i % width < width / 4 and i // width > 2 * height / 3 for i in ball))
        self.assertAlmostEqual(len(ball), math.pi * (material_study.RADIUS * height / 3 - 1) ** 2, delta=10)
        dark = [(9.0, 9.0, 9.0)] * (width * height)
        ours, theirs = [list(dark) for _ in range(2)], [list(dark) for _ in range(2)]
        for i in ball:
            ours[0][i], ours[1][i], theirs[0][i], theirs[1][i] = (2.2,) * 3, (1.8,) * 3, (1.0,) * 3, (1.0,) * 3
        ratios, error = material_study.ratio(ours, theirs, ball)
        for r in ratios:
            self.assertAlmostEqual(r, 2.0)
        self.assertAlmostEqual(error, 0.1)

    def test_the_contact_sheet_tells_what_was_chosen_and_what_was_refused(self):
        told = "wavepath: light: --env sky, as for an interior\nwavepath: a.png (exposure -0.52): 64 spp in 1.0 s\n"
        self.assertEqual(contact_sheet.choices(told), ("sky", "-0.52"))
        self.assertEqual(contact_sheet.choices("wavepath: light: as authored, by\nwavepath: a.png (exposure +3.00): 4 "
                                               "spp"),
                         ("as authored", "+3.00"))
        self.assertEqual(contact_sheet.refusal("wavepath: warning: x\nwavepath: error: /a/b.glb: needs X; do Y\n"),
                         "needs X; do Y")
        self.assertEqual(len(set(contact_sheet.ASSETS)), 30)

    def test_generated_scenes_are_half_for_tuning_under_every_light(self):
        scenes = [generated_scenes.scene(seed)[3] for seed in (0, 7, 14, 21)]
        self.assertTrue(all(words.startswith("lamp,") for words in scenes), scenes)
        self.assertEqual([words.split(", ")[1] for words in scenes], ["open", "closed", "half", "open"])
        tuning = [seed % len(generated_scenes.LIGHTS) for seed in range(generated_scenes.COUNT)
                  if generated_scenes.is_for_tuning(seed)]
        self.assertEqual(sorted(tuning), sorted(2 * list(range(len(generated_scenes.LIGHTS)))))

    def test_generated_scenes_are_the_same_every_time(self):
        for seed in (3, 22):
            self.assertEqual(generated_scenes.scene(seed)[0].binary(), generated_scenes.scene(seed)[0].binary())

    def test_one_bright_pixel_in_a_thousand_does_not_decide_the_typical_error(self):
        reference = [1.0] * 6000
        noisy = [1.1] * 6000
        errors = regret.squared_errors(noisy, reference)
        self.assertAlmostEqual(errors["relmse"], 0.01 / 1.01)
        self.assertAlmostEqual(errors["typical"], 0.01 / 1.01, delta=1e-4)
        bright = regret.squared_errors([1000.0] * 6 + noisy[6:], reference)
        self.assertGreater(bright["relmse"], 100 * errors["relmse"])
        self.assertAlmostEqual(bright["typical"], errors["typical"], delta=1e-4)

    def test_what_comes_before_the_first_sample_counts_as_far_as_the_plainest_choice_lacks_it(self):
        run = {"relmse": 0.02, "typical": 0.01, "rendering": 1.5, "bvh": 0.5, "all": 3.0, "total": 4.0, "taken": {},
               "pilots": {"reuse_choice": {"rendering": 0.5, "all": 0.7}}}
        row = regret.summary([run], before=1.0)
        self.assertAlmostEqual(row["cost"]["rendering"], 0.02)
        self.assertAlmostEqual(row["cost"]["all"], 0.025)
        self.assertAlmostEqual(row["pilots"], 0.25)
        self.assertAlmostEqual(regret.summary([run], before=2.5)["all"], 2.0, msg="no less than rendering")

    def test_pictures_of_ours_are_read_without_another_program(self):
        attributes = (b"channels\0chlist\0" + struct.pack("<i", 73)
                      + b"".join(name + b"\0" + struct.pack("<4i", 2, 0, 1, 1) for name in (b"A", b"B", b"G", b"R")) +
                      b"\0"
                      + b"compression\0compression\0" + struct.pack("<i", 1) + b"\3"
                      + b"dataWindow\0box2i\0" + struct.pack("<5i", 16, 0, 0, 1, 0) + b"\0")
        start = 8 + len(attributes) + 8
        line = struct.pack("<8f", 1, 1, 30, 31, 20, 21, 10, 11)
        data = b"\x76\x2f\x31\x01\2\0\0\0" + attributes + struct.pack("<Q2i", start, 0, len(line)) + line
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "small.exr"
            path.write_bytes(data)
            self.assertEqual(exr.read_ours(path), (2, 1, [array.array("f", c) for c in ((10, 11), (20, 21), (30, 31))]))

    def test_scripts_explain_themselves(self):
        for script, flag in (("peer_cycles.py", "--json"), ("scaling.py", "--json"), ("old_new.py", "--json"),
                             ("regret.py", "--json"),
                             ("light_table.py", "--json"), ("material_study.py", "--strip"), ("history.py", "--device"),
                             ("shadow_reports.py", "--pages")):
            with self.subTest(script=script):
                result = subprocess.run([sys.executable, BENCHMARKS / script, "--help"], capture_output=True, text=True)
                self.assertEqual(result.returncode, 0, result.stderr)
                self.assertIn(flag, result.stdout)

    def test_manifolds_and_merging_agree_with_the_reference(self):
        try:
            import manifold_study
        except ImportError as error:
            self.skipTest(f"{error}")
        scene = manifold_study.make_scenes(4)["bulb"]
        truth, _, reach = manifold_study.reference(scene, 1 << 16)
        for method in (manifold_study.Manifold(scene, 1.02 * reach, 1000), manifold_study.Merging(scene, False)):
            _, light = manifold_study.run(method, truth, 1, [1e4, 1e5], 2)
            self.assertAlmostEqual(light, 1, delta=0.03)

    def test_scripts_that_name_their_interpreter_can_be_started(self):
        for script in [*BENCHMARKS.glob("*.*"), *(BENCHMARKS.parent / "scenes").glob("*.py")]:
            if script.read_bytes()[:2] == b"#!":
                self.assertTrue(os.access(script, os.X_OK), f"{script} is not executable")

    def test_the_other_lavapipe_wants_a_root_that_holds_a_debian(self):
        script = BENCHMARKS / "other_lavapipe.sh"
        arguments = [[], [BENCHMARKS]] if os.geteuid() == 0 else [[]]
        for given in arguments:
            with self.subTest(given=given):
                result = subprocess.run([script, *given], capture_output=True, text=True)
                self.assertEqual(result.returncode, 1)
                self.assertEqual(len(result.stderr.splitlines()), 1, result.stderr)
                self.assertRegex(result.stderr, "^other_lavapipe: error: .*; (write|name) ")

    def test_without_blender_it_says_how_to_get_it(self):
        result = subprocess.run([sys.executable, BENCHMARKS / "peer_cycles.py", "--blender", "no-such-blender"],
                                capture_output=True, text=True)
        self.assertEqual(result.returncode, 2)
        self.assertEqual(len(result.stderr.splitlines()), 1)
        self.assertIn("apt install", result.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
