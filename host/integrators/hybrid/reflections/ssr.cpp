// Reflections in screen space (Sousa, Kasyan and Schulz 2011), by a hierarchical march (Uludag 2014).
#include <algorithm>
#include <array>

#include "host/integrators/hybrid/raster/slices.h"
#include "host/integrators/hybrid/reflections/kinds.h"
#include "host/integrators/hybrid/reflections/reflections.h"
#include "kernels/hybrid/reflections/nearness.spv.h"
#include "kernels/hybrid/reflections/ssr.spv.h"

namespace wavepath {
namespace {

enum ScreenStage : std::size_t { kNearness, kMarch, kScreenStageCount };
const std::array<KernelCode, kScreenStageCount> kScreenStages = {
    {{"nearness", wavepath_nearness_spv}, {"screen-space reflections", wavepath_ssr_spv}}};
constexpr std::array<std::size_t, kScreenStageCount> kScreenOrder = {kMarch, kNearness};

std::vector<Binding> screen_layout() {
  std::vector<Binding> layout = reflection_layout();
  layout.push_back({gpu::kBindNearness, BindingKind::storage, nullptr});
  return layout;
}
const KernelProgram kScreenProgram = {kScreenStages, kScreenOrder, screen_layout};

constexpr const char* kScreenStageName = "screen-space reflections";
constexpr double kThickness = 0.05;                   // of the scene's radius
constexpr std::uint32_t kLevelCells = 1u << 20;       // of a dispatch, which reads four depths for each
constexpr std::uint64_t kFirstMarchPixels = 1u << 12; // of a slice: a guess

struct Level {
  std::uint32_t width, height;
  std::uint32_t cells() const { return width * height; }
};

// The finest first, down to one cell. As level_size() of kernels/hybrid/reflections/screen.glsl has them.
std::vector<Level> levels_of(std::uint32_t width, std::uint32_t height) {
  std::vector<Level> levels = {{width, height}};
  while (levels.back().cells() > 1) levels.push_back({(levels.back().width + 1) / 2, (levels.back().height + 1) / 2});
  return levels;
}

class ScreenReflections : public Reflections {
public:
  explicit ScreenReflections(const ReflectionContext& context)
      : Reflections(context), pixels_a_slice_(kFirstMarchPixels) {}

  void change(const View& view, const RenderPlan& settings, const KernelConfig& config,
              const std::vector<Binding>& shared) override {
    const double radius = context_.workspace.scene.radius;
    frame_.reach = static_cast<float>(2.0 * radius);
    frame_.thickness = static_cast<float>(kThickness * radius);
    levels_ = levels_of(settings.width, settings.height);
    std::uint64_t cells = 0;
    for (const Level& level : levels_) cells += level.cells();
    reserve(context_.workspace.device, nearness_, cells * sizeof(float));
    Reflections::change(view, settings, config, shared);
  }

  void finish(WaveQueue& queue) override {
    queue.submit([this](Commands& commands) { record_levels(commands); }, {.stage = kScreenStageName});
    submit_pixels(queue, kMarch, kScreenStageName, pixels_a_slice_);
  }

  std::uint64_t bytes() const override { return Reflections::bytes() + nearness_.bytes(); }

protected:
  void add_bindings(std::vector<Binding>& bindings) override {
    bindings.push_back({gpu::kBindNearness, BindingKind::storage, &nearness_});
  }

private:
  void record_levels(Commands& commands) {
    commands.bind(bindings(0));
    for (std::uint32_t level = 0; level < levels_.size(); ++level) {
      commands.barrier();
      gpu::Wave wave{};
      wave.bounce = level;
      for (; wave.first_pixel < levels_[level].cells(); wave.first_pixel += kLevelCells) {
        wave.pixel_count = std::min(kLevelCells, levels_[level].cells() - wave.first_pixel);
        commands.dispatch(kernels()[kNearness], groups_for(wave.pixel_count), &wave);
      }
    }
  }

  std::vector<Level> levels_;
  Buffer nearness_;
  SliceLength pixels_a_slice_;
};

} // namespace

constinit const ReflectionKind kReflectionSsr = {
    .name = "ssr",
    .summary = "found by a march over the picture, which misses what it does not show (Uludag 2014)",
    .program = &kScreenProgram,
    .searches_picture = true,
    .bytes_per_pixel = 6,
    .make = [](const ReflectionContext& context) -> std::unique_ptr<ReflectionTechnique> {
      return std::make_unique<ScreenReflections>(context);
    },
};

} // namespace wavepath
