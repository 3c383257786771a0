// Irregular z-buffer (Johnson et al. 2005; Aila and Laine 2004; Wyman et al. 2015): the shadow rays of a wave are
// listed in cells of their light's view, and every triangle is put against the cells that it covers, where it is tested
// with each ray listed. No map has texels that rays would have to share, so that the shadows are those of tracing, to
// the bit.
#include <array>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/integrators/hybrid/shadows/kinds.h"
#include "host/integrators/hybrid/shadows/light_cells.h"
#include "host/integrators/hybrid/shadows/look_up_technique.h"
#include "host/integrators/hybrid/shadows/map_size.h"
#include "host/integrators/hybrid/shadows/scene_fit.h"
#include "host/integrators/hybrid/shadows/times.h"
#include "kernels/hybrid/shadows/izb_answer.spv.h"
#include "kernels/hybrid/shadows/izb_list.spv.h"
#include "kernels/hybrid/shadows/izb_test.spv.h"
#include "kernels/hybrid/shadows/izb_types.h"
#include "kernels/path/path_types.h"

namespace wavepath {
namespace {

using enum BindingKind;

enum IzbStage : std::size_t { kList, kTest, kAnswer, kIzbStageCount };
const std::array<KernelCode, kIzbStageCount> kIzbStages = {{{kShadowLookUpStage, wavepath_izb_list_spv},
                                                            {kShadowLookUpStage, wavepath_izb_test_spv},
                                                            {kShadowLookUpStage, wavepath_izb_answer_spv}}};
constexpr std::array<std::size_t, kIzbStageCount> kIzbOrder = {kTest, kAnswer, kList};

enum IzbBuffer : std::size_t { kIzbFrameData, kIzbViews, kIzbLightViews, kCells, kLinks, kItems };
const std::vector<BufferRule> kIzbRules = {{"frame", nullptr, {{gpu::kBindShadowFrame, uniform}}},
                                           {"views", nullptr, {{gpu::kBindShadowViews, texels_rgba32f}}},
                                           {"lights", nullptr, {{gpu::kBindShadowLights, texels_rg32ui}}},
                                           {"cells", nullptr, {{gpu::kBindIzbCells, storage}}},
                                           {"links", nullptr, {{gpu::kBindIzbLinks, storage}}},
                                           {"items", nullptr, {{gpu::kBindIzbItems, texels_rgba32ui}}}};

const KernelProgram kIzbProgram = {kIzbStages, kIzbOrder, [] { return look_up_layout(kIzbRules); }};

std::uint64_t shadow_rays(const std::vector<Binding>& shared) {
  for (const Binding& binding : shared)
    if (binding.slot == gpu::kBindShadowRays) return binding.buffer->bytes() / sizeof(gpu::ShadowRay);
  return 0;
}

class IrregularZ : public LookUpTechnique {
public:
  explicit IrregularZ(const ShadowContext& context)
      : LookUpTechnique(context, kIzbRules), chunks_(make_chunks(context.workspace.scene)) {}

  void change(const View& view, const RenderPlan& settings, const std::vector<Binding>& shared) override {
    start_kernels(view, settings);
    make_views(with_filter_margin(view, settings), settings.shadow_size);
    gpu::ShadowFrame frame{};
    frame.size = size_;
    frame.ambient = static_cast<float>(settings.shadow_ambient);
    upload_frame(frame);
    buffers_[kLinks] = Buffer(workspace_.device, shadow_rays(shared) * gpu::kIzbLinkWords * sizeof(std::uint32_t));
    bind(shared);
  }

  void build(WaveQueue&, std::uint32_t) override {} // lists are those of waves

  // Work in slices of as many items as a dispatch takes; the loop keeps waves, and so lists, as short as they have to
  // be.
  void record_look_up(Commands& commands, std::size_t band, const gpu::Wave& wave) override {
    const KernelSet& kernels = kernels_.best(need_);
    const std::uint32_t rays = groups_for(std::uint64_t{wave.pixel_count} * wave.sample_count);
    commands.bind(*sets_[band]);
    commands.dispatch(kernels[kList], rays, &wave);
    commands.barrier();
    for (std::uint32_t first = 0; first < item_count_; first += gpu::kIzbItemsOfDispatch) {
      gpu::Wave items = wave;
      items.first_film_pixel = first;
      commands.dispatch(kernels[kTest], groups_for(std::min(item_count_ - first, gpu::kIzbItemsOfDispatch)), &items);
    }
    commands.barrier();
    commands.dispatch(kernels[kAnswer], rays, &wave);
  }

  std::uint32_t view_count() const override { return static_cast<std::uint32_t>(views_.size()); }
  void describe(ShadowReport& report) const override {
    report.size = size_;
    report.longest_list = download<std::uint32_t>(buffers_[kCells], 1).front();
  }

private:
  // Views, the cells that triangles cover in them, and empty lists.
  void make_views(const View& world, std::uint32_t set) {
    const PackedScene& scene = workspace_.scene;
    ShadowFit fit = fit_to_scene(scene, chunks_, world);
    size_ = set;
    find_views(fit);
    size_ = size_that_fits(set, [&](std::uint32_t size) { return fits(bytes_at(size)); });
    const std::vector<glm::uvec2> light_views = find_views(fit);
    check_fits(bytes_at(size_));
    const std::uint64_t cells_of_view = std::uint64_t{size_} * size_;
    for (std::size_t i = 0; i < views_.size(); ++i) {
      views_[i].first_texel = static_cast<std::uint32_t>(i * cells_of_view);
      bound_rounding(views_[i], size_, fit.lo, fit.hi);
    }
    const std::vector<glm::uvec4> items = cover_cells(scene, views_, size_);
    const DeviceInfo& info = workspace_.device.info();
    if (items.size() > info.max_texels(16))
      throw Error(info.name, fmt::format("holds {} pieces of triangles, of {}", info.max_texels(16), items.size()),
                  "use a smaller --shadow-size");
    item_count_ = static_cast<std::uint32_t>(items.size());
    buffers_[kItems] = upload(workspace_.device, items);
    buffers_[kIzbViews] = upload(workspace_.device, views_);
    buffers_[kIzbLightViews] = upload(workspace_.device, light_views);
    buffers_[kCells] = Buffer(workspace_.device, bytes_at(size_));
    buffers_[kCells].fill_zero();
  }

  // Views of that size, and which light has which.
  std::vector<glm::uvec2> find_views(ShadowFit& fit) {
    const PackedScene& scene = workspace_.scene;
    fit.size = size_;
    std::vector<glm::uvec2> light_views(std::max<std::size_t>(scene.lights.size(), 1), glm::uvec2(gpu::kNone, 0));
    views_.clear();
    for (const ShadowSource& source : sources_) {
      const std::vector<gpu::ShadowView> views = usual_views(fit, source);
      for (const std::uint32_t light : source.lights) light_views[light] = glm::uvec2(views_.size(), views.size());
      views_.insert(views_.end(), views.begin(), views.end());
    }
    return light_views;
  }

  std::uint64_t bytes_at(std::uint32_t size) const {
    const std::uint64_t cells = std::uint64_t{size} * size * views_.size();
    return (gpu::kIzbFirstCell + gpu::kIzbCellWords * cells) * sizeof(std::uint32_t);
  }
  std::uint64_t most_bytes() const {
    const DeviceInfo& info = workspace_.device.info();
    return std::min({info.max_storage_range, info.max_allocation, info.memory_bytes});
  }
  bool fits(std::uint64_t bytes) const { return bytes <= most_bytes(); }

  void check_fits(std::uint64_t bytes) const {
    if (fits(bytes)) return;
    throw Error(workspace_.device.info().name,
                fmt::format("cannot hold lists of {} views of {}x{} cells, {:.0f} MiB; at most {:.0f} MiB",
                            views_.size(), size_, size_, static_cast<double>(bytes) / 1048576.0,
                            static_cast<double>(most_bytes()) / 1048576.0),
                "use a smaller --shadow-size or --shadows traced");
  }

  std::vector<Chunk> chunks_;
  std::vector<gpu::ShadowView> views_;
  std::uint32_t size_ = 0; // cells along a side of a view
  std::uint32_t item_count_ = 0;
};

constexpr std::array<std::string_view, 1> kIzbSettings = {"shadow-size"};

} // namespace

constinit const ShadowKind kShadowIzb = {
    .name = "izb",
    .summary = "triangles tested with the shadow rays listed in the cells they cover (Johnson et al. 2005)",
    .sources = kPunctualSources,
    .settings = kIzbSettings,
    .program = &kIzbProgram,
    .make = [](const ShadowContext& context) -> std::unique_ptr<ShadowTechnique> {
      return std::make_unique<IrregularZ>(context);
    },
};

} // namespace wavepath
