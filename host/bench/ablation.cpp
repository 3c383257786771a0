#include "host/bench/ablation.h"

#include "host/bench/summary.h"
#include "host/scene/pack/features.h"

namespace wavepath {

std::vector<AblationRow> ablate(Device& device, const PackedScene& scene, const View& view, const RenderPlan& settings,
                                WarmLoop& base, std::uint32_t spp, std::uint32_t repetitions,
                                const std::function<void(const std::string&)>& progress) {
  std::vector<AblationRow> rows;
  const auto measure = [&](const std::string& what, std::uint64_t data_bytes, const RenderPlan& variant) {
    progress("with " + what);
    WarmLoop rival = make_loop(device, scene, view, variant);
    std::vector<double> without, with;
    for (std::uint32_t i = 0; i < repetitions; ++i) {
      without.push_back(time_render(base, spp).seconds);
      with.push_back(time_render(rival, spp).seconds);
    }
    const double base_ms = 1e3 * summarize(without).median;
    rows.push_back({what, base_ms * (ratio_of_medians(with, without) - 1.0), base_ms,
                    static_cast<std::int64_t>(rival.loop->memory().total() + data_bytes) -
                        static_cast<std::int64_t>(base.loop->memory().total()),
                    1e3 * (rival.compile_seconds - base.compile_seconds)});
  };
  std::uint64_t all_bytes = 0;
  for (const LeftOut& entry : scene.left_out) {
    all_bytes += entry.bytes;
    if (!entry.feature) continue; // no code, only data
    RenderPlan variant = settings;
    variant.kernels.added = entry.feature;
    measure(entry.what, entry.bytes, variant);
  }
  RenderPlan generic = settings;
  generic.specialize = false;
  generic.kernels.added = gpu::kLobesAll; // which generic kernels of a scene without layers do without
  measure("everything (generic kernels)", all_bytes, generic);
  return rows;
}

} // namespace wavepath
