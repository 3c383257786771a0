#include "host/integrators/hybrid/bounce/lit_voxels.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "host/base/error.h"
#include "kernels/base/frame_types.h"
#include "kernels/hybrid/bounce/bounce_types.h"
#include "kernels/hybrid/bounce/voxel_light.spv.h"
#include "kernels/hybrid/bounce/voxel_light_mip.spv.h"
#include "kernels/hybrid/bounce/voxel_light_query.spv.h"
#include "kernels/hybrid/bounce/voxel_owner.spv.h"

namespace wavepath {
namespace {

using enum BindingKind;

enum LightBuffer : std::size_t { kNormals, kFronts, kBacks, kAxes, kItems, kPlaces };
const std::vector<BufferRule> kLightRules = {{"normals", nullptr, {{gpu::kBindVoxelNormals, storage}}},
                                             {"light of fronts", nullptr, {{gpu::kBindVoxelFronts, storage}}},
                                             {"light of backs", nullptr, {{gpu::kBindVoxelBacks, storage}}},
                                             {"light along axes", nullptr, {{gpu::kBindVoxelAxes, storage}}},
                                             {"items", nullptr, {{gpu::kBindSurfaceItems, texels_rgba32ui}}},
                                             {"places", nullptr, {{gpu::kBindVoxelPlaces, texels_rg32ui}}}};

// Bindings of the first buffers, which cones look up.
constexpr std::array<std::uint32_t, 4> kLookedUp = {gpu::kBindVoxelNormals, gpu::kBindVoxelFronts, gpu::kBindVoxelBacks,
                                                    gpu::kBindVoxelAxes};

enum LightKernel : std::size_t { kOwner, kLightUp, kMip, kLightKernelCount };
const std::array<KernelCode, kLightKernelCount> kLightKernels = {
    {{kVoxelLightStage, wavepath_voxel_owner_spv},
     {kVoxelLightStage, wavepath_voxel_light_spv, {}, wavepath_voxel_light_query_spv},
     {kVoxelLightStage, wavepath_voxel_light_mip_spv}}};
constexpr std::array<std::size_t, kLightKernelCount> kLightOrder = {kLightUp, kOwner, kMip};

// Voxels of a dispatch. Most are empty, but a wall may fill a dispatch with surfaces, each of which sends
// kVoxelLightSamples rays.
constexpr std::uint64_t kVoxelsLit = 1 << 15, kVoxelsJoined = 1 << 16;

std::vector<Binding> voxel_light_program_layout() {
  std::vector<Binding> layout = workspace_layout();
  add_voxel_layout(layout);
  add_layout(kLightRules, layout);
  return layout;
}

std::uint64_t count_of(const glm::uvec4& level) { return std::uint64_t{level.x} * level.y * level.z; }

constexpr std::uint64_t kWord = sizeof(std::uint32_t);

std::uint64_t side_bytes(const SurfaceGrid& grid) { return kWord * count_of(grid.levels.front()); }

std::uint64_t axis_bytes(const SurfaceGrid& grid) {
  std::uint64_t voxels = 0;
  for (std::size_t level = 1; level < grid.levels.size(); ++level) voxels += count_of(grid.levels[level]);
  return std::max<std::uint64_t>(voxels, 1) * gpu::kVoxelAxisWords * kWord;
}

} // namespace

const KernelProgram kVoxelLightProgram = {kLightKernels, kLightOrder, voxel_light_program_layout};

void add_voxel_light_layout(std::vector<Binding>& layout) {
  add_voxel_layout(layout);
  for (const std::uint32_t slot : kLookedUp) layout.push_back({slot, storage, nullptr});
}

std::uint64_t most_voxel_light_bytes(std::uint32_t across) {
  std::uint64_t words = 0;
  for (std::uint64_t side = across, level = 0;; side = (side + 1) / 2, ++level) {
    words += (level == 0 ? kAxes : std::uint64_t{gpu::kVoxelAxisWords}) * side * side * side; // a word in each buffer
    if (side == 1) return words * kWord;
  }
}

LitVoxels::LitVoxels(Workspace& workspace, KernelCompiler& kernels, const KernelConfig& config,
                     const SurfaceVoxels& voxels)
    : workspace_(workspace),
      kernels_(kernels),
      need_(whole_need(kVoxelLightProgram, config)),
      voxels_(voxels),
      buffers_(workspace.device, kLightRules) {
  const DeviceInfo& info = workspace.device.info();
  const std::uint64_t sides = side_bytes(voxels.grid()), axes = axis_bytes(voxels.grid());
  const std::uint64_t most = std::min({info.max_storage_range, info.max_allocation, info.memory_bytes});
  if (std::max(sides, axes) > most)
    throw Error(
        info.name,
        fmt::format("cannot hold the light of {} voxels, {:.0f} MiB in one buffer; at most {:.0f} MiB",
                    count_of(voxels.grid().levels.front()), static_cast<double>(std::max(sides, axes)) / 1048576.0,
                    static_cast<double>(most) / 1048576.0),
        "use a smaller --voxels");
  kernels.start(need_);
  for (const std::size_t of_sides : {kNormals, kFronts, kBacks}) buffers_[of_sides] = Buffer(workspace.device, sides);
  buffers_[kNormals].fill_zero(); // nobody's
  buffers_[kAxes] = Buffer(workspace.device, axes);
  buffers_[kItems] = Buffer(workspace.device, kVoxelItems * sizeof(glm::uvec4));
  std::vector<glm::uvec2> places;
  for_each_voxel_work(workspace.scene, voxels.grid(), [&](const std::vector<glm::uvec4>& items) {
    for (const glm::uvec4& item : items) places.emplace_back(item);
  });
  if (places.empty()) places.emplace_back(gpu::kNone);
  buffers_[kPlaces] = upload(workspace.device, places);
}

void LitVoxels::add_bindings(std::vector<Binding>& bindings) const {
  voxels_.add_bindings(bindings);
  for (std::size_t i = 0; i < kLookedUp.size(); ++i) bindings.push_back({kLookedUp[i], storage, &buffers_[i]});
}

void LitVoxels::build(WaveQueue& queue) {
  if (is_built_) return;
  is_built_ = true;
  std::vector<Binding> bindings = workspace_.bindings(workspace_.film.bands().front()); // kernels read no film
  voxels_.add_bindings(bindings);
  buffers_.add_bindings(bindings);
  set_ = std::make_unique<BindingSet>(workspace_.device, bindings, static_cast<std::uint32_t>(sizeof(gpu::Wave)));
  std::uint32_t first = 0;
  for_each_voxel_work(workspace_.scene, voxels_.grid(), [&](const std::vector<glm::uvec4>& items) {
    gpu::Wave wave{};
    wave.first_pixel = first;
    wave.pixel_count = static_cast<std::uint32_t>(items.size());
    first += wave.pixel_count;
    const auto record = [&](Commands& commands) {
      commands.write(buffers_[kItems], items.data(), items.size() * sizeof(glm::uvec4));
      commands.bind(*set_);
      commands.dispatch(kernels_.best(need_)[kOwner], groups_for(wave.pixel_count), &wave);
    };
    queue.submit(record, {.stage = kVoxelLightStage});
  });
  submit_voxels(queue, kLightUp, 0, kVoxelsLit);
  for (std::uint32_t level = 1; level < voxels_.grid().levels.size(); ++level)
    submit_voxels(queue, kMip, level, kVoxelsJoined);
}

void LitVoxels::submit_voxels(WaveQueue& queue, std::size_t kernel, std::uint32_t level, std::uint64_t most) {
  const std::uint64_t voxels = count_of(voxels_.grid().levels[level]);
  for (std::uint64_t first = 0; first < voxels; first += most) {
    gpu::Wave wave{};
    wave.first_pixel = static_cast<std::uint32_t>(first);
    wave.pixel_count = static_cast<std::uint32_t>(std::min(most, voxels - first));
    wave.sample_count = level;
    const auto record = [&](Commands& commands) {
      commands.bind(*set_);
      commands.dispatch(kernels_.best(need_)[kernel], groups_for(wave.pixel_count), &wave);
    };
    queue.submit(record, {.stage = kVoxelLightStage});
  }
}

} // namespace wavepath
