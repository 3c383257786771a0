#include "host/integrators/hybrid/transparency/layers.h"

#include <algorithm>

#include "kernels/hybrid/hybrid_types.h"
#include "kernels/hybrid/transparency/transparency_types.h"
#include "kernels/path/path_types.h"

namespace wavepath {
namespace {

constexpr std::uint64_t kFirstTriangles = 1 << 12;  // a guess, for the first frame
constexpr std::uint32_t kFinishedPixels = 1u << 16; // of a dispatch

std::uint64_t texel_bytes(const AttachmentInfo& attachment) {
  if (attachment.format == ImageFormat::depth32f) return sizeof(float);
  return attachment.format == ImageFormat::rg32ui ? sizeof(glm::uvec2) : sizeof(glm::vec4);
}

std::vector<Buffer> make_copies(Device& device, const LayerRecipe& recipe, std::uint64_t pixels) {
  std::vector<Buffer> copies;
  for (std::size_t i = 0; i < recipe.bindings.size(); ++i)
    copies.emplace_back(device, pixels * texel_bytes(recipe.attachments[i]));
  return copies;
}

} // namespace

std::uint64_t layer_bytes_per_pixel(const LayerRecipe& recipe) {
  std::uint64_t bytes = sizeof(glm::vec4);
  for (std::size_t i = 0; i < recipe.attachments.size(); ++i)
    bytes += texel_bytes(recipe.attachments[i]) * (i < recipe.bindings.size() ? 2 : 1); // drawn, and copied once
  return bytes;
}

Layers::Layers(Workspace& workspace, const LayerRecipe& recipe, const KernelConfig& config, const LayerFrame& frame,
               const RenderPlan& settings)
    : workspace_(workspace),
      recipe_(recipe),
      layers_(frame.layers),
      pixels_(settings.width * settings.height),
      passes_(recipe.passes(settings)),
      list_(layer_triangles(workspace.scene, recipe.holds)),
      constants_(specialization(config, workspace.device.info())),
      triangles_(workspace.device, list_.size() * sizeof(glm::uvec2)),
      unused_(workspace.device, 0),
      copies_(make_copies(workspace.device, recipe, pixels_)),
      target_(workspace.device, settings.width, settings.height, recipe.attachments),
      bindings_(workspace.device, bindings(frame), sizeof(gpu::Wave), BindingSet::kRasterStages),
      pipeline_(workspace.device, recipe.code, recipe.attachments, recipe.state, bindings_, constants_),
      triangles_a_slice_(kFirstTriangles) {
  if (!recipe.finish.spirv.empty()) finish_.emplace(workspace.device, recipe.finish, bindings_, constants_);
}

std::vector<Binding> Layers::bindings(const LayerFrame& frame) const {
  using enum BindingKind;
  std::vector<Binding> bindings = workspace_.on_device->bindings();
  bindings.insert(bindings.end(), {{gpu::kBindFrame, uniform, &workspace_.frame_buffer()},
                                   {gpu::kBindEntries, texels_r32ui, &unused_},
                                   {gpu::kBindHybrid, uniform, &frame.hybrid},
                                   {gpu::kBindGbuffer, storage, &frame.gbuffer},
                                   {gpu::kBindSeen, storage, &frame.seen},
                                   {gpu::kBindLayers, storage, &frame.layers},
                                   {gpu::kBindLayerTriangles, texels_rg32ui, &triangles_}});
  for (std::size_t i = 0; i < copies_.size(); ++i) {
    const bool ids = recipe_.attachments[i].format == ImageFormat::rg32ui;
    bindings.push_back({recipe_.bindings[i], ids ? texels_rg32ui : texels_rgba32f, &copies_[i]});
  }
  return bindings;
}

void Layers::turn_to(const gpu::CameraView& camera) {
  if (recipe_.sorts) sort_back_to_front(list_, camera);
  std::vector<glm::uvec2> placed;
  for (const LayerTriangle& triangle : list_) placed.push_back(triangle.placed);
  if (!placed.empty()) triangles_.write(placed.data(), placed.size() * sizeof(glm::uvec2));
}

void Layers::render(WaveQueue& queue) {
  const Draw all{.triangle_count = static_cast<std::uint32_t>(list_.size())};
  const std::uint64_t triangles = triangles_a_slice_.next_frame();
  for (std::uint32_t pass = 0; pass < passes_; ++pass) {
    gpu::Wave wave{};
    wave.bounce = pass;
    wave.sample_count = passes_;
    const SlicedPass drawn{
        .target = &target_, .pipeline = &pipeline_, .bindings = &bindings_, .push = &wave, .stage = "layers"};
    draw_in_slices(
        queue, drawn, {&all, 1}, triangles, [](Commands&) {},
        [&](Commands& commands) { record_finish(commands, pass); },
        [this](double seconds) { triangles_a_slice_.note(seconds); });
  }
}

void Layers::record_finish(Commands& commands, std::uint32_t pass) {
  if (!finish_) return target_.image(0).copy_to(commands.handle(), layers_);
  for (std::size_t i = 0; i < copies_.size(); ++i) target_.image(i).copy_to(commands.handle(), copies_[i]);
  commands.barrier();
  commands.bind(bindings_);
  for (std::uint32_t first = 0; first < pixels_; first += kFinishedPixels) {
    gpu::Wave wave{};
    wave.first_pixel = first;
    wave.pixel_count = std::min(kFinishedPixels, pixels_ - first);
    wave.bounce = pass;
    wave.sample_count = passes_;
    commands.dispatch(*finish_, groups_for(wave.pixel_count), &wave);
  }
}

std::uint64_t Layers::bytes() const {
  std::uint64_t bytes = target_.bytes() + triangles_.bytes();
  for (const Buffer& copy : copies_) bytes += copy.bytes();
  return bytes;
}

} // namespace wavepath
