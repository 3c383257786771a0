// What is known of an integrator before there is a device: its name, what it takes, needs, leaves out and gets wrong.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "host/render/settings/memory_item.h"
#include "host/render/settings/render_plan.h"

namespace wavepath {

class Integrator;
class KernelCompiler;
class Workspace;
struct DeviceInfo;
struct PackedScene;
struct ScenePlan;
struct RayCounts;
struct RenderResult;
struct Setting;

// A stage or buffer that the integrator leaves out, and why, for the report.
struct OmittedStage {
  std::string what, why;
};

// What is known of an integrator before there is a device. One constant for each stands in its folder.
struct IntegratorKind {
  std::string_view name;    // value of --integrator
  std::string_view summary; // for --help: one clause
  // Names of the settings that it supports besides those that all support: others are refused.
  std::span<const std::string_view> settings{};
  std::span<const std::string_view> aovs{};       // values of --aov besides those of all
  std::span<const std::string_view> lacks_aovs{}; // values of --aov of all that it cannot give
  bool finds_light = true;                        // false: its picture is the unoccluded fraction, whatever the lights
  bool traces_paths = true;                       // false: a sample is a frame, which reaches the film as a whole
  bool walks_light_tree = true;                   // false: it picks lights by power, however many there are
  bool passes_panes = false; // its shadow rays pass thin smooth panes, if paths may have more than one bounce
  bool nests_bodies = false; // its paths know all bodies that they are in (kLobeNested), not the last one alone
  bool sorts_hits = false;   // rays that hit and rays that escape are shaded by kernels of their own
  bool splats = false;       // it has light paths, which bring light to any pixel of the film
  std::uint64_t light_training_bytes = 0; // of training for light selection; 0 = it has none
  std::uint64_t sky_training_bytes = 0;   // of training for parts of an environment map; likewise
  bool measures_depth_cut = false; // the light beyond --max-depth is measured, and told in the first sentence of bias()
  // Stages that find the first hits, by whose time integrators are compared.
  std::span<const std::string_view> first_hit_stages{};

  // Rows that it adds to the table of settings, which others may take as well. Null = none.
  std::vector<Setting> (*rows)() = nullptr;
  // Throws UsageError where values of its settings do not go together; null = they always do.
  void (*check)(const RenderPlan& settings) = nullptr;
  // Whether a setting that it supports has an effect beside the others; null = it has.
  bool (*has_effect)(const RenderPlan& settings, std::string_view setting) = nullptr;
  // Why it cannot render this scene so; empty = it can. Null = it can render any.
  std::string (*unsupported_reason)(const RenderPlan& settings, const PackedScene& scene) = nullptr;
  // kFeature bits of its kernels, besides those of the scene and of RenderPlan::adaptive.
  gpu::Feature (*features)(const RenderPlan& settings) = nullptr;
  // Begins compiling for a scene of these kFeature bits, before the scene is there. A wrong guess costs time alone.
  void (*start_kernels)(KernelCompiler& kernels, const DeviceInfo& device, gpu::Feature features,
                        const RenderPlan& settings) = nullptr;
  // Device memory that a path in flight takes, for the kFeature bits given, and the largest record of one in any
  // buffer.
  std::uint64_t (*bytes_per_slot)(gpu::Feature features, const RenderPlan& settings) = nullptr;
  std::uint64_t (*largest_record)(const RenderPlan& settings) = nullptr;
  // Optional parts of bytes_per_slot(), by name, itemised for `info`. Null = none.
  std::vector<MemoryItem> (*slot_items)(gpu::Feature features, const RenderPlan& settings) = nullptr;
  // Paths that a pixel takes in every wave.
  std::uint32_t (*slots_per_pixel)(const RenderPlan& settings) = nullptr;
  // Device memory that a pixel takes besides paths and film.
  std::uint64_t (*bytes_per_pixel)(const RenderPlan& settings) = nullptr;
  // Device memory besides, by name, at most; of no bytes where this scene has no use for it. Null = none.
  std::vector<MemoryItem> (*items)(const RenderPlan& settings, const ScenePlan& scene, gpu::Feature features) = nullptr;
  // Whether the picture converges to something else than the light of all paths up to --max-depth.
  bool (*is_biased)(const RenderPlan& settings) = nullptr;
  // What of the light is approximated or missing, a sentence each; the first one is about long paths.
  std::vector<std::string> (*bias)(const RenderPlan& settings, const RenderResult& result) = nullptr;
  std::vector<OmittedStage> (*omitted)(const RenderPlan& settings) = nullptr;
  // Of its own settings as they were used, for the stats document; null if it has none.
  nlohmann::ordered_json (*stats)(const RenderPlan& settings, const PackedScene& scene,
                                  const RenderResult& result) = nullptr;
  std::unique_ptr<Integrator> (*make)(Workspace& workspace, KernelCompiler& kernels) = nullptr;

  // Of a kind that stands for the best of others (host/render/integrator_choice.h): the candidates, first the one that
  // is taken without a pilot. Null for all others.
  std::vector<RenderPlan> (*candidates)(const RenderPlan& settings, const PackedScene& scene) = nullptr;
  // Of such a candidate: what these rays cost, on a CPU device or another; camera rays of path tracing are the unit.
  double (*work)(const RenderPlan& settings, const RayCounts& rays, bool cpu) = nullptr;
};

// All of them, the default first. Defined by host/integrators/factory.cpp, which alone knows their names.
std::span<const IntegratorKind* const> integrators();
const IntegratorKind& default_integrator();
// Null if there is none of that name.
const IntegratorKind* find_integrator(std::string_view name);

// Whether a setting that not all integrators take is one of this one's.
bool supports(const IntegratorKind& kind, std::string_view setting);

} // namespace wavepath
