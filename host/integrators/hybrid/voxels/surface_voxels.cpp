#include "host/integrators/hybrid/voxels/surface_voxels.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "host/base/error.h"
#include "kernels/base/frame_types.h"
#include "kernels/hybrid/voxels/voxel_mip.spv.h"
#include "kernels/hybrid/voxels/voxelize.spv.h"

namespace wavepath {
namespace {

using enum BindingKind;

enum VoxelBuffer : std::size_t { kLevels, kWords, kItems };
const std::vector<BufferRule> kVoxelRules = {
    {"levels", nullptr, {{gpu::kBindSurfaceLevels, texels_rgba32ui}}},
    {"voxels", nullptr, {{gpu::kBindSurfaceVoxels, texels_r32ui}, {gpu::kBindSurfaceVoxelWords, storage}}},
    {"items", nullptr, {{gpu::kBindSurfaceItems, texels_rgba32ui}}}};

enum VoxelKernel : std::size_t { kVoxelize, kMip, kVoxelKernelCount };
const std::array<KernelCode, kVoxelKernelCount> kVoxelKernels = {
    {{kVoxelStage, wavepath_voxelize_spv}, {kVoxelStage, wavepath_voxel_mip_spv}}};
constexpr std::array<std::size_t, kVoxelKernelCount> kVoxelOrder = {kVoxelize, kMip};

constexpr std::uint64_t kVoxelsOfDispatch = 1 << 18; // some milliseconds on two cores

std::vector<Binding> voxel_program_layout() {
  std::vector<Binding> layout = workspace_layout();
  add_layout(kVoxelRules, layout);
  return layout;
}

// Those of `all` that cones read. No kernel that reads them writes them, so that texels stand for themselves.
void add_what_cones_read(const std::vector<Binding>& all, std::vector<Binding>& bindings) {
  for (Binding binding : all) {
    if (binding.slot != gpu::kBindSurfaceLevels && binding.slot != gpu::kBindSurfaceVoxels) continue;
    binding.words = gpu::kNone;
    bindings.push_back(binding);
  }
}

} // namespace

const KernelProgram kVoxelProgram = {kVoxelKernels, kVoxelOrder, voxel_program_layout};

void add_voxel_layout(std::vector<Binding>& layout) {
  std::vector<Binding> all;
  add_layout(kVoxelRules, all);
  add_what_cones_read(all, layout);
}

SurfaceVoxels::SurfaceVoxels(Workspace& workspace, KernelCompiler& kernels, const KernelConfig& config,
                             std::uint32_t across)
    : workspace_(workspace),
      kernels_(kernels),
      need_(whole_need(kVoxelProgram, config)),
      grid_(make_surface_grid(workspace.scene, across)),
      buffers_(workspace.device, kVoxelRules) {
  Device& device = workspace.device;
  const DeviceInfo& info = device.info();
  constexpr std::uint64_t kWord = sizeof(std::uint32_t);
  const std::uint64_t most = std::min(
      {info.max_storage_range / kWord, info.max_allocation / kWord, info.memory_bytes / kWord, info.max_texels(kWord)});
  if (grid_.words > most)
    throw Error(
        info.name,
        fmt::format("cannot hold {} voxels along the longest side of this scene, {:.0f} MiB; at most {:.0f} MiB",
                    across, static_cast<double>(grid_.words * kWord) / 1048576.0,
                    static_cast<double>(most * kWord) / 1048576.0),
        "use a smaller --voxels");
  kernels.start(need_);
  const auto table = grid_.table();
  buffers_[kLevels] = upload(device, std::vector<glm::uvec4>(table.begin(), table.end()));
  buffers_[kWords] = Buffer(device, grid_.words * kWord);
  buffers_[kWords].fill_zero();
  buffers_[kItems] = Buffer(device, kVoxelItems * sizeof(glm::uvec4));
}

void SurfaceVoxels::add_bindings(std::vector<Binding>& bindings) const {
  std::vector<Binding> all;
  buffers_.add_bindings(all);
  add_what_cones_read(all, bindings);
}

void SurfaceVoxels::build(WaveQueue& queue) {
  if (is_built_) return;
  is_built_ = true;
  std::vector<Binding> bindings = workspace_.bindings(workspace_.film.bands().front()); // kernels read no film
  buffers_.add_bindings(bindings);
  set_ = std::make_unique<BindingSet>(workspace_.device, bindings, static_cast<std::uint32_t>(sizeof(gpu::Wave)));
  for_each_voxel_work(workspace_.scene, grid_, [&](const std::vector<glm::uvec4>& items) {
    gpu::Wave wave{};
    wave.pixel_count = static_cast<std::uint32_t>(items.size());
    const auto record = [&](Commands& commands) {
      commands.write(buffers_[kItems], items.data(), items.size() * sizeof(glm::uvec4));
      commands.bind(*set_);
      commands.dispatch(kernels_.best(need_)[kVoxelize], groups_for(wave.pixel_count), &wave);
    };
    queue.submit(record, {.stage = kVoxelStage});
  });
  for (std::uint32_t level = 1; level < grid_.levels.size(); ++level) {
    const glm::u64vec3 size(grid_.levels[level]);
    const std::uint64_t voxels = size.x * size.y * size.z;
    for (std::uint64_t first = 0; first < voxels; first += kVoxelsOfDispatch) {
      gpu::Wave wave{};
      wave.first_pixel = static_cast<std::uint32_t>(first);
      wave.pixel_count = static_cast<std::uint32_t>(std::min(kVoxelsOfDispatch, voxels - first));
      wave.sample_count = level;
      const auto record = [&](Commands& commands) {
        commands.bind(*set_);
        commands.dispatch(kernels_.best(need_)[kMip], groups_for(wave.pixel_count), &wave);
      };
      queue.submit(record, {.stage = kVoxelStage});
    }
  }
}

} // namespace wavepath
