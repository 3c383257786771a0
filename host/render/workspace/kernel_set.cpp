#include "host/render/workspace/kernel_set.h"

#include <algorithm>
#include <atomic>
#include <cstring>
#include <future>
#include <thread>

#include "host/base/clock.h"
#include "host/gpu/commands.h"
#include "host/render/settings/traversal.h"
#include "host/render/workspace/device_scene.h"
#include "host/render/workspace/group_buffers.h"
#include "kernels/base/frame_types.h"
#include "kernels/film/cover_types.h"

namespace wavepath {
namespace {

constexpr std::uint64_t kDummyBytes = 1024; // size of the buffer that replaces all others while nothing is read

// lavapipe decides at a kernel's first dispatch whether to compile it again for every other value of what is uniform.
// With all bits set, loops are long and flags hold: it finds little to leave out, and does not
// (benchmarks/results/NOTES.md).
constexpr int kUniformByte = 0xff;

void run_without_work(Device& device, const Kernel& kernel, const BindingSet& bindings) {
  gpu::Wave wave;
  std::memset(&wave, kUniformByte, sizeof(wave));
  Commands commands(device);
  commands.bind(bindings);
  commands.dispatch(kernel, 0, &wave);
  commands.submit_and_wait();
}

// True if kernels with this order of rays can replace those that `needed` asks for. Lists of escaped rays that nobody
// reads do no harm.
bool sorts_for(std::uint32_t sort, std::uint32_t needed) {
  return sort >= needed && (sort == gpu::kSortNone) == (needed == gpu::kSortNone);
}

} // namespace

// Bindings are what a set of other kernels cannot do with more or fewer of.
bool KernelNeed::covers(const KernelNeed& need) const {
  if ((config.features ^ need.config.features) &
      (gpu::kFeatureSampledTextures | gpu::kFeatureLightGroups | gpu::kFeatureCover | gpu::kFeatureVoxels))
    return false;
  // Nor are stages mixed, of which some keep samplers and some look for them.
  if ((config.features ^ need.config.features) & gpu::kFeatureAdaptive) return false;
  KernelNeed reduced = *this;
  reduced.config.features = need.config.features;
  reduced.config.stack_size = need.config.stack_size;
  reduced.config.probing = need.config.probing;
  reduced.config.sort = need.config.sort;
  reduced.config.sky = need.config.sky;
  reduced.config.reuse = need.config.reuse;
  reduced.stages = need.stages;
  return reduced == need && (config.features & need.config.features) == need.config.features &&
         (stages & need.stages) == need.stages && config.stack_size >= need.config.stack_size &&
         config.probing >= need.config.probing && config.sky >= need.config.sky && config.reuse >= need.config.reuse &&
         sorts_for(config.sort, need.config.sort);
}

KernelNeed whole_need(const KernelProgram& program, const KernelConfig& config) {
  return {&program, (1u << program.stages.size()) - 1u, config};
}

// AMD's compiler (RADV) keeps arrays of up to 64 entries in registers, chosen among by chains of branches: traversal
// then takes twice as many, and half as many waves fit (benchmarks/results/compilers). More entries cost no other
// driver anything.
constexpr std::uint32_t kLeastArray = 96;

// More than a lane comes to. With 64, renders of an NVIDIA H200 took longer.
constexpr std::uint32_t kLaneRays = 256;

std::array<std::uint32_t, gpu::kSpecCount> specialization(const KernelConfig& config, const DeviceInfo& device) {
  const std::uint32_t walk = device.type == "cpu" ? gpu::kWalkInStep : gpu::kWalkByLane;
  std::array<std::uint32_t, gpu::kSpecCount> constants{};
  constants[gpu::kSpecFeatures] = static_cast<std::uint32_t>(config.features);
  constants[gpu::kSpecLobes] = static_cast<std::uint32_t>(config.features >> 32);
  constants[gpu::kSpecStackSize] =
      walk == gpu::kWalkByLane ? std::max(config.stack_size, kLeastArray) : config.stack_size;
  constants[gpu::kSpecSampler] = config.sampler;
  constants[gpu::kSpecDirect] = config.direct;
  constants[gpu::kSpecHemisphere] = config.hemisphere;
  constants[gpu::kSpecFilter] = config.filter;
  constants[gpu::kSpecWalk] = walk;
  constants[gpu::kSpecProbing] = config.probing;
  constants[gpu::kSpecLens] = config.lens;
  constants[gpu::kSpecCull] = config.cull;
  constants[gpu::kSpecMotion] = config.motion;
  constants[gpu::kSpecTerminator] = config.terminator;
  constants[gpu::kSpecSort] = config.sort;
  constants[gpu::kSpecLightSamples] = config.light_samples;
  constants[gpu::kSpecSky] = config.sky;
  constants[gpu::kSpecReuse] = config.reuse;
  constants[gpu::kSpecClamp] = config.clamp;
  constants[gpu::kSpecLaneRays] = device.ends_long_loops ? 2 : kLaneRays;
  return constants;
}

KernelSet::KernelSet(Device& device, const KernelNeed& need) : need_(need), kernels_(need.program->stages.size()) {
  const Clock::time_point start = Clock::now();
  std::vector<Binding> slots = need.program->layout();
  if (config().features & gpu::kFeatureCover)
    slots.insert(slots.end(), {{gpu::kBindFilmCover, BindingKind::storage, nullptr},
                               {gpu::kBindPathCover, BindingKind::storage, nullptr}});
  constexpr auto kPushed = static_cast<std::uint32_t>(sizeof(gpu::Wave));
  if (config().features & gpu::kFeatureLightGroups)
    for (const Binding& binding : group_layout()) slots.push_back(binding);
  if (config().features & gpu::kFeatureVoxels)
    for (const Binding& binding : volume_bindings(nullptr, nullptr, nullptr)) slots.push_back(binding);
  const std::size_t buffers = slots.size();
  const bool samples = (config().features & gpu::kFeatureSampledTextures) != 0;
  std::optional<Buffer> dummy;
  AtlasImages images;
  if (samples && device.use() == DeviceUse::run) images = upload_atlases(device, {});
  if (samples)
    for (const Binding& binding : atlas_bindings(images)) slots.push_back(binding);
  const BindingLayout layout(device, slots, kPushed);
  std::optional<BindingSet> bindings; // of what runs
  if (device.use() == DeviceUse::run) {
    dummy.emplace(device, kDummyBytes);
    const std::vector<std::uint8_t> ones(kDummyBytes, kUniformByte);
    dummy->write(ones.data(), ones.size());
    for (Binding& slot : std::span(slots).first(buffers)) slot.buffer = &*dummy;
    bindings.emplace(device, slots, kPushed);
  }
  const auto constants = specialization(need.config, device.info());
  const bool has_layers = (config().features & gpu::kLobesLayered) != 0;
  const bool by_query = traces_by_query(config().traversal, device.info());
  std::atomic<std::size_t> next = 0;
  const auto compile = [&] {
    for (std::size_t i; (i = next++) < need.program->compile_order.size();) {
      const std::size_t stage = need.program->compile_order[i];
      if (!(need.stages >> stage & 1u)) continue;
      const KernelCode& code = need.program->stages[stage];
      const std::span<const std::uint32_t> build = code.build(has_layers, by_query);
      const Kernel& kernel = kernels_[stage].emplace(device, code.name, build, layout, constants);
      if (bindings) run_without_work(device, kernel, *bindings);
    }
  };
  // No more threads than cores: the first kernel would have to share its own, and it decides when all are ready.
  std::vector<std::future<void>> threads;
  const std::size_t most = std::max<std::size_t>(kernels_.size(), 1);
  for (std::size_t t = 0; t < std::clamp<std::size_t>(std::thread::hardware_concurrency(), 1, most); ++t)
    threads.push_back(std::async(std::launch::async, compile));
  for (std::future<void>& thread : threads) thread.get();
  seconds_ = seconds_since(start);
}

} // namespace wavepath
