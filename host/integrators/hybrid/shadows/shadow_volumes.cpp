#include "host/integrators/hybrid/shadows/shadow_volumes.h"

#include <array>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/integrators/hybrid/raster/culling.h"
#include "host/integrators/hybrid/raster/slices.h"
#include "host/integrators/hybrid/shadows/look_up_technique.h"
#include "host/integrators/hybrid/shadows/times.h"
#include "host/integrators/hybrid/shadows/volume_pieces.h"
#include "kernels/hybrid/seen_depth_frag.spv.h"
#include "kernels/hybrid/seen_depth_vert.spv.h"
#include "kernels/hybrid/shadows/look_up_volume.spv.h"
#include "kernels/hybrid/shadows/volume_types.h"
#include "kernels/hybrid/volume_vert.spv.h"

namespace wavepath {
namespace {

using enum BindingKind;

enum VolumeBuffer : std::size_t { kVolumeFrameData, kVolumeSources, kPieces, kVolumeCounts, kLights };
const std::vector<BufferRule> kVolumeRules = {
    {"frame", nullptr, {{gpu::kBindShadowFrame, uniform}}},
    {"sources", nullptr, {{gpu::kBindShadowLights, texels_rg32ui}}},
    {"pieces", nullptr, {{gpu::kBindVolumePieces, texels_rg32ui}}},
    {"counts", nullptr, {{gpu::kBindVolumeCounts, texels_r32ui}}},
    {"lights",
     nullptr,
     {{gpu::kBindShadowViews, texels_rgba32f}, {gpu::kBindVolumeLights, texels_rgba32f}}}}; // views: not read

const std::array<KernelCode, 1> kVolumeStages = {{{kShadowLookUpStage, wavepath_look_up_volume_spv}}};

// Reversed z, as of the frame: infinity has depth 0. Stencils are cleared to 0.
constexpr std::array<AttachmentInfo, 1> kVolumeAttachments{
    {{.name = "shadow volumes", .format = ImageFormat::depth32f_stencil8, .clear = {.depth = 0.0f}}}};
const RasterCode kSeenCode{"depth of what is seen", wavepath_seen_depth_vert_spv, wavepath_seen_depth_frag_spv};
const RasterCode kVolumeCode{"shadow volumes", wavepath_volume_vert_spv, {}};
constexpr std::uint64_t kVolumeFirstTriangles = 1 << 14; // of a slice: a guess

RasterState mark_seen() {
  const StencilFace mark{.pass = StencilOp::replace, .reference = 1};
  return {.stencil = StencilState{mark, mark}};
}

// In front of what is seen, volumes are entered through faces that face the eye. Behind it, where depth tests fail,
// they are left through faces that face away. What lies as deep as what is seen lies behind it.
RasterState counting(VolumeCount count, bool outwards) {
  StencilFace entered, left;
  if (count == VolumeCount::in_front) {
    entered.pass = StencilOp::increment_wrap;
    left.pass = StencilOp::decrement_wrap;
  } else {
    entered.depth_fail = StencilOp::decrement_wrap;
    left.depth_fail = StencilOp::increment_wrap;
  }
  RasterState state{.depth = {.write = false}};
  state.stencil = outwards ? StencilState{entered, left} : StencilState{left, entered};
  return state;
}

class ShadowVolumes : public LookUpTechnique {
public:
  ShadowVolumes(const ShadowContext& context, VolumeCount count)
      : LookUpTechnique(context, kVolumeRules), count_(count), chunks_(make_chunks(context.workspace.scene)) {}

  void change(const View& view, const RenderPlan& settings, const std::vector<Binding>& shared) override {
    // The far plane of an orthographic camera would cut volumes open.
    if (view.orthographic)
      throw Error(fmt::format("--shadows {}", kind_.name), "needs a camera with perspective", "use --shadows traced");
    start_kernels(view, settings);
    camera_ = camera_of(view);
    size_ = glm::uvec2(settings.width, settings.height);
    if (!known_cull_ || *known_cull_ != settings.cull) make_pieces(settings.cull == gpu::kCullAll);
    known_cull_ = settings.cull;
    allocate();
    gpu::ShadowFrame frame{};
    frame.ambient = static_cast<float>(settings.shadow_ambient);
    upload_frame(frame);
    bind(shared);
    make_pipelines(shared);
  }

  // Anew for each frame, which sees other points.
  void build(WaveQueue& queue, std::uint32_t) override {
    const std::uint64_t most = triangles_a_slice_.next_frame();
    const std::vector<Draw> seen = visible_draws(chunks_, camera_, size_.x, size_.y);
    draw(queue, most, *seen_, 0, kClearAll, seen, copy_to_picture(0));
    for (std::uint32_t source = 0; source < sources_.size(); ++source) {
      const PieceRange& range = ranges_[source];
      const Draw outwards{range.first, range.outwards, 0, 1};
      const Draw inwards{range.first + range.outwards, range.inwards, 0, 1};
      draw(queue, most, *outwards_, source, kClearStencil, {&outwards, 1}, [](Commands&) {});
      draw(queue, most, *inwards_, source, kClearNothing, {&inwards, 1}, copy_to_picture(1 + source));
    }
  }

  std::uint32_t view_count() const override { return 0; }

private:
  struct PieceRange {
    std::uint32_t first = 0, outwards = 0, inwards = 0;
  };

  gpu::CameraView camera_of(const View& view) const {
    gpu::CameraView camera{};
    camera.position = glm::vec3(view.position - workspace_.scene.origin);
    camera.right = glm::vec3(view.right);
    camera.up = glm::vec3(view.up);
    camera.forward = glm::vec3(view.forward);
    return camera;
  }

  // Lights and casters keep their places, so their volumes do.
  void make_pieces(bool culls_backs) {
    const PackedScene& scene = workspace_.scene;
    const VolumeCasters casters(scene, culls_backs);
    std::vector<glm::uvec2> all;
    std::vector<glm::vec4> lights;
    ranges_.clear();
    for (const ShadowSource& source : sources_) {
      const bool is_point = source.kind != kDirectionalSource;
      lights.emplace_back(is_point ? source.position : source.direction, is_point ? 1.0f : 0.0f);
      const VolumePieces pieces = casters.pieces(source, count_ == VolumeCount::behind);
      check_pieces(all.size() + pieces.outwards.size() + pieces.inwards.size());
      ranges_.push_back({static_cast<std::uint32_t>(all.size()), static_cast<std::uint32_t>(pieces.outwards.size()),
                         static_cast<std::uint32_t>(pieces.inwards.size())});
      all.insert(all.end(), pieces.outwards.begin(), pieces.outwards.end());
      all.insert(all.end(), pieces.inwards.begin(), pieces.inwards.end());
    }
    if (all.empty()) all.emplace_back(0);
    buffers_[kVolumeSources] = upload(workspace_.device, sources_of_lights());
    buffers_[kPieces] = upload(workspace_.device, all);
    buffers_[kLights] = upload(workspace_.device, lights);
  }

  void check_pieces(std::size_t count) const {
    const DeviceInfo& info = workspace_.device.info();
    const std::uint64_t most = std::min<std::uint64_t>(info.max_texels(16), gpu::kNone / 3);
    const bool instances_fit = workspace_.scene.instances.size() >> (32 - gpu::kVolumeBits) == 0;
    if (count > most || !instances_fit)
      throw Error(info.name, fmt::format("holds {} triangles of shadow volumes, of {}", most, count),
                  "use --shadows traced");
  }

  // Pictures of counts: a first one of what is known, and one a source.
  void allocate() {
    if (size_ == made_for_) return;
    made_for_ = glm::uvec2(0);
    target_.reset(); // the device may not hold both at once
    const DeviceInfo& info = workspace_.device.info();
    const std::uint64_t bytes = (1 + sources_.size()) * picture_bytes();
    const std::uint64_t most =
        std::min({4 * info.max_texels(4), info.max_allocation, info.memory_bytes / 2, std::uint64_t{1} << 32});
    if (bytes > most)
      throw Error(info.name,
                  fmt::format("cannot hold pictures of the shadows of {} lights, {:.0f} MiB; at most {:.0f} MiB",
                              sources_.size(), bytes / 1048576.0, most / 1048576.0),
                  "use a smaller --size or --shadows traced");
    buffers_[kVolumeCounts] = Buffer(workspace_.device, bytes);
    target_ = std::make_unique<RasterTarget>(workspace_.device, size_.x, size_.y, kVolumeAttachments);
    made_for_ = size_;
  }

  void make_pipelines(const std::vector<Binding>& shared) {
    seen_.reset();
    outwards_.reset();
    inwards_.reset();
    bind_draws(shared);
    const auto constants = specialization(need_.config, workspace_.device.info());
    seen_.emplace(workspace_.device, kSeenCode, kVolumeAttachments, mark_seen(), *raster_set_, constants);
    outwards_.emplace(workspace_.device, kVolumeCode, kVolumeAttachments, counting(count_, true), *raster_set_,
                      constants);
    inwards_.emplace(workspace_.device, kVolumeCode, kVolumeAttachments, counting(count_, false), *raster_set_,
                     constants);
  }

  std::uint64_t picture_bytes() const { return gpu::volume_picture_bytes(size_.x * size_.y); }

  std::function<void(Commands&)> copy_to_picture(std::uint32_t picture) {
    return [this, picture](Commands& commands) {
      target_->image(0).copy_to(commands.handle(), buffers_[kVolumeCounts], Aspect::stencil, picture * picture_bytes());
    };
  }

  void draw(WaveQueue& queue, std::uint64_t most, const RasterPipeline& pipeline, std::uint32_t source,
            std::uint32_t clear, std::span<const Draw> draws, const std::function<void(Commands&)>& after) {
    gpu::Wave wave{};
    wave.first_pixel = source;
    const SlicedPass pass{.target = target_.get(),
                          .pipeline = &pipeline,
                          .bindings = raster_set_.get(),
                          .push = &wave,
                          .stage = kShadowBuildStage,
                          .clear = clear};
    draw_in_slices(
        queue, pass, draws, most, [](Commands&) {}, after,
        [this](double seconds) { triangles_a_slice_.note(seconds); });
  }

  VolumeCount count_;
  std::vector<Chunk> chunks_;
  std::vector<PieceRange> ranges_; // by source
  std::optional<std::uint32_t> known_cull_;
  gpu::CameraView camera_{};
  glm::uvec2 size_{0}, made_for_{0}; // the picture's
  std::optional<RasterPipeline> seen_, outwards_, inwards_;
  SliceLength triangles_a_slice_{kVolumeFirstTriangles};
};

} // namespace

const KernelProgram kVolumeProgram = {kVolumeStages, kOnlyStage, [] { return look_up_layout(kVolumeRules); }};

std::unique_ptr<ShadowTechnique> make_shadow_volumes(const ShadowContext& context, VolumeCount count) {
  return std::make_unique<ShadowVolumes>(context, count);
}

} // namespace wavepath
