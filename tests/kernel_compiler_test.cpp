// Kernels that were compiled ahead, for more than a scene needs, give way to the scene's own between waves; no bit
// changes.
#include <chrono>
#include <filesystem>
#include <thread>

#include "host/integrators/hybrid/kind.h"
#include "host/integrators/path/kind.h"
#include "host/integrators/path/paths.h"
#include "host/render/render.h"
#include "host/render/workspace/kernel_compiler.h"
#include "host/scene/gltf/gltf.h"
#include "host/scene/pack/pack.h"
#include "host/scene/staging/view.h"
#include "tests/probe.h"

namespace wavepath::test {
namespace {

const std::filesystem::path kScenes = std::filesystem::path(WAVEPATH_SOURCE_DIR) / "scenes";

TEST(KernelConfig, CoversWhatNeedsNoMore) {
  const KernelNeed generic{&kPathProgram, kAllPathStages, {gpu::kFeaturesAll, 64, 1, 1, 1, 1}};
  EXPECT_TRUE(generic.covers(generic));
  KernelNeed need = generic;
  need.config.features = gpu::kFeatureAlpha | gpu::kFeatureAdaptive; // which the generic one has, too
  need.config.stack_size = 10;
  need.stages = kLightingStages;
  EXPECT_TRUE(generic.covers(need));
  EXPECT_FALSE(need.covers(generic));
  need.config.stack_size = 65;
  EXPECT_FALSE(generic.covers(need));
  KernelNeed whole = generic;
  whole.config.probing = gpu::kProbingOn; // the frame says whether there are probes
  EXPECT_TRUE(whole.covers(generic));
  EXPECT_FALSE(generic.covers(whole));
  KernelNeed fewer = generic;
  fewer.stages = kLightingStages;
  EXPECT_FALSE(fewer.covers(generic));
  const KernelProgram another = kPathProgram;
  KernelNeed elsewhere = generic;
  elsewhere.program = &another;
  EXPECT_FALSE(generic.covers(elsewhere));
  KernelNeed sampled = generic; // its bindings are others
  sampled.config.features |= gpu::kFeatureSampledTextures;
  EXPECT_FALSE(sampled.covers(generic));
  EXPECT_FALSE(generic.covers(sampled));
  EXPECT_TRUE(sampled.covers(sampled));
  KernelNeed adaptive = generic; // its generate keeps samplers that the other's shade would not find
  adaptive.config.features ^= gpu::kFeatureAdaptive;
  EXPECT_FALSE(adaptive.covers(generic));
  EXPECT_FALSE(generic.covers(adaptive));
  for (std::uint32_t KernelConfig::*setting :
       {&KernelConfig::sampler, &KernelConfig::direct, &KernelConfig::hemisphere, &KernelConfig::filter,
        &KernelConfig::lens, &KernelConfig::cull, &KernelConfig::motion, &KernelConfig::terminator}) {
    KernelNeed other = generic;
    other.config.*setting += 1;
    EXPECT_FALSE(generic.covers(other));
  }
}

TEST(KernelConfig, FollowsSceneAndSettings) {
  RenderPlan settings;
  EXPECT_EQ(kernel_config(gpu::kFeatureAlpha, 5, settings),
            kernel_config(gpu::kFeatureAlpha, kExpectedStack, settings));
  EXPECT_GE(kernel_config(0, 1000, settings).stack_size, 1002u) << "a deep tree gets what it needs";
  settings.specialize = false;
  const gpu::Feature settings_alone = gpu::kFeatureAovs | gpu::kFeatureAdaptive | gpu::kFeatureSharedFirstHit |
                                      gpu::kFeatureLightCells | gpu::kFeatureGuide;
  settings.lights = gpu::kLightsTree; // without a pilot
  const gpu::Feature scenes = (gpu::kFeaturesAll | gpu::kLobeMultiple) & ~settings_alone;
  EXPECT_EQ(kernel_config(0, 5, settings).features, scenes);
  EXPECT_EQ(kernel_config(gpu::kLobeSheen, 5, settings).features, scenes | gpu::kLobesLayered);
  EXPECT_EQ(kernel_config(0, 5, settings).probing, gpu::kProbingOn);
  settings.width = settings.height = 16;
  EXPECT_EQ(kernel_config(0, 5, settings).probing, gpu::kProbingOff);
  settings.aovs = {"albedo"};
  EXPECT_EQ(kernel_config(0, 5, settings).features, scenes | gpu::kFeatureAovs);
  settings.adaptive = kAdaptiveOn;
  EXPECT_EQ(kernel_config(0, 5, settings).features, scenes | gpu::kFeatureAovs | gpu::kFeatureAdaptive);
  settings.adaptive = kAdaptiveOff;
  settings.integrator = &kHybrid; // has its AOVs from the G-buffer, and no bounce left behind panes
  EXPECT_EQ(kernel_config(0, 5, settings).features, (scenes & ~gpu::kFeaturePanes) | gpu::kFeatureSharedFirstHit);
}

class KernelCompilerTest : public VulkanTest {
protected:
  void open(const std::string& name) {
    Scene scene = load_gltf(kScenes / name);
    if (scene.lights.empty()) scene.environment.radiance = glm::vec3(1.0f);
    settings_.width = settings_.height = 24;
    settings_.last_sample = 8;
    settings_.wave_slots = 512; // many waves
    view_ = resolve_view(scene, {}, settings_.width, settings_.height);
    packed_ = pack(scene, {.direct = settings_.direct});
  }
  KernelNeed need(gpu::Feature features) const {
    return {&kPathProgram, kAllPathStages, kernel_config(features, packed_.stack_size, settings_)};
  }
  // Renders with whatever `kernels` has, and with the scene's own from the second wave on.
  Picture render_and_swap(KernelCompiler& kernels) {
    const KernelNeed own = need(packed_.features);
    bool swapped = false;
    const auto wait_for_own = [&](const Progress&) {
      while (!swapped) {
        swapped = kernels.best(own).config() == own.config;
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      }
      return true;
    };
    const Picture picture = render(device(), packed_, view_, settings_, {.progress = wait_for_own}, kernels).picture;
    EXPECT_TRUE(swapped);
    return picture;
  }
  static void expect_same_bits(const Picture& a, const Picture& b) {
    ASSERT_EQ(a.channels.size(), b.channels.size());
    for (std::size_t c = 0; c < a.channels.size(); ++c) EXPECT_EQ(a.channels[c].values, b.channels[c].values);
  }

  RenderPlan settings_;
  PackedScene packed_;
  View view_;
};

TEST_F(KernelCompilerTest, BeginningWithGenericKernelsChangesNoBit) {
  for (const char* name : {"cornell_box.gltf", "furnace_glass.gltf", "showcase.glb"}) {
    SCOPED_TRACE(name);
    open(name);
    const Picture own = render(device(), packed_, view_, settings_).picture;
    KernelCompiler kernels(device());
    const KernelNeed generic = need(gpu::kFeaturesAll);
    kernels.start(generic);
    EXPECT_EQ(kernels.best(generic).config(), generic.config);
    expect_same_bits(render_and_swap(kernels), own);
  }
}

TEST_F(KernelCompilerTest, AWrongGuessChangesNoBit) {
  open("cornell_box.gltf");
  const Picture own = render(device(), packed_, view_, settings_).picture;
  KernelCompiler kernels(device());
  kernels.start(need(gpu::kFeatureTextures)); // lacks emission, for one
  expect_same_bits(render_and_swap(kernels), own);
}

TEST_F(KernelCompilerTest, IsDestroyedWhileCompiling) {
  open("cornell_box.gltf");
  for (int i = 0; i < 3; ++i) {
    KernelCompiler kernels(device());
    kernels.start(need(packed_.features));
  }
}

} // namespace
} // namespace wavepath::test
