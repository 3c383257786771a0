// Lightmaps: which fraction of each light arrives, baked by rays for texels spread over all surfaces before the first
// frame, as games have baked light since id Software's Quake (1996). Frames look up what does not move.
#include <array>
#include <bit>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/integrators/hybrid/raster/slices.h"
#include "host/integrators/hybrid/shadows/kinds.h"
#include "host/integrators/hybrid/shadows/lamp_points.h"
#include "host/integrators/hybrid/shadows/lightmap_charts.h"
#include "host/integrators/hybrid/shadows/look_up_technique.h"
#include "host/integrators/hybrid/shadows/map_size.h"
#include "host/integrators/hybrid/shadows/times.h"
#include "kernels/hybrid/shadows/lightmap_bake.spv.h"
#include "kernels/hybrid/shadows/lightmap_bake_query.spv.h"
#include "kernels/hybrid/shadows/lightmap_types.h"
#include "kernels/hybrid/shadows/look_up_lightmap.spv.h"

namespace wavepath {
namespace {

using enum BindingKind;

enum LightmapBuffer : std::size_t { kLightmapFrameData, kLightmapSources, kFirst, kCharts, kTexels, kLit, kPoints };
const std::vector<BufferRule> kLightmapRules = {
    {"frame", nullptr, {{gpu::kBindShadowFrame, uniform}}},
    {"sources", nullptr, {{gpu::kBindShadowLights, texels_rg32ui}}},
    {"first charts", nullptr, {{gpu::kBindLightmapFirst, texels_r32ui}}},
    {"charts", nullptr, {{gpu::kBindLightmapCharts, texels_rg32ui}}},
    {"texels", nullptr, {{gpu::kBindLightmapTexels, texels_rg32ui}}},
    {"shares", nullptr, {{gpu::kBindLightmapLit, texels_r32f}, {gpu::kBindLightmapLitWords, storage}}},
    {"points",
     nullptr,
     {{gpu::kBindShadowViews, texels_rgba32f}, {gpu::kBindLightmapPoints, texels_rgba32f}}}}; // views: not read

enum LightmapStage : std::size_t { kLightmapLookUp, kBake, kLightmapStageCount };
const std::array<KernelCode, kLightmapStageCount> kLightmapStages = {
    {{kShadowLookUpStage, wavepath_look_up_lightmap_spv},
     {kShadowBuildStage, wavepath_lightmap_bake_spv, {}, wavepath_lightmap_bake_query_spv}}};
constexpr std::array<std::size_t, kLightmapStageCount> kLightmapOrder = {kBake, kLightmapLookUp};
const KernelProgram kLightmapProgram = {kLightmapStages, kLightmapOrder, [] { return look_up_layout(kLightmapRules); }};

constexpr std::uint64_t kRaysASlice = 1 << 14; // a few milliseconds of one core's work, and enough to fill a device
constexpr float kShortOfTheLamp = 0.9999f;     // t_max: rays to points of a lamp end in front of its surface

// Settings for which a lightmap is baked.
struct BakedFor {
  std::uint32_t size = 0, taps = 0, cull = 0, terminator = 0;
  friend bool operator==(const BakedFor&, const BakedFor&) = default;
};

class Lightmap : public LookUpTechnique {
public:
  explicit Lightmap(const ShadowContext& context) : LookUpTechnique(context, kLightmapRules) {
    buffers_[kLightmapSources] = upload(workspace_.device, sources_of_lights());
  }

  void change(const View& view, const RenderPlan& settings, const std::vector<Binding>& shared) override {
    start_kernels(view, settings);
    const std::uint32_t size =
        size_that_fits(settings.shadow_size, [&](std::uint32_t at_size) { return fits(at_size); });
    const BakedFor wanted{size, settings.shadow_taps, settings.cull, settings.terminator};
    if (wanted != made_for_) allocate(wanted);
    gpu::ShadowFrame frame{};
    frame.size = size;
    frame.ambient = static_cast<float>(settings.shadow_ambient);
    upload_frame(frame);
    bind(shared);
  }

  // Once: neither surfaces nor lights move.
  void build(WaveQueue& queue, std::uint32_t) override {
    if (is_baked_) return;
    is_baked_ = true;
    const std::uint32_t texels = made_for_.size * made_for_.size;
    for (std::uint32_t source = 0; source < sources_.size(); ++source) {
      const std::uint64_t rays = is_lamp(sources_[source]) ? made_for_.taps : 1;
      const auto most = static_cast<std::uint32_t>(std::max<std::uint64_t>(kRaysASlice / rays, 1));
      for (std::uint32_t first = 0; first < texels; first += most) {
        gpu::Wave wave{};
        wave.first_pixel = first;
        wave.pixel_count = std::min(most, texels - first);
        wave.sample_count = source;
        const auto record = [&](Commands& commands) {
          commands.bind(*sets_.front());
          commands.dispatch(kernels_.best(need_)[kBake], groups_for(wave.pixel_count), &wave);
        };
        queue.submit(record, {.stage = kShadowBuildStage});
      }
    }
  }

  std::uint32_t view_count() const override { return static_cast<std::uint32_t>(sources_.size()); }
  void describe(ShadowReport& report) const override { report.size = made_for_.size; }

private:
  static bool is_lamp(const ShadowSource& source) { return source.kind & kAreaSources; }

  void allocate(const BakedFor& wanted) {
    made_for_ = {};
    is_baked_ = false;
    check_fits(wanted.size);
    const LightmapCharts charts = make_lightmap_charts(workspace_.scene, wanted.size);
    if (charts.texels.empty())
      throw Error("--shadow-size",
                  fmt::format("of {} gives {} charts of surfaces less than a texel each", wanted.size, charts.count),
                  "use a larger one or --shadows traced");
    Device& device = workspace_.device;
    buffers_[kFirst] = upload(device, charts.first);
    buffers_[kCharts] = upload(device, charts.charts);
    buffers_[kTexels] = upload(device, charts.texels);
    buffers_[kLit] = Buffer(device, sources_.size() * charts.texels.size() * sizeof(float));
    buffers_[kPoints] = upload(device, make_points(wanted.taps));
    made_for_ = wanted;
  }

  struct Footprint {
    std::uint64_t entries, largest, bytes; // largest: elements of a buffer
  };
  Footprint footprint_at(std::uint32_t size) const {
    const std::uint64_t texels = std::uint64_t{size} * size, fractions = texels * sources_.size(),
                        entries = placed_triangles(workspace_.scene);
    return {entries, std::max({texels, fractions, entries}),
            fractions * sizeof(float) + (texels + entries) * sizeof(glm::uvec2)};
  }
  std::uint64_t most_elements() const {
    const DeviceInfo& info = workspace_.device.info();
    return std::min({info.max_texels(16), info.max_allocation / sizeof(glm::uvec2),
                     info.max_storage_range / sizeof(float), std::uint64_t{gpu::kNone}});
  }
  bool fits(std::uint32_t size) const {
    const Footprint footprint = footprint_at(size);
    return footprint.largest <= most_elements() && footprint.bytes <= workspace_.device.info().memory_bytes;
  }

  // Throws before anything is allocated.
  void check_fits(std::uint32_t size) const {
    if (fits(size)) return;
    const DeviceInfo& info = workspace_.device.info();
    const Footprint footprint = footprint_at(size);
    throw Error(
        info.name,
        fmt::format("cannot hold lightmaps of {} lights, {}x{} texels each, and charts of {} triangles, {:.0f} "
                    "MiB; at most {} of each and {:.0f} MiB",
                    sources_.size(), size, size, footprint.entries, static_cast<double>(footprint.bytes) / 1048576.0,
                    most_elements(), static_cast<double>(info.memory_bytes) / 1048576.0),
        "use a smaller --shadow-size or --shadows traced");
  }

  std::vector<glm::vec4> make_points(std::uint32_t taps) const {
    std::vector<glm::vec4> points(sources_.size());
    for (std::size_t i = 0; i < sources_.size(); ++i) {
      const ShadowSource& source = sources_[i];
      const gpu::Light& light = workspace_.scene.lights[source.lights.front()];
      const auto first = static_cast<std::uint32_t>(points.size());
      float t_max = 1.0f;
      bool is_round = false;
      if (is_lamp(source)) {
        for (const glm::dvec3& point : lamp_points(source, taps)) points.emplace_back(glm::vec3(point), 1.0f);
        is_round = source.kind == kSphereSource;
        t_max = kShortOfTheLamp;
      } else if (source.kind == kDirectionalSource) {
        points.emplace_back(light.direction, 0.0f);
        t_max = gpu::kFar;
      } else {
        points.emplace_back(light.position, 1.0f);
      }
      const auto count = static_cast<std::uint32_t>(points.size() - first);
      if (is_round) points.emplace_back(glm::vec3(source.position), 1.0f);
      points[i] = glm::vec4(std::bit_cast<float>(first), std::bit_cast<float>(count), t_max, is_round ? 1.0f : 0.0f);
    }
    return points;
  }

  BakedFor made_for_;
  bool is_baked_ = false;
};

constexpr std::array<std::string_view, 2> kLightmapSettings = {"shadow-size", "shadow-taps"};

void check_taps(const RenderPlan& settings) {
  constexpr std::uint32_t kMostBakedTaps = 64; // of one texel, whose rays are one lane's: drivers end long loops
  if (settings.shadow_taps > kMostBakedTaps)
    throw UsageError("--shadow-taps", fmt::format("is at most {} for --shadows lightmap", kMostBakedTaps),
                     "give fewer");
}

} // namespace

constinit const ShadowKind kShadowLightmap = {
    .name = "lightmap",
    .summary = "what arrives of each light, baked into texels on all surfaces before the first frame",
    .sources = kAllSources,
    .settings = kLightmapSettings,
    .program = &kLightmapProgram,
    .make = [](const ShadowContext& context) -> std::unique_ptr<ShadowTechnique> {
      return std::make_unique<Lightmap>(context);
    },
    .check = check_taps,
};

} // namespace wavepath
