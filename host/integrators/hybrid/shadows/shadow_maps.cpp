#include "host/integrators/hybrid/shadows/shadow_maps.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/integrators/hybrid/shadows/cookie.h"
#include "host/integrators/hybrid/shadows/look_up_technique.h"
#include "host/integrators/hybrid/shadows/map_size.h"
#include "host/integrators/hybrid/shadows/receiver_planes.h"
#include "host/integrators/hybrid/shadows/scene_fit.h"
#include "host/integrators/hybrid/shadows/taps.h"
#include "host/integrators/hybrid/shadows/times.h"
#include "host/integrators/hybrid/shadows/virtual_pages.h"
#include "host/render/settings/shadow_settings.h"
#include "kernels/hybrid/shadows/cookie_types.h"
#include "kernels/hybrid/shadows/planar_types.h"
#include "kernels/hybrid/shadows/shadow_casters_vert.spv.h"
#include "kernels/hybrid/shadows/shadow_ids_frag.spv.h"
#include "kernels/hybrid/shadows/shadow_map_frag.spv.h"
#include "kernels/hybrid/shadows/shadow_map_vert.spv.h"
#include "kernels/hybrid/shadows/shadow_midpoint_frag.spv.h"
#include "kernels/hybrid/shadows/shadow_trace.spv.h"
#include "kernels/hybrid/shadows/shadow_trace_pages.spv.h"
#include "kernels/hybrid/shadows/shadow_trace_pages_query.spv.h"
#include "kernels/hybrid/shadows/shadow_trace_query.spv.h"

namespace wavepath {
namespace {

using enum BindingKind;

enum MapBuffer : std::size_t {
  kMapFrameData,
  kMapViews,
  kMapLightViews,
  kDepths,
  kIds,
  kTaps,
  kFiltered,
  kScratch,
  kMapCounts,
  kPlanes,
  kCookie
};

const std::vector<BufferRule> kMapRules = {
    {"frame", nullptr, {{gpu::kBindShadowFrame, uniform}}},
    {"views", nullptr, {{gpu::kBindShadowViews, texels_rgba32f}}},
    {"views of lights", nullptr, {{gpu::kBindShadowLights, texels_rg32ui}}},
    {"depths", nullptr, {{gpu::kBindShadowDepths, texels_r32f}, {gpu::kBindShadowDepthWords, storage}}},
    {"triangles", nullptr, {{gpu::kBindShadowIds, texels_rg32ui}, {gpu::kBindShadowIdWords, storage}}},
    {"taps", nullptr, {{gpu::kBindShadowTaps, texels_rgba32f}}},
    {"filtered", nullptr, {{gpu::kBindShadowFiltered, texels_rgba32f}, {gpu::kBindShadowFilteredWords, storage}}},
    {"scratch", nullptr, {{gpu::kBindShadowScratch, storage}}},
    {"counts", nullptr, {{gpu::kBindShadowCounts, storage}}},
    {"planes", nullptr, {{gpu::kBindPlanarPairs, texels_rgba32f}}},
    {"cookie", nullptr, {{gpu::kBindShadowCookie, texels_rgba32f}}}};

const std::array<AttachmentInfo, 3> kMapAttachments{
    {{.name = "shadow map", .format = ImageFormat::r32f, .clear = {.colour = {gpu::kFar, 0.0f, 0.0f, 0.0f}}},
     {.name = "depth", .format = ImageFormat::depth32f, .clear = {.depth = 0.0f}},
     {.name = "shadow map's triangles", .format = ImageFormat::rg32ui, .clear = {.words = {gpu::kNone, gpu::kNone}}}}};
std::span<const AttachmentInfo> attachments(bool ids) { return std::span(kMapAttachments).first(ids ? 3 : 2); }

const KernelCode kTracer{kShadowBuildStage, wavepath_shadow_trace_spv, {}, wavepath_shadow_trace_query_spv};
const KernelCode kPageTracer{
    kShadowBuildStage, wavepath_shadow_trace_pages_spv, {}, wavepath_shadow_trace_pages_query_spv};
const RasterCode kDepthCode{"shadow map", wavepath_shadow_map_vert_spv, wavepath_shadow_map_frag_spv};
const RasterCode kMidpointCode{"shadow map", wavepath_shadow_map_vert_spv, wavepath_shadow_midpoint_frag_spv};
const RasterCode kCasterCode{"shadow casters", wavepath_shadow_casters_vert_spv, wavepath_shadow_map_frag_spv};
const RasterCode kIdCode{"shadow map", wavepath_shadow_map_vert_spv, wavepath_shadow_ids_frag_spv};

constexpr std::uint64_t kMapFirstTriangles = 1 << 16, kFirstTexels = 1 << 16; // of a slice: guesses
constexpr std::uint32_t kTimedBuilds = 5; // frames that build anew what could be kept, so that the time has a median
constexpr std::uint32_t kReducedPixels = 1u << 18; // of a submission
constexpr std::uint32_t kPageTexels = gpu::kShadowPage * gpu::kShadowPage;

// Receiving planes, as kernels/hybrid/shadows/planar.glsl reads them.
std::vector<gpu::PlanarPair> planes_of(const PackedScene& scene) {
  std::vector<gpu::PlanarPair> planes;
  for (const ReceiverPlane& plane : receiver_planes(scene)) {
    gpu::PlanarPair pair{};
    pair.normal = glm::vec3(plane.normal);
    pair.offset = static_cast<float>(plane.offset);
    pair.tolerance = static_cast<float>(plane_tolerance(scene));
    planes.push_back(pair);
  }
  const auto count = static_cast<std::uint32_t>(planes.size());
  planes.resize(std::max<std::size_t>(planes.size(), 1));
  planes.front().source = count;
  return planes;
}

class ShadowMaps : public LookUpTechnique {
public:
  explicit ShadowMaps(const ShadowContext& context)
      : LookUpTechnique(context, kMapRules),
        recipe_(*context.kind.maps),
        chunks_(make_chunks(context.workspace.scene)) {
    buffers_[kPlanes] =
        upload(workspace_.device, recipe_.casters ? planes_of(workspace_.scene) : std::vector<gpu::PlanarPair>());
  }

  void change(const View& view, const RenderPlan& settings, const std::vector<Binding>& shared) override {
    settings_ = settings;
    const View seen = with_filter_margin(view, settings);
    make_views(seen);
    settings_.shadow_size = size_that_fits(settings.shadow_size, [&](std::uint32_t size) { return fits(size); });
    if (settings_.shadow_size != settings.shadow_size) make_views(seen);
    start_kernels(view, settings);
    allocate();
    shared_ = shared;
    bind_all();
    builds_left_ = kTimedBuilds;
  }

  void build(WaveQueue& queue, std::uint32_t) override {
    if (recipe_.pages) return build_pages(queue);
    if (recipe_.fit_to_frame) fit_to_frame(queue);
    if (builds_left_ == 0) return;
    if (!recipe_.fit_to_frame) --builds_left_;
    if (is_raster())
      draw(queue);
    else
      trace(queue);
    filter(queue);
  }

  std::uint32_t view_count() const override { return static_cast<std::uint32_t>(views_.size()); }
  void describe(ShadowReport& report) const override {
    report.size = settings_.shadow_size;
    report.nearest = report_.nearest;
    report.farthest = report_.farthest;
    report.pages = pages_.total();
    report.resident_pages = pages_.resident();
    if (!recipe_.counts) return;
    const gpu::ShadowCounts counts = download<gpu::ShadowCounts>(buffers_[kMapCounts], 1).front();
    const auto whole = [](const gpu::uint* parts) { return std::uint64_t{parts[1]} << 32 | parts[0]; };
    report.answers = RayAnswers{.answered = whole(counts.answered), .traced = whole(counts.left)};
  }

private:
  bool is_raster() const { return settings_.shadow_source == kShadowSourceRaster; }
  // Number of texels that are reserved when views are made.
  std::uint64_t texels() const {
    if (recipe_.pages) return 0; // none yet
    return std::uint64_t{settings_.shadow_size} * settings_.shadow_size * views_.size();
  }
  std::uint32_t scratch_words() const {
    if (recipe_.pages) return pages_.total() + page_capacity_;
    return recipe_.frame_words ? recipe_.frame_words(view_count(), settings_) : 0;
  }

  // The frusta, and which light has which.
  void make_views(const View& world) {
    const PackedScene& scene = workspace_.scene;
    View view = world;
    view.position -= scene.origin;
    ShadowFit fit = fit_to_scene(scene, chunks_, world);
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
    pages_ = recipe_.pages ? VirtualPages(view_count(), settings_.shadow_size) : VirtualPages();
    page_capacity_ = 0;
    const std::size_t view_size =
        recipe_.pages ? pages_.pages_of_view() : std::size_t{settings_.shadow_size} * settings_.shadow_size;
    for (std::size_t i = 0; i < views_.size(); ++i) views_[i].first_texel = static_cast<std::uint32_t>(i * view_size);
    usual_views_ = views_;
  }

  // Limit of texels. `largest`: bytes a texel of the largest buffer.
  std::uint64_t most_texels(std::uint64_t largest) const {
    const DeviceInfo& info = workspace_.device.info();
    return std::min({info.max_texels(16), info.max_storage_range / largest, info.max_allocation / largest,
                     std::uint64_t{gpu::kNone}});
  }

  struct TexelBytes {
    std::uint64_t ids, filtered, scratch; // of a buffer each
    std::uint64_t largest, all;           // of one, depths included; of all and of what is rasterized
  };
  TexelBytes texel_bytes() const {
    TexelBytes bytes{recipe_.ids ? sizeof(glm::uvec2) : 0,
                     recipe_.filtered_bytes ? recipe_.filtered_bytes(settings_) : 0,
                     recipe_.scratch_bytes ? recipe_.scratch_bytes(settings_) : 0, 0, 0};
    bytes.largest = std::max({std::uint64_t{sizeof(float)}, bytes.ids, bytes.filtered, bytes.scratch});
    bytes.all =
        (is_raster() ? 3 : 1) * sizeof(float) + (is_raster() ? 2 : 1) * bytes.ids + bytes.filtered + bytes.scratch;
    return bytes;
  }

  bool fits(std::uint32_t size) const {
    const TexelBytes bytes = texel_bytes();
    const std::uint64_t all = recipe_.pages ? 0 : std::uint64_t{size} * size * views_.size();
    return all <= most_texels(bytes.largest) && all * bytes.all <= workspace_.device.info().memory_bytes;
  }

  // Throws before anything is allocated.
  void check_fits() const {
    const DeviceInfo& info = workspace_.device.info();
    if (is_raster() && !recipe_.pages && views_.size() > info.max_image_layers)
      throw Error(info.name,
                  fmt::format("rasterizes {} shadow maps at most, of {}", info.max_image_layers, views_.size()),
                  "use --shadow-source rays or --shadows traced");
    if (fits(settings_.shadow_size)) return;
    const TexelBytes bytes = texel_bytes();
    throw Error(info.name,
                fmt::format("cannot hold {} shadow maps of {}x{} texels, {:.0f} MiB; at most {} texels", views_.size(),
                            settings_.shadow_size, settings_.shadow_size,
                            static_cast<double>(texels() * bytes.all) / 1048576.0, most_texels(bytes.largest)),
                "use a smaller --shadow-size or --shadows traced");
  }

  void allocate() {
    check_fits();
    const TexelBytes bytes = texel_bytes();
    const bool raster = is_raster();
    const glm::uvec3 made_for(settings_.shadow_size, views_.size(), raster);
    if (made_for != made_for_) {
      made_for_ = glm::uvec3(0);
      target_.reset(); // the device may not hold both at once
      Device& device = workspace_.device;
      buffers_[kDepths] = Buffer(device, texels() * sizeof(float));
      buffers_[kIds] = Buffer(device, texels() * bytes.ids);
      buffers_[kFiltered] = Buffer(device, texels() * bytes.filtered);
      buffers_[kScratch] = Buffer(device, texels() * bytes.scratch + scratch_words() * sizeof(std::uint32_t));
      if (raster) {
        const std::uint32_t side = recipe_.pages ? pages_.tile_size() : settings_.shadow_size;
        target_ = std::make_unique<RasterTarget>(device, side, side, attachments(recipe_.ids),
                                                 recipe_.pages ? 1 : view_count());
      }
      made_for_ = recipe_.pages ? glm::uvec3(0) : made_for; // pages come anew
    }
    buffers_[kMapViews] = upload(workspace_.device, drawn_views());
    buffers_[kMapLightViews] = upload(workspace_.device, light_views_);
    const std::vector<glm::vec4> taps =
        recipe_.taps ? filter_taps(settings_.shadow_pattern, settings_.shadow_taps) : std::vector<glm::vec4>(1);
    buffers_[kTaps] = upload(workspace_.device, taps);
    const auto tap_count = recipe_.taps ? static_cast<std::uint32_t>(taps.size()) : settings_.shadow_taps;
    if (!recipe_.cookie)
      buffers_[kCookie] = Buffer(workspace_.device, 0);
    else if (settings_.shadow_cookie != cookie_)
      buffers_[kCookie] = upload(workspace_.device, read_cookie(settings_.shadow_cookie, workspace_.device.info()));
    cookie_ = settings_.shadow_cookie;
    buffers_[kMapCounts] = upload(workspace_.device, std::vector<gpu::ShadowCounts>(recipe_.counts ? 1 : 0));
    upload_frame(shadow_frame(tap_count));
  }

  // All views, and behind them what is drawn at once of virtual ones.
  std::vector<gpu::ShadowView> drawn_views() const {
    std::vector<gpu::ShadowView> views = views_;
    for (std::size_t i = 0; recipe_.pages && i < views_.size(); ++i)
      for (std::uint32_t tile = 0; tile < pages_.tiles_of_view(); ++tile)
        views.push_back(pages_.view_of(tile, views_[i]));
    return views;
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

  void bind_all() {
    bind(shared_);
    make_pipeline();
  }

  void make_pipeline() {
    pipeline_.reset();
    behind_.reset();
    tracer_.reset();
    bind_draws({}); // which look at no frame
    const auto constants = specialization(need_.config, workspace_.device.info());
    if (!is_raster()) {
      const KernelCode& code = recipe_.pages ? kPageTracer : kTracer;
      const bool by_query = workspace_.on_device->queries.has_value();
      tracer_.emplace(workspace_.device, code.name, code.build(false, by_query), *raster_set_, constants);
      return;
    }
    RasterState state;
    if (settings_.shadow_bias == gpu::kBiasSecondDepth) state.cull = Cull::front;
    pipeline_.emplace(workspace_.device,
                      recipe_.casters ? kCasterCode
                      : recipe_.ids   ? kIdCode
                                      : kDepthCode,
                      attachments(recipe_.ids), state, *raster_set_, constants);
    if (settings_.shadow_bias == gpu::kBiasMidpoint)
      behind_.emplace(workspace_.device, kMidpointCode, attachments(false), state, *raster_set_, constants);
  }

  void draw(WaveQueue& queue) {
    const std::uint64_t most = triangles_a_slice_.next_frame();
    draw_views(queue, most, *pipeline_);
    if (behind_) draw_views(queue, most, *behind_);
  }

  void draw_views(WaveQueue& queue, std::uint64_t most, const RasterPipeline& pipeline) {
    for (std::uint32_t view = 0; view < views_.size(); ++view) {
      const bool last = view + 1 == views_.size();
      draw_view(queue, most, pipeline, views_[view], view, view, [this, last](Commands& commands) {
        if (!last) return;
        target_->image(0).copy_to(commands.handle(), buffers_[kDepths]);
        if (recipe_.ids) target_->image(2).copy_to(commands.handle(), buffers_[kIds]);
      });
    }
  }

  // `index`: where the view stands in the buffer of views. `copy`: recorded behind the last triangle.
  void draw_view(WaveQueue& queue, std::uint64_t most, const RasterPipeline& pipeline, const gpu::ShadowView& view,
                 std::uint32_t index, std::uint32_t layer, const std::function<void(Commands&)>& copy) {
    gpu::Wave wave{};
    wave.first_pixel = index;
    const SlicedPass pass{target_.get(), &pipeline, raster_set_.get(), &wave, layer, kShadowBuildStage};
    draw_in_slices(
        queue, pass, draws_within(chunks_, frustum_of(view)), most, [](Commands&) {}, copy,
        [this](double seconds) { triangles_a_slice_.note(seconds); });
  }

  // Pages stay once they are there, because views stay: a frame that asks for no other one costs a look at its points.
  void build_pages(WaveQueue& queue) {
    queue.drain();
    const std::uint32_t before = pages_.resident();
    const std::uint64_t most = most_texels(sizeof(float)) / kPageTexels; // the rest is traced
    pages_.add(reduce_frame(queue, 1, std::vector<std::uint32_t>(pages_.total()), 0), most);
    if (pages_.resident() > page_capacity_) reserve_pages(queue, before, most);
    const std::vector<std::uint32_t> table = pages_.table();
    buffers_[kScratch].write(table.data(), table.size() * sizeof(std::uint32_t));
    if (is_raster())
      draw_pages(queue, before);
    else
      trace_pages(queue, before);
  }

  // Half as many more than are needed, so that it is seldom called.
  void reserve_pages(WaveQueue& queue, std::uint32_t before, std::uint64_t most) {
    Device& device = workspace_.device;
    page_capacity_ =
        static_cast<std::uint32_t>(std::min<std::uint64_t>(most, pages_.resident() + pages_.resident() / 2));
    Buffer depths(device, std::uint64_t{page_capacity_} * kPageTexels * sizeof(float));
    if (before > 0) {
      const std::uint64_t bytes = std::uint64_t{before} * kPageTexels * sizeof(float);
      queue.submit([&](Commands& commands) { commands.copy(buffers_[kDepths], depths, bytes); }, {});
      queue.drain();
    }
    buffers_[kDepths] = std::move(depths);
    buffers_[kScratch] = Buffer(device, scratch_words() * sizeof(std::uint32_t));
    bind_all();
  }

  void draw_pages(WaveQueue& queue, std::uint32_t first_slot) {
    const std::uint64_t most = triangles_a_slice_.next_frame();
    for (const PageTile& tile : pages_.tiles(first_slot)) {
      const std::uint32_t index = view_count() + tile.view * pages_.tiles_of_view() + tile.number;
      draw_view(
          queue, most, *pipeline_, pages_.view_of(tile.number, views_[tile.view]), index, 0,
          [&](Commands& commands) { target_->image(0).copy_to(commands.handle(), buffers_[kDepths], tile.pages); });
    }
  }

  void trace_pages(WaveQueue& queue, std::uint32_t first_slot) {
    const std::uint64_t most = texels_a_slice_.next_frame(), end = std::uint64_t{pages_.resident()} * kPageTexels;
    for (std::uint64_t first = std::uint64_t{first_slot} * kPageTexels; first < end; first += most) {
      gpu::Wave wave{};
      wave.first_pixel = static_cast<std::uint32_t>(first);
      wave.pixel_count = static_cast<std::uint32_t>(std::min(most, end - first));
      submit_tracing(queue, wave);
    }
  }

  void submit_tracing(WaveQueue& queue, const gpu::Wave& wave) {
    const auto record = [&](Commands& commands) {
      commands.bind(*raster_set_);
      commands.dispatch(*tracer_, groups_for(wave.pixel_count), &wave);
    };
    queue.submit(record, {.stage = kShadowBuildStage,
                          .done = [this](const Finished& finished) { texels_a_slice_.note(finished.seconds); }});
  }

  // Views of this frame. The host waits for what it sees, and so for all that looks maps up.
  void fit_to_frame(WaveQueue& queue) {
    queue.drain();
    views_ = usual_views_;
    upload_views();
    const auto reduce = [&](std::size_t stage, const std::vector<std::uint32_t>& words, std::uint32_t parts) {
      return reduce_frame(queue, stage, words, parts);
    };
    recipe_.fit_to_frame({reduce, settings_, views_, report_});
    upload_views();
  }

  // Nothing is in flight, before and after.
  std::vector<std::uint32_t> reduce_frame(WaveQueue& queue, std::size_t stage, const std::vector<std::uint32_t>& words,
                                          std::uint32_t parts) {
    buffers_[kScratch].write(words.data(), words.size() * sizeof(std::uint32_t));
    const std::uint32_t pixels = settings_.width * settings_.height;
    for (std::uint32_t first = 0; first < pixels; first += kReducedPixels) {
      gpu::Wave wave{};
      wave.first_pixel = first;
      wave.pixel_count = std::min(kReducedPixels, pixels - first);
      wave.sample_count = parts;
      const auto record = [&](Commands& commands) {
        commands.bind(*sets_.front());
        commands.dispatch(kernels_.best(need_)[stage], groups_for(wave.pixel_count), &wave);
      };
      queue.submit(record, {.stage = "shadow bounds"});
    }
    queue.drain();
    return download<std::uint32_t>(buffers_[kScratch], words.size());
  }

  void upload_views() { buffers_[kMapViews].write(views_.data(), views_.size() * sizeof(gpu::ShadowView)); }

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
      queue.submit(record, {.stage = kShadowBuildStage,
                            .done = [&length](const Finished& finished) { length.note(finished.seconds); }});
      first += wave.pixel_count;
    }
  }

  const ShadowMapRecipe& recipe_;
  std::vector<Chunk> chunks_;
  RenderPlan settings_;
  std::vector<gpu::ShadowView> views_, usual_views_; // of this frame, before it was fitted to
  std::vector<glm::uvec2> light_views_;              // by light: first view, how many
  glm::uvec3 made_for_{0};                           // size, views, whether they are rasterized
  std::optional<RasterPipeline> pipeline_, behind_;  // behind_: of what lies behind the nearest surface
  std::optional<Kernel> tracer_;
  SliceLength triangles_a_slice_{kMapFirstTriangles}, texels_a_slice_{kFirstTexels}, filtered_a_slice_{kFirstTexels};
  std::uint32_t builds_left_ = 0;
  std::optional<std::string> cookie_; // that was read
  ShadowReport report_;
  VirtualPages pages_;
  std::uint32_t page_capacity_ = 0;
  std::vector<Binding> shared_;
};

} // namespace

std::vector<Binding> shadow_layout() { return look_up_layout(kMapRules); }

std::unique_ptr<ShadowTechnique> make_shadow_maps(const ShadowContext& context) {
  return std::make_unique<ShadowMaps>(context);
}

} // namespace wavepath
