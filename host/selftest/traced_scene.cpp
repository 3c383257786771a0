#include "host/selftest/traced_scene.h"

#include <algorithm>
#include <iterator>

#include "host/gpu/commands.h"
#include "host/integrators/path/paths.h"
#include "host/render/workspace/kernel_compiler.h"
#include "kernels/path/connect.spv.h"
#include "kernels/path/connect_query.spv.h"
#include "kernels/path/extend.spv.h"
#include "kernels/path/extend_query.spv.h"

namespace wavepath {

std::unique_ptr<BindingSet> bind_path_tracer(Device& device, std::span<const Binding> given, const Buffer& unused) {
  std::vector<Binding> bindings = path_layout();
  for (Binding& binding : bindings) {
    const auto found = std::ranges::find(given, binding.slot, &Binding::slot);
    binding.buffer = found == given.end() ? &unused : found->buffer;
  }
  std::ranges::copy_if(given, std::back_inserter(bindings), // which only scenes with such have
                       [](const Binding& binding) { return binding.kind == BindingKind::sampled_image; });
  return std::make_unique<BindingSet>(device, bindings, static_cast<std::uint32_t>(sizeof(gpu::Wave)));
}

const Kernel& KernelCache::get(std::span<const std::uint32_t> spirv, gpu::Feature features, std::uint32_t stack_size,
                               const BindingSet& bindings) {
  KernelConfig config = kernel_config(features, stack_size, RenderPlan{});
  config.sort = gpu::kSortNone; // cases bind no room for it
  const auto key = std::tuple(spirv.data(), config.features, config.stack_size);
  if (const auto found = kernels_.find(key); found != kernels_.end()) return found->second;
  const auto constants = specialization(config, device_.info());
  return kernels_.try_emplace(key, device_, "selftest", spirv, bindings, constants).first->second;
}

TracedScene::TracedScene(Device& device, KernelCache& kernels, PackedScene packed, bool by_query)
    : device_(device),
      kernels_(kernels),
      packed_(std::move(packed)),
      scene_(upload_scene(device, packed_, by_query)),
      frame_(device, sizeof(gpu::Frame)),
      states_(device, kSlots * sizeof(gpu::PathState)),
      rays_(device, 2 * kSlots * sizeof(gpu::Ray)),
      hits_(device, kSlots * sizeof(gpu::Hit)),
      shadow_rays_(device, kSlots * sizeof(gpu::ShadowRay)),
      queues_(device, sizeof(gpu::Queues)),
      unused_(device, 0) {
  gpu::Frame frame{};
  frame.width = frame.height = frame.film_width = frame.film_height = 256;
  frame.root = packed_.root;
  frame.root_is_top = packed_.root_is_top ? 1u : 0u;
  frame.scene_features = static_cast<std::uint32_t>(packed_.features);
  frame.scene_lobes = static_cast<std::uint32_t>(packed_.features >> 32);
  frame.first_layers = static_cast<std::uint32_t>(packed_.materials.size() * gpu::kMaterialTexels);
  frame.slot_count = kSlots;
  if (scene_.queries) frame.top_level = words_of_address(scene_.queries->address());
  frame_.write(&frame, sizeof(frame));

  std::vector<Binding> given = scene_.bindings();
  using enum BindingKind;
  given.insert(given.end(), {{gpu::kBindFrame, uniform, &frame_},
                             {gpu::kBindPaths, storage, &states_},
                             {gpu::kBindPathTexels, texels_rgba32f, &states_},
                             {gpu::kBindRays, storage, &rays_},
                             {gpu::kBindRayTexels, texels_rgba32f, &rays_},
                             {gpu::kBindHits, storage, &hits_},
                             {gpu::kBindHitTexels, texels_rgba32ui, &hits_},
                             {gpu::kBindShadowRays, storage, &shadow_rays_},
                             {gpu::kBindShadowRayTexels, texels_rgba32ui, &shadow_rays_},
                             {gpu::kBindQueues, storage, &queues_}});
  bindings_ = bind_path_tracer(device, given, unused_);
}

void TracedScene::dispatch(std::span<const std::uint32_t> spirv, std::size_t count, std::uint32_t parameter) {
  gpu::Queues queues{};
  queues.ray_count[0] = queues.shadow_count[0] = static_cast<std::uint32_t>(count);
  queues_.write(&queues, sizeof(queues));
  const gpu::Wave wave{0, kSlots, 0, parameter, bounce_, 0};
  Commands commands(device_);
  commands.bind(*bindings_);
  commands.dispatch(kernels_.get(spirv, packed_.features, packed_.stack_size, *bindings_),
                    static_cast<std::uint32_t>((count + gpu::kWorkgroupSize - 1) / gpu::kWorkgroupSize), &wave);
  commands.submit_and_wait();
}

std::vector<gpu::Hit> TracedScene::run(std::span<const std::uint32_t> spirv, std::span<const gpu::Ray> rays,
                                       std::uint32_t parameter, std::uint32_t at_once) {
  std::vector<gpu::Hit> hits;
  hits.reserve(rays.size());
  for (std::size_t first = 0; first < rays.size(); first += at_once) {
    const auto chunk = rays.subspan(first, std::min<std::size_t>(at_once, rays.size() - first));
    rays_.write(chunk.data(), chunk.size_bytes());
    dispatch(spirv, chunk.size(), parameter);
    const std::vector<gpu::Hit> found = download<gpu::Hit>(hits_, chunk.size());
    hits.insert(hits.end(), found.begin(), found.end());
  }
  return hits;
}

std::vector<gpu::Hit> TracedScene::closest(std::span<const gpu::Ray> rays, std::uint32_t at_once) {
  return scene_.queries ? run(wavepath_extend_query_spv, rays, 1, at_once) : run(wavepath_extend_spv, rays, 1, at_once);
}

std::vector<bool> TracedScene::blocked(std::span<const gpu::Ray> rays) {
  std::vector<bool> blocked;
  blocked.reserve(rays.size());
  for (std::size_t first = 0; first < rays.size(); first += kSlots) {
    std::vector<gpu::ShadowRay> chunk;
    for (const gpu::Ray& ray : rays.subspan(first, std::min<std::size_t>(kSlots, rays.size() - first)))
      chunk.push_back(
          {ray.origin, static_cast<std::uint32_t>(chunk.size()), ray.direction, ray.t_max, glm::vec3(1.0f), 0});
    shadow_rays_.write(chunk.data(), chunk.size() * sizeof(gpu::ShadowRay));
    states_.fill_zero();
    if (scene_.queries)
      dispatch(wavepath_connect_query_spv, chunk.size(), 1);
    else
      dispatch(wavepath_connect_spv, chunk.size(), 1);
    for (const gpu::PathState& path : download<gpu::PathState>(states_, chunk.size()))
      blocked.push_back(path.radiance.x == 0.0f);
  }
  return blocked;
}

std::vector<gpu::Ray> TracedScene::rays_left(std::size_t count) const { return download<gpu::Ray>(rays_, count); }

} // namespace wavepath
