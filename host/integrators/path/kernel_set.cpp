#include "host/integrators/path/kernel_set.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <future>
#include <optional>
#include <thread>

#include "host/gpu/commands.h"
#include "kernels/path/accumulate.spv.h"
#include "kernels/path/advance.spv.h"
#include "kernels/path/connect.spv.h"
#include "kernels/path/extend.spv.h"
#include "kernels/path/generate.spv.h"
#include "kernels/features.h"
#include "kernels/frame_types.h"
#include "kernels/path/shade.spv.h"

namespace wavepath {
namespace {

struct StageCode {
  const char* name;
  std::span<const std::uint32_t> spirv;
};
const std::array<StageCode, kStageCount> kStages = {{{"generate", wavepath_generate_spv},
                                                     {"advance", wavepath_advance_spv},
                                                     {"extend", wavepath_extend_spv},
                                                     {"shade", wavepath_shade_spv},
                                                     {"connect", wavepath_connect_spv},
                                                     {"accumulate", wavepath_accumulate_spv}}};

// The slowest to compile goes first: shade takes as long as all others together.
constexpr std::array<Stage, kStageCount> kCompileOrder = {kShade, kExtend, kConnect, kGenerate, kAccumulate, kAdvance};

constexpr std::uint64_t kStandInBytes = 1024; // of the buffer that stands for all while nothing is read

// A hybrid frame begins and ends with kernels of its own.
bool is_left_out(Stage stage, const KernelConfig& config) {
  return config.features & gpu::kFeatureSharedFirstHit && (stage == kGenerate || stage == kAccumulate);
}

void run_without_work(Device& device, const Kernel& kernel, const BindingSet& bindings) {
  const gpu::Wave wave{};
  Commands commands(device);
  commands.bind(bindings);
  commands.dispatch(kernel, 0, &wave);
  commands.submit_and_wait();
}

} // namespace

const char* stage_name(Stage stage) { return kStages[stage].name; }

bool KernelConfig::covers(const KernelConfig& need) const {
  KernelConfig reduced = *this;
  reduced.features = need.features;
  reduced.stack_size = need.stack_size;
  return reduced == need && (features & need.features) == need.features && stack_size >= need.stack_size;
}

std::array<std::uint32_t, gpu::kSpecCount> specialization(const KernelConfig& config, const DeviceInfo& device) {
  const std::uint32_t stack = device.type == "cpu" ? gpu::kStackRegisters : gpu::kStackArray;
  return {config.features, config.stack_size, config.sampler, config.direct, config.hemisphere, config.filter, stack};
}

KernelSet::KernelSet(Device& device, const KernelConfig& config, std::vector<Binding> bindings) : config_(config) {
  const auto start = std::chrono::steady_clock::now();
  const Buffer stand_in(device, kStandInBytes);
  for (Binding& binding : bindings) binding.buffer = &stand_in;
  const BindingSet set(device, bindings, static_cast<std::uint32_t>(sizeof(gpu::Wave)));
  const auto constants = specialization(config, device.info());
  std::atomic<std::size_t> next = 0;
  const auto compile = [&] {
    for (std::size_t i; (i = next++) < kStageCount;) {
      const Stage stage = kCompileOrder[i];
      if (is_left_out(stage, config)) continue;
      const Kernel& kernel = kernels_[stage].emplace(device, kStages[stage].name, kStages[stage].spirv, set, constants);
      run_without_work(device, kernel, set);
    }
  };
  // No more threads than cores: the first kernel would have to share its own, and it decides when all are ready.
  std::vector<std::future<void>> threads;
  for (std::size_t t = 0; t < std::clamp<std::size_t>(std::thread::hardware_concurrency(), 1, kStageCount); ++t)
    threads.push_back(std::async(std::launch::async, compile));
  for (std::future<void>& thread : threads) thread.get();
  seconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

} // namespace wavepath
