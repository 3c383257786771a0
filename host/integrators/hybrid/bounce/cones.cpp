// One diffuse bounce by cones through lit voxels (Crassin, Neyret, Sainz, Green and Eisemann 2011).
#include <array>
#include <optional>

#include "host/integrators/hybrid/bounce/catalogue.h"
#include "host/integrators/hybrid/bounce/kinds.h"
#include "host/integrators/hybrid/bounce/lit_voxels.h"
#include "host/integrators/hybrid/reflections/reflections.h"
#include "kernels/hybrid/bounce/bounce_cones.spv.h"

namespace wavepath {
namespace {

const std::array<KernelCode, 1> kConesStages = {{{kBounceConesStage, wavepath_bounce_cones_spv}}};
constexpr std::array<std::size_t, 1> kConesOrder = {0};
const KernelProgram kConesProgram = {kConesStages, kConesOrder, [] {
                                       std::vector<Binding> layout = reflection_layout();
                                       add_voxel_light_layout(layout);
                                       return layout;
                                     }};

constexpr std::uint64_t kFirstConePixels = 1u << 12; // of a slice: a guess

class ConeBounce : public Reflections {
public:
  explicit ConeBounce(const ReflectionContext& context) : Reflections(context), pixels_a_slice_(kFirstConePixels) {}

  void change(const View& view, const RenderPlan& settings, const KernelConfig& config,
              const std::vector<Binding>& shared) override {
    if (lit_for_ != config) {
      lit_for_.reset();
      lit_.reset(); // the device may not hold both
      lit_ = std::make_unique<LitVoxels>(context_.workspace, context_.kernels, config, *context_.voxels);
      lit_for_ = config;
    }
    Reflections::change(view, settings, config, shared);
  }
  bool is_ready() override {
    const bool lit = lit_->is_ready(); // asks for both, so that both are begun
    return Reflections::is_ready() && lit;
  }
  double get_ready() override { return Reflections::get_ready() + lit_->get_ready(); }

  void build(WaveQueue& queue) override { lit_->build(queue); }
  void finish(WaveQueue& queue) override { submit_pixels(queue, 0, kBounceConesStage, pixels_a_slice_); }
  std::uint64_t bytes() const override { return Reflections::bytes() + lit_->bytes(); }

protected:
  void add_bindings(std::vector<Binding>& bindings) override { lit_->add_bindings(bindings); }

private:
  std::unique_ptr<LitVoxels> lit_;
  std::optional<KernelConfig> lit_for_;
  SliceLength pixels_a_slice_;
};

} // namespace

constinit const ReflectionKind kBounceCones = {
    .name = "cones",
    .summary = "gathered by cones through voxels of the lit surfaces (voxel cone tracing, Crassin et al. 2011)",
    .program = &kConesProgram,
    .searches_picture = true,
    .voxels = true,
    .make = [](const ReflectionContext& context) -> std::unique_ptr<ReflectionTechnique> {
      return std::make_unique<ConeBounce>(context);
    },
};

} // namespace wavepath
