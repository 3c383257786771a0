// What a render takes of memory: what is refused is what the plan lists, for the scenes and settings that use it.
#include <algorithm>

#include <gtest/gtest.h>

#include "host/base/error.h"
#include "host/integrators/bidirectional/kind.h"
#include "host/integrators/path/kind.h"
#include "host/plan/memory.h"
#include "host/render/workspace/workspace.h"

namespace wavepath::test {
namespace {

constexpr gpu::Feature kLamps = gpu::kFeaturePunctualLights;

DeviceInfo device_of(const char* type) {
  DeviceInfo info;
  info.type = type;
  info.memory_bytes = std::uint64_t{1} << 33;
  info.max_storage_range = info.max_allocation = std::uint64_t{1} << 30;
  info.max_texel_elements = 1u << 27;
  info.max_groups = 65535;
  return info;
}

RenderPlan settings_of(const IntegratorKind& kind) {
  RenderPlan settings;
  settings.integrator = &kind;
  settings.width = 256, settings.height = 192;
  return settings;
}

std::uint64_t bytes_of(const std::vector<MemoryItem>& items, std::string_view name) {
  const auto found = std::ranges::find(items, name, &MemoryItem::name);
  return found == items.end() ? 0 : found->bytes;
}

TEST(MemoryPlan, ListsWhatTheSceneAndTheSettingsUse) {
  ScenePlan plain, rich;
  rich.light_tree_bytes = rich.environment_bytes = 1000;
  rich.smooth_surfaces = true;
  const RenderPlan path = settings_of(kPath), both = settings_of(kBidirectional);
  RenderPlan guided = path, shallow = both;
  guided.guide = true;
  shallow.max_depth = 2;
  const auto once = [](const RenderPlan& settings, const ScenePlan& scene, gpu::Feature features, const char* name) {
    return bytes_of(plan_memory(settings, scene, features).render, name);
  };
  EXPECT_EQ(once(path, plain, kLamps, "guiding field"), 0u);
  EXPECT_GT(once(guided, plain, kLamps, "guiding field"), 0u);
  EXPECT_EQ(once(path, plain, kLamps, "learned lights") + once(path, plain, kLamps, "learned sky"), 0u);
  EXPECT_EQ(once(path, rich, kLamps, "learned lights"), kPath.light_training_bytes);
  EXPECT_EQ(once(path, rich, kLamps, "learned sky"), kPath.sky_training_bytes);
  EXPECT_EQ(once(both, rich, kLamps, "learned lights"), kBidirectional.light_training_bytes);
  EXPECT_EQ(once(both, rich, kLamps, "learned sky"), 0u);
  EXPECT_EQ(once(path, rich, kLamps, "film of splats"), 0u);
  EXPECT_EQ(once(both, rich, kLamps, "film of splats"), gpu::kReplicates * 256 * 192 * sizeof(gpu::SplatPixel));
  EXPECT_GT(once(both, rich, kLamps, "photons"), 0u);
  EXPECT_EQ(once(both, plain, kLamps, "photons"), 0u) << "no surface is smooth";
  EXPECT_EQ(once(both, rich, 0, "photons"), 0u) << "no light";
  EXPECT_EQ(once(both, rich, kLamps | gpu::kLobeCoat, "photons"), 0u) << "coats";
  EXPECT_EQ(once(shallow, rich, kLamps, "photons"), 0u) << "no path is long enough";
}

TEST(MemoryPlan, NamesWhatPathsTake) {
  RenderPlan path = settings_of(kPath), both = settings_of(kBidirectional);
  both.max_depth = 9;
  path.reuse = kReuseOff;
  const auto of_path = [](const RenderPlan& settings) { return plan_memory(settings, {}, kLamps).path; };
  EXPECT_EQ(bytes_of(of_path(both), "light vertices"), 8 * sizeof(gpu::LightVertex));
  EXPECT_EQ(bytes_of(of_path(path), "records for neighbours"), 0u);
  path.reuse = kReuseOn;
  EXPECT_GT(bytes_of(of_path(path), "records for neighbours"), 0u);
  for (const RenderPlan* settings : {&path, &both})
    EXPECT_EQ(total_bytes(of_path(*settings)), settings->integrator->bytes_per_slot(kLamps, *settings));
}

TEST(MemoryPlan, RefusesWhatDoesNotFit) {
  ScenePlan scene;
  scene.triangle_bytes = 1000;
  const DeviceInfo cpu = device_of("cpu");
  const RenderPlan both = settings_of(kBidirectional);
  const std::uint64_t needed = MemoryCheck("a.glb", scene, kLamps, cpu).bytes(both);
  const MemoryCheck enough("a.glb", scene, kLamps, cpu, needed), little("a.glb", scene, kLamps, cpu, needed - 1);
  EXPECT_TRUE(enough.fits(both));
  enough.require(both);
  EXPECT_FALSE(little.fits(both));
  EXPECT_THROW(little.require(both), Error);

  // On a CPU device all of the plan is in the host's memory, and what lies in both places twice.
  const MemoryPlan plan = plan_memory(both, scene, kLamps);
  std::uint64_t expected = 2 * scene.total() + choose_slots(cpu, kLamps, both) * total_bytes(plan.path);
  for (const MemoryItem& item : plan.render) expected += (item.location == MemoryLocation::both ? 2 : 1) * item.bytes;
  EXPECT_EQ(needed, expected);
  EXPECT_LT(MemoryCheck("a.glb", scene, kLamps, device_of("discrete")).bytes(both), needed / 2);
}

// What auto asks for is the candidate that it takes without a pilot; the others may take more.
TEST(MemoryPlan, TellsCandidatesOfAutoApart) {
  const DeviceInfo cpu = device_of("cpu");
  const RenderPlan path = settings_of(kPath);
  RenderPlan automatic = path, guided = path;
  automatic.integrator = IntegratorSetting::automatic();
  guided.guide = true;
  const MemoryCheck check("a.glb", {}, kLamps, cpu, MemoryCheck("a.glb", {}, kLamps, cpu).bytes(automatic));
  EXPECT_TRUE(check.fits(path));
  EXPECT_FALSE(check.fits(guided));
  EXPECT_FALSE(check.fits(settings_of(kBidirectional)));
}

} // namespace
} // namespace wavepath::test
