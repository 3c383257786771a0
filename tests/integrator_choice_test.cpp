// --integrator auto: what it takes, that it takes the same each time, and that short renders pay nothing for it.
#include <functional>
#include <memory>

#include <gtest/gtest.h>

#include "host/integrators/bidirectional/kind.h"
#include "host/integrators/path/kind.h"
#include "host/plan/integrator.h"
#include "host/render/agreement.h"
#include "host/render/pilot_picture.h"
#include "host/render/report/diagnosis.h"
#include "host/render/workspace/kernel_compiler.h"
#include "host/scene/gltf/gltf.h"
#include "host/scene/pack/pack.h"
#include "host/scene/staging/view.h"
#include "tests/vulkan_device.h"

namespace wavepath::test {
namespace {

const std::string kScenes = std::string(WAVEPATH_SOURCE_DIR) + "/scenes/";

class IntegratorChoiceTest : public VulkanTest {
protected:
  // Compiles each of them once, and waits for what is being compiled before the driver's own statics go.
  static inline std::unique_ptr<KernelCompiler> kernels_;
  static void TearDownTestSuite() { kernels_.reset(); }

  using Fits = std::function<bool(const RenderPlan&)>;
  IntegratorChoice choose(
      const std::string& file, RenderPlan settings, const ViewRequest& seen = {},
      const Fits& fits = [](const RenderPlan&) { return true; }) {
    if (!kernels_) kernels_ = std::make_unique<KernelCompiler>(device());
    Scene scene = load_gltf(kScenes + file);
    const View view = resolve_view(scene, seen, settings.width, settings.height);
    SceneOnDevice on_device;
    const PackedScene packed = pack(scene, {.eye = view.position});
    PilotRunner pilots(device(), packed, view, *kernels_, on_device);
    return choose_integrator(pilots, settings, fits);
  }
  static RenderPlan settings(std::uint32_t spp) {
    RenderPlan settings;
    settings.integrator = IntegratorSetting::automatic();
    settings.last_sample = spp;
    settings.max_depth = 5;
    return settings;
  }
};

TEST_F(IntegratorChoiceTest, TakesBidirectionalWhereALampIsBehindGlass) {
  const IntegratorChoice first = choose("caustics/bulb_point.glb", settings(64));
  ASSERT_EQ(first.trials.size(), 3u);
  EXPECT_EQ(first.settings.integrator, &kBidirectional);
  EXPECT_GT(first.trials[0].missing, 0.9); // path tracing finds next to nothing
  EXPECT_EQ(first.trials[2].missing, 0.0);
  EXPECT_NE(choice_text(first).find("auto took bidirectional --techniques hit,light,connect,splat: path lacks"),
            std::string::npos)
      << choice_text(first);
  // The same each time: by counted work, not by the clock. This one has too little memory for the second.
  const IntegratorChoice again =
      choose("caustics/bulb_point.glb", settings(64), {}, [](const RenderPlan& s) { return !s.guide; });
  EXPECT_EQ(again.settings.integrator, &kBidirectional);
  ASSERT_EQ(again.trials.size(), 2u);
  EXPECT_NE(choice_text(again).find("; there is too little memory for path --guide"), std::string::npos)
      << choice_text(again);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(first.trials[2 * i].cost, again.trials[i].cost);
    EXPECT_EQ(first.trials[2 * i].hi, again.trials[i].hi);
  }
}

TEST_F(IntegratorChoiceTest, LeavesOutWhatDoesNotFitIntoMemory) {
  const auto paths_alone = [](const RenderPlan& candidate) {
    return !candidate.guide && !candidate.integrator->splats;
  };
  const IntegratorChoice alone = choose("caustics/bulb_point.glb", settings(64), {}, paths_alone);
  EXPECT_EQ(alone.settings.integrator, &kPath);
  EXPECT_TRUE(alone.trials.empty());
  EXPECT_EQ(choice_text(alone),
            "auto took path without a trial; there is too little memory for path --guide or "
            "bidirectional --techniques hit,light,connect,splat");
}

TEST_F(IntegratorChoiceTest, TriesNothingElseWhereTheSceneIsEasy) {
  const IntegratorChoice choice = choose("cornell_box.gltf", settings(64));
  EXPECT_EQ(choice.settings.integrator, &kPath);
  EXPECT_FALSE(choice.settings.guide);
  EXPECT_EQ(choice.trials.size(), 1u);
}

// A lamp with a body, which paths meet by chance: no light is missing for sure, but more than 300 % error says enough.
TEST_F(IntegratorChoiceTest, TriesOthersEarlierWherePathTracingIsHopeless) {
  if (device().info().type != "cpu") GTEST_SKIP() << "compiling for a GPU is not worth it in a render this short";
  RenderPlan small = settings(64);
  small.width = 256, small.height = 192, small.max_depth = 8;
  const IntegratorChoice choice = choose("caustics/bulb_lamp.glb", small);
  EXPECT_EQ(choice.trials.size(), 3u);
  EXPECT_EQ(choice.settings.integrator, &kBidirectional);
}

// Between 10 and 100 % error, the others are tried where that takes a twentieth of the render, their kernels included.
TEST_F(IntegratorChoiceTest, TriesOthersWhereThatIsASmallPart) {
  if (device().info().type != "cpu") GTEST_SKIP() << "how long a GPU takes for kernels nobody has timed";
  RenderPlan small = settings(8000);
  small.width = 64, small.height = 48;
  EXPECT_EQ(choose("showcase.glb", small).trials.size(), 1u);
  small.last_sample = 16000;
  const IntegratorChoice choice = choose("showcase.glb", small);
  EXPECT_EQ(choice.trials.size(), 3u);
  EXPECT_EQ(choice.settings.integrator, &kPath);
}

// Behind the door ajar guiding takes less than half of the work of the others; 16 samples often say otherwise.
TEST_F(IntegratorChoiceTest, TriesThoseAgainThatMayBeAlike) {
  RenderPlan small = settings(4096);
  small.width = 64, small.height = 48, small.max_depth = 8;
  if (device().info().type != "cpu") small.last_sample = 1u << 22; // so long that compiling does not count
  std::size_t guided = 0;
  for (const std::uint32_t seed : {1u, 4u}) {
    small.seed = seed;
    const IntegratorChoice choice =
        choose("rooms/door_ajar.glb", small, {.eye = {{0.3, 1.6, 3.0}}, .look_at = {{3.2, 0.9, 1.8}}, .yfov = 0.9});
    ASSERT_EQ(choice.trials.size(), 3u);
    guided += choice.settings.guide;
  }
  EXPECT_EQ(guided, 2u);
}

TEST_F(IntegratorChoiceTest, TriesNothingForAShortRender) {
  RenderPlan small = settings(4);
  small.width = 64, small.height = 48;
  const IntegratorChoice choice = choose("cornell_box.gltf", small);
  EXPECT_EQ(choice.settings.integrator, &kPath);
  EXPECT_TRUE(choice.trials.empty());
  EXPECT_FALSE(choice.hidden_lamps);
  RenderPlan timed = settings(65536);
  timed.time_limit = device().info().type == "cpu" ? 1.0 : 0.01;
  EXPECT_TRUE(choose("caustics/bulb_point.glb", timed).trials.empty());
}

// A few rays on the host tell what no trial of a short render could.
TEST_F(IntegratorChoiceTest, ShortRendersTakeLightPathsWhereLampsAreHidden) {
  RenderPlan small = settings(4);
  small.width = 64, small.height = 48;
  for (const std::string file : {"caustics/bulb_point.glb", "caustics/bulb_lamp.glb", "rooms/slit_room.glb"}) {
    const IntegratorChoice choice = choose(file, small);
    EXPECT_EQ(choice.settings.integrator, &kBidirectional) << file;
    EXPECT_TRUE(choice.hidden_lamps);
    EXPECT_TRUE(choice.trials.empty());
    EXPECT_NE(choice_text(choice).find("without a trial"), std::string::npos) << choice_text(choice);
  }
  for (const std::string file : {"caustics/mirror_caustic.glb", "caustics/panes.glb", "caustics/slab_sun.glb",
                                 "rooms/hundred_lights.glb", "rooms/glazed_room.glb"}) {
    const IntegratorChoice choice = choose(file, small);
    EXPECT_EQ(choice.settings.integrator, &kPath) << file;
    EXPECT_FALSE(choice.hidden_lamps) << file;
  }
  const auto nothing_fits = [](const RenderPlan&) { return false; };
  EXPECT_EQ(choose("caustics/bulb_point.glb", small, {}, nothing_fits).settings.integrator, &kPath);
}

// Parts of a render choose alike: by the samples of the whole, not by their own.
TEST_F(IntegratorChoiceTest, PartsChooseAsTheWholeDoes) {
  RenderPlan part = settings(64);
  part.first_sample = 2, part.last_sample = 3, part.sample_total = 64;
  EXPECT_EQ(choose("caustics/bulb_point.glb", part).settings.integrator, &kBidirectional);
}

// A small picture by the kernels of a large adaptive one, on one upload, has the bits of one by its own.
TEST_F(IntegratorChoiceTest, PilotsShareKernelsAndUpload) {
  Scene scene = load_gltf(kScenes + "cornell_box.gltf");
  RenderPlan whole = settings(64);
  whole.integrator = &kPath;
  whole.width = 256, whole.height = 192;
  whole.looks_for_noise = true;
  const View view = resolve_view(scene, {}, whole.width, whole.height);
  const PackedScene packed = pack(scene, {.eye = view.position});
  const RenderPlan small = pilot_settings(whole, 64, 4);
  EXPECT_TRUE(small.kernels.has_probes);
  EXPECT_NE(small.kernels.added & gpu::kFeatureAdaptive, 0u);
  RenderPlan own = small;
  own.kernels.has_probes = false;
  own.kernels.added = 0;
  KernelCompiler kernels(device());
  SceneOnDevice shared;
  const RenderResult first = render(device(), packed, view, small, {}, kernels, &shared);
  const std::shared_ptr<const DeviceScene> uploaded = shared.scene;
  ASSERT_NE(uploaded, nullptr);
  const RenderResult second = render(device(), packed, view, own, {}, kernels, &shared);
  EXPECT_EQ(shared.scene, uploaded);
  KernelCompiler fresh(device());
  const RenderResult alone = render(device(), packed, view, own, {}, fresh);
  EXPECT_TRUE(*first.film == *alone.film);
  EXPECT_TRUE(*second.film == *alone.film);
}

// Light that is scattered once is found by every complete way; one that lacks the technique for it stands for a wrong
// one.
TEST_F(IntegratorChoiceTest, DisagreementIsFoundAfterOneBounce) {
  for (const char* file : {"analytic/point_light.gltf", "caustics/bulb_point.glb"}) {
    Scene scene = load_gltf(kScenes + file);
    RenderPlan path = settings(64);
    path.width = path.height = 16;
    path.integrator = &kPath;
    RenderPlan whole = path, wrong = path;
    whole.integrator = wrong.integrator = &kBidirectional;
    wrong.techniques = gpu::kTechniqueConnect;
    const View view = resolve_view(scene, {}, path.width, path.height);
    const PackedScene packed = pack(scene, {.eye = view.position});
    if (!kernels_) kernels_ = std::make_unique<KernelCompiler>(device());
    KernelCompiler& kernels = *kernels_;
    SceneOnDevice shared;
    EXPECT_FALSE(find_disagreement(device(), packed, view, path, whole, kernels, shared)) << file;
    if (std::string(file).starts_with("caustics")) continue; // all is behind glass there
    const auto apart = find_disagreement(device(), packed, view, path, wrong, kernels, shared);
    ASSERT_TRUE(apart) << file;
    EXPECT_LT(apart->fraction, -0.05) << file;
  }
}

// Pictures from two sides differ both ways; chance does not make them, nor does light that one of them lacks.
TEST_F(IntegratorChoiceTest, PicturesThatDifferBothWaysAreFound) {
  Scene scene = load_gltf(kScenes + "cornell_box.gltf");
  const auto film = [&](std::uint32_t seed, std::uint32_t depth, bool mirrored) {
    RenderPlan asked = settings(16);
    asked.width = asked.height = 32;
    asked.integrator = &kPath;
    asked.seed = seed;
    asked.max_depth = depth;
    View view = resolve_view(scene, {}, asked.width, asked.height);
    if (mirrored) view.right = -view.right;
    if (!kernels_) kernels_ = std::make_unique<KernelCompiler>(device());
    return render(device(), pack(scene, {.eye = view.position}), view, asked, {}, *kernels_).film;
  };
  const auto one = film(1, 4, false);
  EXPECT_FALSE(differ_both_ways(*one, *film(2, 4, false)));
  EXPECT_FALSE(differ_both_ways(*one, *film(3, 1, false)));
  EXPECT_TRUE(differ_both_ways(*one, *film(4, 4, true)));
}

TEST_F(IntegratorChoiceTest, LeavesOtherIntegratorsAlone) {
  RenderPlan path = settings(64);
  path.integrator = &kPath;
  const IntegratorChoice choice = choose("cornell_box.gltf", path);
  EXPECT_EQ(choice.settings.integrator, &kPath);
  EXPECT_TRUE(choice.trials.empty());
}

TEST(FireflyRemedy, IsWhatFindsTheirLightByDesign) {
  const auto tells = [](const std::string& words, const std::string& file, const auto& change) {
    Scene scene = load_gltf(kScenes + file);
    RenderPlan settings;
    settings.integrator = &kPath;
    change(settings);
    return firefly_remedy(settings, pack(scene, {})).find(words) != std::string::npos;
  };
  const auto unchanged = [](RenderPlan&) {};
  EXPECT_TRUE(tells("--integrator bidirectional", "caustics/mirror_caustic.glb", unchanged));
  EXPECT_TRUE(tells("--guide", "cornell_box.gltf", unchanged));
  EXPECT_TRUE(tells("--direct mis", "cornell_box.gltf", [](RenderPlan& s) { s.direct = gpu::kDirectBsdf; }));
  EXPECT_TRUE(tells("look for", "caustics/mirror_caustic.glb", [](RenderPlan& s) { s.integrator = &kBidirectional; }));
}

} // namespace
} // namespace wavepath::test
