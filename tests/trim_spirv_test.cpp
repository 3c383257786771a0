// SPIR-V without what specialization constants leave unreachable: it computes the same, and it is less.
#include "host/gpu/trim_spirv.h"

#include <algorithm>

#include "host/render/workspace/kernel_set.h"
#include "kernels/base/scene_types.h"
#include "kernels/path/shade.spv.h"
#include "tests/probe.h"

#include "tests/probes/trim_probe.spv.h"

namespace wavepath::test {
namespace {

using Words = std::vector<std::uint32_t>;

constexpr std::uint32_t kOpFunction = 54, kOpLabel = 248;

std::size_t count(std::span<const std::uint32_t> spirv, std::uint32_t op) {
  std::size_t found = 0;
  for (std::size_t at = 5; at < spirv.size(); at += std::max(spirv[at] >> 16, 1u)) found += (spirv[at] & 0xffffu) == op;
  return found;
}

class TrimSpirvTest : public VulkanTest {};

// Loops that are left early, cases that run on into the next, returns from within: pipelines are made of what is left,
// under the validation layer, and tell what the same code tells that nothing is known of.
TEST_F(TrimSpirvTest, WhatIsLeftComputesTheSame) {
  constexpr std::uint32_t kCount = 16;
  std::size_t least = SIZE_MAX, most = 0;
  for (std::uint32_t i = 0; i < 24; ++i) {
    const Words constants{i % 3, i / 3 % 4, 3 + i / 12};
    SCOPED_TRACE(testing::PrintToString(constants));
    std::vector<ProbeBuffer> buffers{to_probe(constants), to_probe(std::vector<glm::uvec2>(kCount))};
    run_probe(device(), wavepath_trim_probe_spv, kCount, buffers, constants);
    for (const glm::uvec2 result : from_probe<glm::uvec2>(buffers[1])) EXPECT_EQ(result.x, result.y);
    const Words trimmed = trim_spirv(wavepath_trim_probe_spv, constants);
    EXPECT_EQ(trim_spirv(trimmed, constants), trimmed); // nothing is left to find
    least = std::min(least, count(trimmed, kOpLabel));
    most = std::max(most, count(trimmed, kOpLabel));
  }
  EXPECT_LT(most, count(wavepath_trim_probe_spv, kOpLabel));
  EXPECT_LT(least, most);
}

TEST_F(TrimSpirvTest, FunctionsThatNothingCallsAreGone) {
  // C is not 4, so that nothing returns early.
  const Words trimmed = trim_spirv(wavepath_trim_probe_spv, Words{1, 1, 3});
  EXPECT_EQ(count(trimmed, kOpFunction), count(wavepath_trim_probe_spv, kOpFunction) - 1);
}

// A kernel's conditions have to be constants before anything is inlined: functions of features would hide them.
TEST_F(TrimSpirvTest, KernelsKeepWhatTheSceneNeeds) {
  KernelConfig config;
  config.features = gpu::kFeatureEmission | gpu::kFeatureTriangleLights;
  config.stack_size = 64;
  const auto constants = specialization(config, device().info());
  const Words trimmed = trim_spirv(wavepath_shade_spv, constants);
  EXPECT_LT(trimmed.size(), std::size(wavepath_shade_spv) / 2);
  EXPECT_LT(count(trimmed, kOpFunction), count(wavepath_shade_spv, kOpFunction) * 2 / 3);
}

// Their bindings need not be there: kernels without textures have none of images.
TEST_F(TrimSpirvTest, ResourcesThatNothingReadsAreGone) {
  struct Resources {
    std::size_t declared = 0, atlases = 0, other_listed = 0; // the last: by the entry point, besides those declared
  };
  const auto resources = [](std::span<const std::uint32_t> spirv) {
    Resources found;
    for (std::size_t at = 5; at < spirv.size(); at += spirv[at] >> 16) {
      constexpr std::uint32_t kOpEntryPoint = 15, kOpVariable = 59, kOpDecorate = 71, kBinding = 33;
      const std::uint32_t op = spirv[at] & 0xffffu;
      found.declared += op == kOpVariable && spirv[at + 3] == 0;
      found.atlases += op == kOpDecorate && spirv[at + 2] == kBinding && spirv[at + 3] - gpu::kBindAtlases < 2;
      if (op == kOpEntryPoint) found.other_listed = (spirv[at] >> 16) - 5; // behind "main"
    }
    found.other_listed -= found.declared;
    return found;
  };
  const auto trimmed = [&](gpu::Feature features) {
    KernelConfig config;
    config.features = features;
    config.stack_size = 64;
    return resources(trim_spirv(wavepath_shade_spv, specialization(config, device().info())));
  };
  constexpr gpu::Feature kTextured = gpu::kFeatureTextures | gpu::kFeatureBaseColorTextures | gpu::kFeatureSpecular;
  const Resources whole = resources(wavepath_shade_spv), without = trimmed(gpu::kFeatureEmission),
                  exact = trimmed(kTextured), sampled = trimmed(kTextured | gpu::kFeatureSampledTextures);
  EXPECT_EQ(whole.atlases, 2u);
  EXPECT_EQ(without.atlases, 0u);
  EXPECT_EQ(exact.atlases, 0u);
  EXPECT_EQ(sampled.atlases, 2u);
  EXPECT_LT(without.declared, exact.declared);
  EXPECT_LT(exact.declared, whole.declared);
  for (const Resources& some : {without, exact, sampled}) EXPECT_EQ(some.other_listed, whole.other_listed);
}

// What a kernel does is the same under all constants that it does not read.
TEST_F(TrimSpirvTest, ConstantsThatNothingReadsDoNotCount) {
  constexpr std::uint32_t kOpSpecConstantTrue = 48, kOpSpecConstantFalse = 49, kOpSpecConstant = 50;
  const auto shade = [&](const KernelConfig& config) {
    Words does = what_spirv_does(wavepath_shade_spv, specialization(config, device().info()));
    for (const std::uint32_t op : {kOpSpecConstantTrue, kOpSpecConstantFalse, kOpSpecConstant})
      EXPECT_EQ(count(does, op), 0u);
    return does;
  };
  KernelConfig config;
  config.features = gpu::kFeatureEmission | gpu::kFeatureTriangleLights;
  config.stack_size = 64;
  KernelConfig lens = config, sampler = config; // of rays of the camera; of all
  lens.lens = gpu::kLensDisc;
  sampler.sampler = gpu::kSamplerSobol;
  ASSERT_NE(config.sampler, sampler.sampler);
  const Words does = shade(config);
  EXPECT_TRUE(shade(lens) == does);
  EXPECT_FALSE(shade(sampler) == does);
}

// Where a device keeps pipelines, and where it does not.
TEST_F(TrimSpirvTest, KernelsOfTheSameCodeShareAPipeline) {
  const std::vector<Binding> bindings{{0, BindingKind::storage}, {1, BindingKind::storage}};
  const auto handles = [&](Device& device) {
    const BindingLayout layout(device, bindings, 4), again(device, bindings, 4), pushes_more(device, bindings, 8);
    const Words constants{1, 1, 3}, others{1, 2, 3};
    const Kernel one(device, "one", wavepath_trim_probe_spv, layout, constants),
        same(device, "same", wavepath_trim_probe_spv, again, constants),
        other(device, "other", wavepath_trim_probe_spv, layout, others),
        otherwise(device, "otherwise", wavepath_trim_probe_spv, pushes_more, constants);
    return std::vector{one.handle(), same.handle(), other.handle(), otherwise.handle()};
  };
  const auto kept = handles(device());
  EXPECT_EQ(kept[0], kept[1]);
  EXPECT_NE(kept[0], kept[2]);
  EXPECT_NE(kept[0], kept[3]);
  EXPECT_EQ(handles(device()), kept);
  Device forgetful(device().info().name);
  const auto own = handles(forgetful);
  EXPECT_NE(own[0], own[1]);
}

TEST_F(TrimSpirvTest, WhatIsNoModuleComesBack) {
  const Words whole(std::begin(wavepath_trim_probe_spv), std::end(wavepath_trim_probe_spv));
  Words cut(whole.begin(), whole.end() - 3), endless = whole;
  endless[5] &= 0xffffu; // an instruction of no length
  for (const Words& words : {Words{}, Words{1, 2, 3}, cut, endless}) EXPECT_EQ(trim_spirv(words, {}), words);
}

} // namespace
} // namespace wavepath::test
