#include "host/integrators/shadows/shadow_maps.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/integrators/shadows/taps.h"
#include "host/render/settings/shadow_settings.h"
#include "kernels/shadows/shadow_ids_frag.spv.h"
#include "kernels/shadows/shadow_map_frag.spv.h"
#include "kernels/shadows/shadow_map_vert.spv.h"
#include "kernels/shadows/shadow_trace.spv.h"

namespace wavepath {
namespace {

using enum BindingKind;

enum MapBuffer : std::size_t {
  kFrameData,
  kViews,
  kLightViews,
  kDepths,
  kIds,
  kTaps,
  kFiltered,
  kScratch,
  kCounts,
  kMapBufferCount
};

struct MapBinding {
  std::uint32_t slot;
  BindingKind kind;
  MapBuffer buffer;
};
constexpr std::array<MapBinding, 12> kBindings = {{{gpu::kBindShadowFrame, uniform, kFrameData},
                                                   {gpu::kBindShadowViews, texels_rgba32f, kViews},
                                                   {gpu::kBindShadowLights, texels_rg32ui, kLightViews},
                                                   {gpu::kBindShadowDepths, texels_r32f, kDepths},
                                                   {gpu::kBindShadowDepthWords, storage, kDepths},
                                                   {gpu::kBindShadowIds, texels_rg32ui, kIds},
                                                   {gpu::kBindShadowIdWords, storage, kIds},
                                                   {gpu::kBindShadowTaps, texels_rgba32f, kTaps},
                                                   {gpu::kBindShadowFiltered, texels_rgba32f, kFiltered},
                                                   {gpu::kBindShadowFilteredWords, storage, kFiltered},
                                                   {gpu::kBindShadowScratch, storage, kScratch},
                                                   {gpu::kBindShadowCounts, storage, kCounts}}};

const std::array<AttachmentInfo, 3> kAttachments{
    {{.name = "shadow map", .format = ImageFormat::r32f, .clear = {.colour = {gpu::kFar, 0.0f, 0.0f, 0.0f}}},
     {.name = "depth", .format = ImageFormat::depth32f, .clear = {.depth = 0.0f}},
     {.name = "shadow map's triangles", .format = ImageFormat::rg32ui, .clear = {.words = {gpu::kNone, gpu::kNone}}}}};
std::span<const AttachmentInfo> attachments(bool ids) { return std::span(kAttachments).first(ids ? 3 : 2); }

const RasterCode kDepthCode{"shadow map", wavepath_shadow_map_vert_spv, wavepath_shadow_map_frag_spv};
const RasterCode kIdCode{"shadow map", wavepath_shadow_map_vert_spv, wavepath_shadow_ids_frag_spv};

constexpr std::uint64_t kFirstTriangles = 1 << 16, kFirstTexels = 1 << 16; // of a slice: guesses
constexpr std::uint32_t kTimedBuilds = 5; // frames that build anew what could be kept, so that the time has a median
constexpr double kNarrowNear = 1e-30;

class ShadowMaps : public ShadowTechnique {
public:
  ShadowMaps(const ShadowMapRecipe& recipe, const ShadowContext& context)
      : recipe_(recipe),
        workspace_(context.workspace),
        kernels_(context.kernels),
        sources_(context.sources),
        chunks_(make_chunks(context.workspace.scene)) {}

  void change(const View& view, const RenderSettings& settings, const std::vector<Binding>& shared) override {
    settings_ = settings;
    make_views(view);
    need_ = {recipe_.program, (1u << recipe_.program->stages.size()) - 1u,
             kernel_config(needed_features(workspace_.scene, view, settings), workspace_.scene.stack_size, settings)};
    kernels_.start(need_);
    make_room();
    std::vector<Binding> own = shared;
    add_bindings(own);
    sets_ = bind_bands(workspace_, own);
    make_pipeline();
    builds_left_ = kTimedBuilds;
  }

  bool is_ready() override { return kernels_.ready(need_); }
  double get_ready() override { return kernels_.best(need_).seconds(); }

  void build(WaveQueue& queue, std::uint32_t) override {
    if (builds_left_ == 0) return;
    --builds_left_;
    if (settings_.shadow_source == kShadowSourceTraced)
      trace(queue);
    else
      draw(queue);
    filter(queue);
  }

  void record_look_up(Commands& commands, std::size_t band, const gpu::Wave& wave) override {
    commands.bind(*sets_[band]);
    commands.dispatch(kernels_.best(need_)[0], groups_for(std::uint64_t{wave.pixel_count} * wave.sample_count), &wave);
  }

  std::uint64_t bytes() const override {
    std::uint64_t bytes = target_ ? target_->bytes() : 0;
    for (const Buffer& buffer : buffers_) bytes += buffer.bytes();
    return bytes;
  }
  std::optional<RayAnswers> answers() const override {
    if (!recipe_.counts) return std::nullopt;
    const gpu::ShadowCounts counts = download<gpu::ShadowCounts>(buffers_[kCounts], 1).front();
    const auto whole = [](const gpu::uint* parts) { return std::uint64_t{parts[1]} << 32 | parts[0]; };
    return RayAnswers{.answered = whole(counts.answered), .traced = whole(counts.left)};
  }
  std::uint32_t view_count() const override { return static_cast<std::uint32_t>(views_.size()); }

private:
  std::uint64_t texels() const { return std::uint64_t{settings_.shadow_size} * settings_.shadow_size * views_.size(); }

  // The frusta, and which light has which.
  void make_views(const View& world) {
    const PackedScene& scene = workspace_.scene;
    View view = world;
    view.position -= scene.origin;
    ShadowFit fit;
    fit.lo = glm::dvec3(1e300), fit.hi = glm::dvec3(-1e300);
    for (const Chunk& chunk : chunks_) {
      fit.lo = glm::min(fit.lo, chunk.centre - chunk.half);
      fit.hi = glm::max(fit.hi, chunk.centre + chunk.half);
    }
    fit.radius = scene.radius;
    const double far = glm::distance(view.position, 0.5 * (fit.lo + fit.hi)) + glm::distance(fit.lo, fit.hi);
    fit.receivers = seen_corners(view, fit.lo, fit.hi, view.orthographic ? 0.0 : kNarrowNear * far, far);
    if (fit.receivers.empty()) fit.receivers = {fit.lo, fit.hi};
    fit.size = settings_.shadow_size;
    fit.guard = 1.0 + (recipe_.guard ? recipe_.guard(settings_) : 0.0);
    views_.clear();
    light_views_.assign(std::max<std::size_t>(scene.lights.size(), 1), glm::uvec2(gpu::kNone, 0));
    for (const ShadowSource& source : sources_) {
      const auto first = static_cast<std::uint32_t>(views_.size());
      const std::vector<gpu::ShadowView> views =
          recipe_.views ? recipe_.views(fit, source, view, settings_) : usual_views(fit, source);
      views_.insert(views_.end(), views.begin(), views.end());
      for (const std::uint32_t light : source.lights) light_views_[light] = glm::uvec2(first, views.size());
    }
    for (std::size_t i = 0; i < views_.size(); ++i)
      views_[i].first_texel = static_cast<std::uint32_t>(i * settings_.shadow_size * settings_.shadow_size);
  }

  // Throws before anything is allocated.
  void check_fits(std::uint64_t bytes_per_texel, std::uint64_t largest) const {
    const DeviceInfo& info = workspace_.device.info();
    const std::uint64_t most = std::min({info.max_texel_elements, info.max_storage_range / largest,
                                         info.max_allocation / largest, std::uint64_t{gpu::kNone}});
    if (texels() <= most && texels() * bytes_per_texel <= info.memory_bytes) return;
    throw Error(info.name,
                fmt::format("cannot hold {} shadow maps of {}x{} texels, {:.0f} MiB; at most {} texels", views_.size(),
                            settings_.shadow_size, settings_.shadow_size, texels() * bytes_per_texel / 1048576.0, most),
                "use a smaller --shadow-size");
  }

  void make_room() {
    const std::uint64_t ids = recipe_.ids ? sizeof(glm::uvec2) : 0,
                        filtered = recipe_.filtered_bytes ? recipe_.filtered_bytes(settings_) : 0,
                        scratch = recipe_.scratch_bytes ? recipe_.scratch_bytes(settings_) : 0;
    const bool raster = settings_.shadow_source == kShadowSourceRaster;
    check_fits((raster ? 3 : 1) * sizeof(float) + (raster ? 2 : 1) * ids + filtered + scratch,
               std::max({sizeof(float), ids, filtered, scratch}));
    const glm::uvec3 made_for(settings_.shadow_size, views_.size(), raster);
    if (made_for != made_for_) {
      made_for_ = glm::uvec3(0);
      target_.reset(); // the device may not hold both at once
      Device& device = workspace_.device;
      buffers_[kDepths] = Buffer(device, texels() * sizeof(float));
      buffers_[kIds] = Buffer(device, texels() * ids);
      buffers_[kFiltered] = Buffer(device, texels() * filtered);
      buffers_[kScratch] = Buffer(device, texels() * scratch);
      if (raster)
        target_ = std::make_unique<RasterTarget>(device, settings_.shadow_size, settings_.shadow_size,
                                                 attachments(recipe_.ids), static_cast<std::uint32_t>(views_.size()));
      made_for_ = made_for;
    }
    buffers_[kViews] = upload(workspace_.device, views_);
    buffers_[kLightViews] = upload(workspace_.device, light_views_);
    const std::vector<glm::vec4> taps =
        recipe_.taps ? filter_taps(settings_.shadow_pattern, settings_.shadow_taps) : std::vector<glm::vec4>(1);
    buffers_[kTaps] = upload(workspace_.device, taps);
    const auto tap_count = recipe_.taps ? static_cast<std::uint32_t>(taps.size()) : settings_.shadow_taps;
    buffers_[kCounts] = upload(workspace_.device, std::vector<gpu::ShadowCounts>(recipe_.counts ? 1 : 0));
    buffers_[kFrameData] = upload(workspace_.device, std::vector<gpu::ShadowFrame>{shadow_frame(tap_count)});
  }

  gpu::ShadowFrame shadow_frame(std::uint32_t taps) const {
    gpu::ShadowFrame frame{};
    frame.size = settings_.shadow_size;
    frame.bias_kind = settings_.shadow_bias;
    frame.bias =
        static_cast<float>(settings_.shadow_bias_amount.value_or(settings_.shadow_bias == gpu::kBiasPlane ? 0.0 : 1.0));
    frame.ambient = static_cast<float>(settings_.shadow_ambient);
    frame.taps = taps;
    frame.pattern = settings_.shadow_pattern;
    frame.blur = static_cast<float>(settings_.shadow_blur);
    frame.exponent = static_cast<float>(settings_.shadow_exponent.value_or(recipe_.exponent));
    frame.bits = settings_.shadow_bits;
    frame.view_count = view_count();
    frame.cascades = settings_.shadow_cascades;
    return frame;
  }

  void add_bindings(std::vector<Binding>& bindings) const {
    for (const MapBinding& binding : kBindings)
      bindings.push_back({binding.slot, binding.kind, &buffers_[binding.buffer]});
  }

  void make_pipeline() {
    std::vector<Binding> bindings = workspace_.bindings(workspace_.film.bands().front());
    add_bindings(bindings);
    pipeline_.reset();
    tracer_.reset();
    raster_set_ =
        std::make_unique<BindingSet>(workspace_.device, bindings, sizeof(gpu::Wave), BindingSet::kRasterStages);
    const auto constants = specialization(need_.config, workspace_.device.info());
    if (settings_.shadow_source == kShadowSourceTraced) {
      tracer_.emplace(workspace_.device, "shadow build", wavepath_shadow_trace_spv, *raster_set_, constants);
      return;
    }
    RasterState state;
    if (settings_.shadow_bias == gpu::kBiasSecondDepth) state.cull = Cull::front;
    pipeline_.emplace(workspace_.device, recipe_.ids ? kIdCode : kDepthCode, attachments(recipe_.ids), state,
                      *raster_set_, constants);
  }

  void draw(WaveQueue& queue) {
    const std::uint64_t most = triangles_a_slice_.next_frame();
    for (std::uint32_t view = 0; view < views_.size(); ++view) {
      gpu::Wave wave{};
      wave.first_pixel = view;
      const SlicedPass pass{target_.get(), &*pipeline_, raster_set_.get(), &wave, view, "shadow build"};
      const bool last = view + 1 == views_.size();
      const auto copy = [this, last](Commands& commands) {
        if (!last) return;
        target_->image(0).copy_to(commands.handle(), buffers_[kDepths]);
        if (recipe_.ids) target_->image(2).copy_to(commands.handle(), buffers_[kIds]);
      };
      draw_in_slices(
          queue, pass, draws_within(chunks_, frustum_of(views_[view])), most, [](Commands&) {}, copy,
          [this](double seconds) { triangles_a_slice_.note(seconds); });
    }
  }

  void trace(WaveQueue& queue) {
    gpu::Wave wave{};
    wave.first_sample = recipe_.ids ? 1 : 0;
    const std::uint32_t texels = settings_.shadow_size * settings_.shadow_size;
    const SlicedDispatch work{&*tracer_, raster_set_.get(), wave, texels, texels_a_slice_.next_frame()};
    for (std::uint32_t view = 0; view < views_.size(); ++view) dispatch_in_slices(queue, work, view, texels_a_slice_);
  }

  void filter(WaveQueue& queue) {
    const std::uint32_t size = settings_.shadow_size;
    // A wide filter reads many texels for each that it writes.
    const std::uint64_t most =
        filtered_a_slice_.next_frame() / (1 + static_cast<std::uint64_t>(settings_.shadow_blur / 16.0));
    for (std::uint32_t view = 0; view < views_.size(); ++view)
      for (const MapPass& pass : recipe_.passes) {
        const bool lines = pass.items == MapPass::Items::lines;
        const std::uint64_t a_slice = lines ? std::max<std::uint64_t>(most / size, 1) : most;
        dispatch_in_slices(
            queue, {&kernels_.best(need_)[pass.stage], sets_.front().get(), {}, lines ? size : size * size, a_slice},
            view, filtered_a_slice_);
      }
  }

  // A kernel that goes over a view's items.
  struct SlicedDispatch {
    const Kernel* kernel;
    const BindingSet* bindings;
    gpu::Wave wave;
    std::uint32_t items;
    std::uint64_t a_slice;
  };
  void dispatch_in_slices(WaveQueue& queue, const SlicedDispatch& work, std::uint32_t view, SliceLength& length) {
    for (std::uint32_t first = 0; first < work.items;) {
      gpu::Wave wave = work.wave;
      wave.first_pixel = first;
      wave.pixel_count = static_cast<std::uint32_t>(std::min<std::uint64_t>(work.a_slice, work.items - first));
      wave.sample_count = view;
      const auto record = [&](Commands& commands) {
        commands.bind(*work.bindings);
        commands.dispatch(*work.kernel, groups_for(wave.pixel_count), &wave);
      };
      queue.submit(record, {.stage = "shadow build",
                            .done = [&length](const Finished& finished) { length.note(finished.seconds); }});
      first += wave.pixel_count;
    }
  }

  const ShadowMapRecipe& recipe_;
  Workspace& workspace_;
  KernelCompiler& kernels_;
  std::vector<ShadowSource> sources_;
  std::vector<Chunk> chunks_;
  RenderSettings settings_;
  std::vector<gpu::ShadowView> views_;
  std::vector<glm::uvec2> light_views_; // by light: first view, how many
  KernelNeed need_;
  std::array<Buffer, kMapBufferCount> buffers_;
  glm::uvec3 made_for_{0}; // size, views, whether they are rasterized
  std::unique_ptr<RasterTarget> target_;
  std::unique_ptr<BindingSet> raster_set_;
  std::optional<RasterPipeline> pipeline_;
  std::optional<Kernel> tracer_;
  std::vector<std::unique_ptr<BindingSet>> sets_; // by band
  SliceLength triangles_a_slice_{kFirstTriangles}, texels_a_slice_{kFirstTexels}, filtered_a_slice_{kFirstTexels};
  std::uint32_t builds_left_ = 0;
};

} // namespace

std::vector<Binding> shadow_layout() {
  std::vector<Binding> layout = path_layout();
  for (const MapBinding& binding : kBindings) layout.push_back({binding.slot, binding.kind, nullptr});
  return layout;
}

std::unique_ptr<ShadowTechnique> make_shadow_maps(const ShadowMapRecipe& recipe, const ShadowContext& context) {
  return std::make_unique<ShadowMaps>(recipe, context);
}

} // namespace wavepath
