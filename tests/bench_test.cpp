// wavepath bench: that what it replays is what the renderer traces, that its counts are right, and the command as a
// user runs it. Nothing here judges a time.
#include <algorithm>
#include <cmath>
#include <csignal>
#include <fstream>
#include <limits>

#include <glm/gtc/matrix_transform.hpp>
#include <nlohmann/json.hpp>

#include "host/base/error.h"
#include "host/bench/bench_report.h"
#include "host/bench/builtin_scene.h"
#include "host/bench/frames.h"
#include "host/bench/ray_replay.h"
#include "host/bench/work.h"
#include "host/scene/gltf/gltf.h"
#include "host/scene/staging/view.h"
#include "kernels/base/frame_types.h"
#include "kernels/base/scene_types.h"
#include "kernels/path/path_types.h"
#include "tests/probe.h"
#include "tests/run_wavepath.h"
#include "tests/scene_builder.h"
#include "tests/temporary_folder.h"

namespace wavepath::test {
namespace {

using Json = nlohmann::ordered_json;

const std::string kCornell = WAVEPATH_SOURCE_DIR "/scenes/cornell_box.gltf";

RenderPlan small_settings() {
  RenderPlan settings;
  settings.width = 48, settings.height = 32;
  settings.last_sample = 2;
  settings.max_depth = 3;
  settings.kernels.shadow_rays = true;
  return settings;
}

struct Loaded {
  PackedScene packed;
  View view;
};

Loaded load(Scene scene, const RenderPlan& settings) {
  const View view = resolve_view(scene, {}, settings.width, settings.height);
  return {pack(scene), view};
}

bvh::Vec3 to_bvh(const glm::vec3& v) { return {v.x, v.y, v.z}; }

// Of all triangles, one by one.
float nearest(const PackedScene& scene, const glm::vec3& origin, const glm::vec3& direction, float t_max) {
  const bvh::PreparedRay ray = bvh::prepare({to_bvh(origin), to_bvh(direction), t_max});
  float t = std::numeric_limits<float>::infinity();
  for (const gpu::Triangle& triangle : scene.triangles) {
    bvh::TriangleHit hit;
    if (bvh::intersect(ray, {to_bvh(triangle.v0), to_bvh(triangle.v1), to_bvh(triangle.v2)}, hit) && hit.t < t_max)
      t = std::min(t, hit.t);
  }
  return t;
}

TEST(Summary, KnowsMedianAndQuartiles) {
  EXPECT_DOUBLE_EQ(summarize({3, 1, 2}).median, 2.0);
  EXPECT_DOUBLE_EQ(summarize({4, 1, 3, 2}).median, 2.5);
  EXPECT_DOUBLE_EQ(summarize({5, 1, 2, 3, 4}).spread, 2.0 / 3.0); // quartiles 2 and 4
  EXPECT_DOUBLE_EQ(summarize({7}).spread, 0.0);
  EXPECT_DOUBLE_EQ(ratio_of_medians({1, 2, 100}, {4, 4, 4}), 0.5);
}

TEST(Roofline, IsThatOfTheScarcerOfTheTwo) {
  const Ceilings ceilings{1e9, 2e8, 10.0};
  EXPECT_DOUBLE_EQ(roofline_fraction(ceilings, 1e8, 1e9), 0.5);
  EXPECT_DOUBLE_EQ(roofline_fraction(ceilings, 1e7, 8e9), 0.8);
}

TEST(Work, CountsVisitsAndTests) {
  Scene scene = triangle_scene();
  const PackedScene packed = pack(scene);
  gpu::Ray meets{glm::vec3(-packed.origin) + glm::vec3(0.2f, 0.2f, 1.0f), 0, {0, 0, -1}, gpu::kFar};
  gpu::Ray passes = meets;
  passes.origin.x += 10.0f;
  const std::vector<gpu::Ray> rays{meets, passes, meets};
  const RayWork work = count_closest(packed, rays, 2);
  EXPECT_EQ(work.total.visits, 3u);
  EXPECT_EQ(work.total.tests, 2u);
  EXPECT_DOUBLE_EQ(work.lanes_in_use, 5.0 / 8.0); // two subgroups of two lanes, each with a visit and a test at most
  EXPECT_DOUBLE_EQ(count_closest(packed, rays, 1).lanes_in_use, 1.0);
  const std::vector<gpu::ShadowRay> shadow{{meets.origin, 0, meets.direction, gpu::kFar, {}, 0}};
  EXPECT_EQ(count_any(packed, shadow, 8).total.tests, 1u);
}

TEST(Work, CountsBothLevels) {
  Scene scene = triangle_scene();
  add_instance(scene, 0, glm::translate(glm::dmat4(1.0), glm::dvec3(0.0, 0.0, 5.0)));
  const PackedScene packed = pack(scene);
  ASSERT_TRUE(packed.root_is_top);
  const std::vector<gpu::Ray> rays{{glm::vec3(-packed.origin) + glm::vec3(0.2f, 0.2f, 9.0f), 0, {0, 0, -1}, gpu::kFar}};
  const bvh::Counters counters = count_closest(packed, rays, 8).total;
  EXPECT_EQ(counters.visits, 3u); // the top, and each of the instances: leaves of one visit wait together
  EXPECT_GE(counters.tests, 1u);
}

class Bench : public VulkanTest {
protected:
  RenderPlan settings_ = small_settings();
};

TEST_F(Bench, ReplaysTheRaysOfTheRenderer) {
  const Loaded scene = load(load_gltf(kCornell, {}), settings_);
  KernelCompiler kernels(device());
  RayReplay replay(device(), scene.packed, scene.view, settings_, kernels);
  const RaySets rays = replay.capture();
  ASSERT_EQ(rays.camera.size(), 48u * 32u);
  ASSERT_GT(rays.bounce.size(), 100u);
  ASSERT_GT(rays.shadow.size(), 100u);
  for (const auto* set : {&rays.camera, &rays.bounce}) {
    EXPECT_GT(replay.extend(*set, set == &rays.camera), 0.0);
    const std::vector<float> t = replay.distances(scene.packed, *set);
    for (std::size_t i = 0; i < set->size(); i += 7) {
      const float expected = nearest(scene.packed, (*set)[i].origin, (*set)[i].direction, (*set)[i].t_max);
      if (std::isinf(expected))
        EXPECT_TRUE(std::isinf(t[i]));
      else
        EXPECT_NEAR(t[i], expected, 1e-5f * (1.0f + expected));
    }
  }
}

TEST_F(Bench, ReplaysShadowRays) {
  const Loaded scene = load(builtin_scene(), settings_);
  KernelCompiler kernels(device());
  RayReplay replay(device(), scene.packed, scene.view, settings_, kernels);
  const RaySets rays = replay.capture();
  EXPECT_GT(replay.connect(rays.shadow), 0.0);
  const std::vector<bool> blocked = replay.blocked(rays.shadow);
  std::size_t count = 0;
  for (std::size_t i = 0; i < rays.shadow.size(); i += 17) {
    const gpu::ShadowRay& ray = rays.shadow[i];
    EXPECT_EQ(blocked[i], std::isfinite(nearest(scene.packed, ray.origin, ray.direction, ray.t_max))) << i;
    count += blocked[i];
  }
  EXPECT_GT(count, 0u);
}

TEST_F(Bench, CeilingsAreFiniteAndPositive) {
  const Ceilings ceilings = measure_ceilings(device(), 1 << 20);
  for (const double value : {ceilings.load16_per_second, ceilings.load64_per_second, ceilings.gflops}) {
    EXPECT_TRUE(std::isfinite(value));
    EXPECT_GT(value, 0.0);
  }
}

TEST_F(Bench, FramesCountWhatTheyTrace) {
  const Loaded scene = load(load_gltf(kCornell, {}), settings_);
  settings_.wave_slots = 500; // several waves a sample
  WarmLoop warm = make_loop(device(), scene.packed, scene.view, settings_);
  const RenderTime one = time_render(warm, 1), two = time_render(warm, 2);
  EXPECT_EQ(one.rays.camera, 48u * 32u);
  EXPECT_EQ(two.rays.camera, 2u * 48u * 32u);
  EXPECT_EQ(time_render(warm, 1).rays.total(), one.rays.total());
}

// What bench --ablate compiles in, one at a time.
TEST_F(Bench, LeavingOutChangesNoBit) {
  settings_.max_depth = 2;
  const Loaded scene = load(load_gltf(kCornell, {}), settings_);
  const RenderResult without = render(device(), scene.packed, scene.view, settings_);
  std::size_t compared = 0;
  std::vector<LeftOut> all{{"all lobes of layered materials", "", 0, gpu::kLobesAll}}; // together: it is one build
  for (const LeftOut& entry : scene.packed.left_out)
    if (entry.feature && !(entry.feature & gpu::kLobesAll)) all.push_back(entry);
  for (const LeftOut& entry : all) {
    SCOPED_TRACE(entry.what);
    RenderPlan variant = settings_;
    variant.kernels.added = entry.feature;
    const RenderResult with = render(device(), scene.packed, scene.view, variant);
    for (std::size_t c = 0; c < without.picture.channels.size(); ++c)
      EXPECT_EQ(with.picture.channels[c].values, without.picture.channels[c].values);
    ++compared;
  }
  EXPECT_GT(compared, 10u);
}

// By three of the features that a scene leaves out, one without code; each costs a build of all kernels.
TEST_F(Bench, AblatesWhatTheSceneLeavesOut) {
  settings_.max_depth = 2;
  Loaded scene = load(load_gltf(kCornell, {}), settings_);
  std::vector<LeftOut>& left_out = scene.packed.left_out;
  const auto code = [](const LeftOut& entry) { return entry.feature && !(entry.feature & gpu::kLobesAll); };
  const auto first = std::ranges::find_if(left_out, code), data = std::ranges::find(left_out, 0u, &LeftOut::feature);
  ASSERT_TRUE(first != left_out.end() && data != left_out.end());
  const auto second = std::find_if(first + 1, left_out.end(), code);
  ASSERT_TRUE(second != left_out.end());
  left_out = {*first, *data, *second};
  const BenchSettings asked{settings_, 1, true, false};
  std::vector<std::string> told;
  const BenchResult result =
      bench(device(), scene.packed, scene.view, asked, [&](const std::string& what) { told.push_back(what); });
  const Json rows = bench_document({kCornell, device().info(), scene.packed, asked, result}).at("ablation");
  ASSERT_EQ(rows.size(), 3u);
  const std::string names[] = {left_out[0].what, left_out[2].what, "everything (generic kernels)"};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(rows[i].at("left_out"), names[i]);
    EXPECT_EQ(std::ranges::count(told, "with " + names[i]), 1) << names[i];
    for (const char* key : {"cost_ms", "cost_bytes", "cost_compile_ms"})
      EXPECT_TRUE(rows[i].at(key).is_number()) << rows[i];
  }
}

// Glass, metals and plastics by the kernels without the code of layers, and by those with it.
TEST_F(Bench, TheLayeredBuildChangesNoBit) {
  settings_.max_depth = 5;
  const Loaded scene = load(load_gltf(WAVEPATH_SOURCE_DIR "/scenes/showcase.glb", {}), settings_);
  ASSERT_FALSE(scene.packed.features & gpu::kLobesLayered);
  RenderPlan layered = settings_;
  layered.kernels.added = gpu::kLobesLayered;
  const RenderResult without = render(device(), scene.packed, scene.view, settings_);
  const RenderResult with = render(device(), scene.packed, scene.view, layered);
  for (std::size_t c = 0; c < without.picture.channels.size(); ++c)
    EXPECT_EQ(with.picture.channels[c].values, without.picture.channels[c].values);
}

TEST(Baseline, TellsTheChange) {
  Json before{{"scene", "a"}, {"size", {4, 4}}, {"max_depth", 8}, {"device", {{"name", "d"}}}};
  for (const char* kind : {"camera", "bounce", "shadow"}) before["rays"][kind] = {{"mrays_per_second", 10.0}};
  before["path_tracing"] = {{"mrays_per_second", 4.0}};
  Json now = before;
  EXPECT_EQ(compare_with_baseline(now, before, "f").worst_percent, 0.0);
  now["rays"]["bounce"]["mrays_per_second"] = 5.0;
  now["rays"]["camera"]["mrays_per_second"] = 20.0;
  EXPECT_DOUBLE_EQ(compare_with_baseline(now, before, "f").worst_percent, 50.0);
  now["scene"] = "b";
  EXPECT_THROW(compare_with_baseline(now, before, "f"), Error);
  EXPECT_THROW(compare_with_baseline(before, Json::array(), "f"), Error);
}

class BenchCommand : public ProgramTest {
protected:
  static Outcome bench(std::vector<std::string> extra, const RunOptions& options = {}) {
    std::vector<std::string> arguments{WAVEPATH_BINARY, "bench", "--size",      "32x24",
                                       "--repetitions", "1",     "--max-depth", "2"};
    arguments.insert(arguments.end(), extra.begin(), extra.end());
    return run_program(arguments, options);
  }
  struct Run {
    Outcome outcome;
    Json document;
  };
  // Of the Cornell box, with all that has rows of its own. Once: a bench compiles all of its kernels anew.
  static const Run& whole_run() {
    static const Run run = [] {
      const TemporaryFolder folder;
      const std::string json = folder.file("bench.json");
      Run made{bench({kCornell, "--structures", "--json", json}), {}};
      EXPECT_EQ(made.outcome.exit_code, 0) << made.outcome.err;
      made.document = Json::parse(std::ifstream(json));
      return made;
    }();
    return run;
  }
  TemporaryFolder folder_;
  const std::string json_ = folder_.file("bench.json");
};

TEST_F(BenchCommand, WritesTheDocumentedKeys) {
  const auto& [outcome, json] = whole_run();
  EXPECT_EQ(json.at("scene"), kCornell);
  for (const char* key : {"build_seconds", "sah", "nodes", "bytes", "bytes_per_triangle"})
    EXPECT_TRUE(json.at("bvh").at(key).is_number()) << key;
  for (const char* kind : {"camera", "bounce", "shadow"})
    for (const char* key :
         {"mrays_per_second", "spread", "visits", "tests", "bytes", "lanes_in_use", "roofline_fraction"})
      EXPECT_TRUE(json.at("rays").at(kind).at(key).is_number()) << kind << " " << key;
  EXPECT_EQ(json.at("stages").size(), 6u);
  for (const char* key : {"mrays_per_second", "bytes_per_path"}) EXPECT_GT(json.at("path_tracing").at(key), 0.0) << key;
  for (const char* key : {"load16_per_second", "load64_per_second", "gflops"})
    EXPECT_GT(json.at("ceilings").at(key), 0.0) << key;
  EXPECT_GT(json.at("compile_ms"), 0.0);
  EXPECT_TRUE(json.at("ablation").empty());
  if (json.contains("embree")) {
    for (const char* kind : {"camera", "bounce", "shadow"})
      EXPECT_GT(json.at("embree").at(kind).at("agreement"), 0.999) << kind;
  }
  EXPECT_NE(outcome.out.find("Mrays/s"), std::string::npos);
}

// Each with its numbers; all find what the product finds, but for lights that shadow rays end at.
TEST_F(BenchCommand, TracesTheSameRaysInOtherStructures) {
  const auto& [outcome, document] = whole_run();
  const Json& rows = document.at("structures");
  ASSERT_EQ(rows.size(), 8u);
  for (const Json& row : rows) {
    EXPECT_NE(outcome.out.find(row.at("name").get<std::string>()), std::string::npos);
    EXPECT_GT(row.at("bytes"), 0);
    EXPECT_GE(row.at("items_per_triangle"), 1.0);
    EXPECT_GE(row.at("build_seconds"), 0.0);
    for (const char* kind : {"camera", "bounce", "shadow"}) {
      EXPECT_GT(row.at(kind).at("mrays_per_second"), 0.0) << row;
      EXPECT_GT(row.at(kind).at("visits"), 0.0) << row;
      EXPECT_GT(row.at(kind).at("tests"), 0.0) << row;
      EXPECT_GT(row.at(kind).at("agreement"), 0.99) << row;
    }
  }
  const Json& to_lamp = document.at("lamp_structures");
  ASSERT_EQ(to_lamp.size(), 9u);
  EXPECT_EQ(to_lamp[8].at("name"), "light buffer");
  for (const Json& row : to_lamp) {
    EXPECT_GT(row.at("shadow").at("mrays_per_second"), 0.0) << row;
    EXPECT_EQ(row.at("shadow").at("agreement"), 1.0) << row;
    EXPECT_FALSE(row.contains("camera"));
  }
  EXPECT_NE(outcome.out.find("rays to one lamp"), std::string::npos);
  EXPECT_LT(rows[1].at("camera").at("visits"), rows[0].at("camera").at("visits")) << "eight children against four";
  EXPECT_EQ(rows[0].at("name"), "BVH of wavepath");
  const Outcome both = bench({kCornell, "--kernels", "--structures"});
  EXPECT_EQ(both.exit_code, 2);
  EXPECT_NE(both.err.find("--structures"), std::string::npos) << both.err;
}

TEST_F(BenchCommand, HasASceneOfItsOwn) {
  const Outcome outcome = bench({"-q"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_EQ(outcome.err, "");
  EXPECT_NE(outcome.out.find("built-in"), std::string::npos);
  EXPECT_EQ(outcome.out.find("structure"), std::string::npos) << "unasked";
}

TEST_F(BenchCommand, JudgesAgainstABaseline) {
  Json fast = whole_run().document;
  std::ofstream(json_) << fast;
  EXPECT_EQ(bench({kCornell, "--baseline", json_, "--threshold", "100"}).exit_code, 0);
  fast["path_tracing"]["mrays_per_second"] = 1e6;
  std::ofstream(json_) << fast;
  const Outcome slower = bench({kCornell, "--baseline", json_});
  EXPECT_EQ(slower.exit_code, 1);
  EXPECT_NE(slower.out.find("slower by more than 10 %"), std::string::npos) << slower.out;
}

TEST_F(BenchCommand, RefusesWhatIsNoBaseline) {
  const Outcome missing = bench({kCornell, "--baseline", folder_.file("none.json")});
  EXPECT_EQ(missing.exit_code, 1);
  EXPECT_NE(missing.err.find("none.json: cannot be read"), std::string::npos) << missing.err;
  std::ofstream(json_) << "{";
  EXPECT_NE(bench({kCornell, "--baseline", json_}).err.find("is no JSON"), std::string::npos);
  EXPECT_NE(bench({kCornell, "--json", folder_.file("no/where.json")}).exit_code, 0);
}

// Most CPU drivers tell nothing; where one does, every kernel has its numbers. Real compilers: compiler_tables.py.
TEST_F(BenchCommand, TellsWhatTheCompilerMadeOrWhyNot) {
  const Outcome outcome = bench({kCornell, "--kernels", "--json", json_});
  if (outcome.exit_code != 0) {
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_NE(outcome.err.find("does not tell what it compiles"), std::string::npos) << outcome.err;
    EXPECT_FALSE(std::ifstream(json_).good()); // nothing is written
  } else {
    for (const Json& row : Json::parse(std::ifstream(json_)))
      EXPECT_FALSE(row.at("statistics").empty()) << row.at("kernel");
  }
  const Outcome both = bench({kCornell, "--kernels", "--baseline", json_});
  EXPECT_EQ(both.exit_code, 2);
  EXPECT_NE(both.err.find("--kernels"), std::string::npos) << both.err;
}

// What it measures then: Bench.AblatesWhatTheSceneLeavesOut. This one ends as soon as it measures the first of many.
TEST_F(BenchCommand, AblatesWhereAsked) {
  RunOptions until_asked;
  until_asked.signal_after = "measuring: with ";
  until_asked.signal = SIGKILL;
  EXPECT_EQ(bench({kCornell, "--ablate"}, until_asked).exit_code, 128 + SIGKILL);
}

} // namespace
} // namespace wavepath::test
