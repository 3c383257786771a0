// Planar shadows (Blinn 1988): what is above one of the scene's large planes is flattened onto it, away from the light,
// and drawn as the camera sees it. What is on no such plane stays lit.
#include <array>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/integrators/hybrid/raster/culling.h"
#include "host/integrators/hybrid/raster/slices.h"
#include "host/integrators/hybrid/shadows/kinds.h"
#include "host/integrators/hybrid/shadows/look_up_technique.h"
#include "host/integrators/hybrid/shadows/receiver_planes.h"
#include "host/integrators/hybrid/shadows/times.h"
#include "kernels/hybrid/planar_frag.spv.h"
#include "kernels/hybrid/planar_vert.spv.h"
#include "kernels/hybrid/shadows/look_up_planar.spv.h"
#include "kernels/hybrid/shadows/planar_types.h"

namespace wavepath {
namespace {

using enum BindingKind;

enum PlanarBuffer : std::size_t { kPlanarFrameData, kPairs, kPlanarSources, kShadows };
const std::vector<BufferRule> kPlanarRules = {
    {"frame", nullptr, {{gpu::kBindShadowFrame, uniform}}},
    {"pairs",
     nullptr,
     {{gpu::kBindShadowViews, texels_rgba32f}, {gpu::kBindPlanarPairs, texels_rgba32f}}}, // views: not read
    {"sources", nullptr, {{gpu::kBindShadowLights, texels_rg32ui}}},
    {"shadows", nullptr, {{gpu::kBindPlanarShadows, texels_r32ui}}}};

const std::array<KernelCode, 1> kPlanarStages = {{{kShadowLookUpStage, wavepath_look_up_planar_spv}}};
const KernelProgram kPlanarProgram = {kPlanarStages, kOnlyStage, [] { return look_up_layout(kPlanarRules); }};

constexpr std::array<AttachmentInfo, 1> kPlanarAttachments{{{.name = "planar shadows", .format = ImageFormat::r32ui}}};
const RasterCode kCode{"planar shadows", wavepath_planar_vert_spv, wavepath_planar_frag_spv};
constexpr std::uint64_t kPlanarFirstTriangles = 1 << 16; // of a slice: a guess
constexpr double kGrazing = 1e-6; // cosine of the angle to a plane's normal up to which no light reaches it

// Nothing where the light shines along the plane.
std::optional<gpu::PlanarPair> pair_of(const ReceiverPlane& plane, const ShadowSource& source, double tolerance) {
  const bool is_point = source.kind != kDirectionalSource;
  const glm::dvec3 light = is_point ? source.position : -source.direction;
  const double height = glm::dot(plane.normal, light) + (is_point ? plane.offset : 0.0);
  if (std::abs(height) <= (is_point ? tolerance : kGrazing)) return std::nullopt;
  const double side = height > 0.0 ? 1.0 : -1.0;
  gpu::PlanarPair pair{};
  pair.normal = glm::vec3(side * plane.normal);
  pair.offset = static_cast<float>(side * plane.offset);
  pair.light = glm::vec3(light);
  pair.is_point = is_point ? 1.0f : 0.0f;
  pair.height = static_cast<float>(side * height);
  pair.tolerance = static_cast<float>(tolerance);
  return pair;
}

// Half spaces that casters reach into: above the plane, and below the light.
std::vector<HalfSpace> between(const gpu::PlanarPair& pair) {
  const glm::dvec3 normal(pair.normal);
  std::vector<HalfSpace> sides = {{normal, pair.offset}};
  if (pair.is_point > 0.0f) sides.push_back({-normal, double{pair.height} - pair.offset});
  return sides;
}

class PlanarShadows : public LookUpTechnique {
public:
  explicit PlanarShadows(const ShadowContext& context)
      : LookUpTechnique(context, kPlanarRules), chunks_(make_chunks(context.workspace.scene)) {
    make_pairs();
  }

  void change(const View& view, const RenderPlan& settings, const std::vector<Binding>& shared) override {
    start_kernels(view, settings);
    allocate(settings);
    gpu::ShadowFrame frame{};
    frame.ambient = static_cast<float>(settings.shadow_ambient);
    upload_frame(frame);
    bind(shared);
    pipeline_.reset();
    bind_draws(shared);
    pipeline_.emplace(workspace_.device, kCode, kPlanarAttachments, RasterState{}, *raster_set_,
                      specialization(need_.config, workspace_.device.info()));
  }

  // Anew for each frame, which sees other points.
  void build(WaveQueue& queue, std::uint32_t) override {
    const std::uint64_t most = triangles_a_slice_.next_frame();
    const std::vector<Draw> nothing;
    for (std::uint32_t source = 0; source < sources_.size(); ++source) {
      const auto copy = [this, last = source + 1 == sources_.size()](Commands& commands) {
        if (last) target_->image(0).copy_to(commands.handle(), buffers_[kShadows]);
      };
      const auto [first, end] = pairs_of_source_[source];
      if (first == end) draw_pair(queue, most, 0, {.source = source, .clear = true}, nothing, copy);
      for (std::uint32_t pair = first; pair < end; ++pair)
        draw_pair(
            queue, most, pair, {.source = source, .clear = pair == first}, draws_within(chunks_, between(pairs_[pair])),
            pair + 1 == end ? std::function<void(Commands&)>(copy) : [](Commands&) {});
    }
  }

  std::uint32_t view_count() const override { return static_cast<std::uint32_t>(pairs_.size()); }

private:
  struct Layer {
    std::uint32_t source;
    bool clear;
  };

  void make_pairs() {
    const PackedScene& scene = workspace_.scene;
    const std::vector<ReceiverPlane> planes = receiver_planes(scene);
    for (std::uint32_t i = 0; i < sources_.size(); ++i) {
      const auto first = static_cast<std::uint32_t>(pairs_.size());
      for (const ReceiverPlane& plane : planes)
        if (std::optional<gpu::PlanarPair> pair = pair_of(plane, sources_[i], plane_tolerance(scene))) {
          pair->source = i;
          pairs_.push_back(*pair);
        }
      pairs_of_source_.emplace_back(first, static_cast<std::uint32_t>(pairs_.size()));
    }
    buffers_[kPlanarSources] = upload(workspace_.device, sources_of_lights());
    buffers_[kPairs] = upload(workspace_.device, pairs_.empty() ? std::vector<gpu::PlanarPair>(1) : pairs_);
  }

  void allocate(const RenderPlan& settings) {
    const glm::uvec2 size(settings.width, settings.height);
    if (size == made_for_) return;
    made_for_ = glm::uvec2(0);
    target_.reset(); // the device may not hold both at once
    const DeviceInfo& info = workspace_.device.info();
    const std::uint64_t texels = std::uint64_t{size.x} * size.y * sources_.size(), bytes = 4 * texels;
    const std::uint64_t most = std::min({4 * info.max_texels(4), info.max_allocation, info.memory_bytes / 2});
    if (bytes > most)
      throw Error(info.name,
                  fmt::format("cannot hold pictures of the shadows of {} lights, {:.0f} MiB; at most {:.0f} MiB",
                              sources_.size(), bytes / 1048576.0, most / 1048576.0),
                  "use a smaller --size or --shadows traced");
    buffers_[kShadows] = Buffer(workspace_.device, bytes);
    target_ = std::make_unique<RasterTarget>(workspace_.device, size.x, size.y, kPlanarAttachments,
                                             static_cast<std::uint32_t>(sources_.size()));
    made_for_ = size;
  }

  void draw_pair(WaveQueue& queue, std::uint64_t most, std::uint32_t pair, const Layer& layer,
                 const std::vector<Draw>& draws, const std::function<void(Commands&)>& after) {
    gpu::Wave wave{};
    wave.first_pixel = pair;
    const SlicedPass pass{.target = target_.get(),
                          .pipeline = &*pipeline_,
                          .bindings = raster_set_.get(),
                          .push = &wave,
                          .layer = layer.source,
                          .stage = kShadowBuildStage,
                          .clear = layer.clear ? kClearAll : kClearNothing};
    draw_in_slices(
        queue, pass, draws, most, [](Commands&) {}, after,
        [this](double seconds) { triangles_a_slice_.note(seconds); });
  }

  std::vector<Chunk> chunks_;
  std::vector<gpu::PlanarPair> pairs_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs_of_source_; // first, end
  glm::uvec2 made_for_{0};                                               // the picture's size
  std::optional<RasterPipeline> pipeline_;
  SliceLength triangles_a_slice_{kPlanarFirstTriangles};
};

} // namespace

constinit const ShadowKind kShadowPlanar = {
    .name = "planar",
    .summary = "casters flattened onto the scene's large planes (Blinn 1988)",
    .sources = kPunctualSources,
    .program = &kPlanarProgram,
    .make = [](const ShadowContext& context) -> std::unique_ptr<ShadowTechnique> {
      return std::make_unique<PlanarShadows>(context);
    },
    .refusal = no_receiver_planes,
};

} // namespace wavepath
