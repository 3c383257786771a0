// Description of an integrator that needs no device: its name, settings, memory, limits and known bias.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "host/gpu/device_class.h"
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

// Entry of `left_out` in the stats: a stage or buffer that the integrator did not need, and the reason.
struct OmittedStage {
  std::string what, why;
};

// Description of an integrator. Each integrator defines one constant of this type in its folder. A function pointer may
// be null only where its comment says what null means.
struct IntegratorKind {
  std::string_view name;    // value of --integrator
  std::string_view summary; // one clause, for --help
  // Settings that it supports besides those that every integrator supports: names, or values of Setting::listed_as.
  std::span<const std::string_view> settings{};
  std::span<const std::string_view> aovs{};       // values of --aov that it supports besides the common ones
  std::span<const std::string_view> lacks_aovs{}; // common values of --aov that it does not support
  bool finds_light = true;                        // false: its picture is the unoccluded fraction, whatever the lights
  bool traces_paths = true;                       // false: a sample is a frame, which reaches the film as a whole
  bool walks_light_tree = true;                   // false: it picks lights by power, however many they are
  bool passes_panes = false; // true: its shadow rays pass thin smooth panes, if paths may have several bounces
  // True: a path keeps a list of all bodies that it is in (kLobeNested), not only the last one entered.
  bool nests_bodies = false;
  bool sorts_hits = false;                // true: separate kernels shade hits and escaped rays
  bool splats = false;                    // true: it traces light paths, which add light to any pixel of the film
  std::uint64_t light_training_bytes = 0; // device memory of training for light selection; 0 = it does not train
  std::uint64_t sky_training_bytes = 0;   // device memory of training for parts of the sky; 0 = it does not train
  // True: the light beyond --max-depth is measured, and reported in the first sentence of bias().
  bool measures_depth_cut = false;
  // Names of the stages that find first hits; their time is compared between integrators.
  std::span<const std::string_view> first_hit_stages{};

  // Rows that it adds to the table of settings; other integrators may support them, too. Null = none.
  std::vector<Setting> (*rows)() = nullptr;
  // Throws UsageError if values of its settings contradict each other. Null = no such check.
  void (*check)(const RenderPlan& settings) = nullptr;
  // Tells whether a supported setting has an effect, given the other settings. Null = always.
  bool (*has_effect)(const RenderPlan& settings, std::string_view setting) = nullptr;
  // Reason why it cannot render this scene with these settings; empty = it can. Null = it can render any scene.
  std::string (*unsupported_reason)(const RenderPlan& settings, const PackedScene& scene) = nullptr;
  // kFeature bits that its kernels need besides those of the scene and of adaptive rendering.
  gpu::Feature (*features)(const RenderPlan& settings) = nullptr;
  // Begins compiling for a scene of these expected kFeature bits, before the scene is loaded. A wrong guess costs time
  // but changes no result.
  void (*start_kernels)(KernelCompiler& kernels, const DeviceInfo& device, gpu::Feature features,
                        const RenderPlan& settings) = nullptr;
  // Bytes of device memory of a path in flight; and bytes of the largest record of one path in any buffer. `features`:
  // kFeature bits of the kernels.
  std::uint64_t (*bytes_per_slot)(gpu::Feature features, const RenderPlan& settings) = nullptr;
  std::uint64_t (*largest_record)(const RenderPlan& settings) = nullptr;
  // Optional parts of bytes_per_slot(), itemised for `info`. Null = none.
  std::vector<MemoryItem> (*slot_items)(gpu::Feature features, const RenderPlan& settings) = nullptr;
  // Paths in flight that one sample of a pixel takes in a wave.
  std::uint32_t (*slots_per_pixel)(const RenderPlan& settings) = nullptr;
  // Bytes of device memory of a pixel, besides paths and film.
  std::uint64_t (*bytes_per_pixel)(const RenderPlan& settings) = nullptr;
  // Upper bounds of other device memory, by name; items of 0 bytes are not needed for this scene. Null = none.
  std::vector<MemoryItem> (*items)(const RenderPlan& settings, const ScenePlan& scene, gpu::Feature features) = nullptr;
  // True if the picture converges to something other than the light of all paths up to --max-depth.
  bool (*is_biased)(const RenderPlan& settings) = nullptr;
  // Sentences that say which light is approximated or missing; the first one is about long paths.
  std::vector<std::string> (*bias)(const RenderPlan& settings, const RenderResult& result) = nullptr;
  std::vector<OmittedStage> (*omitted)(const RenderPlan& settings) = nullptr;
  // Returns its own settings as they were used, for the stats document; JSON null if it has none.
  nlohmann::ordered_json (*stats)(const RenderPlan& settings, const PackedScene& scene,
                                  const RenderResult& result) = nullptr;
  std::unique_ptr<Integrator> (*make)(Workspace& workspace, KernelCompiler& kernels) = nullptr;

  // Candidates for --integrator auto (host/plan/integrator.h): none where settings or scene ask for what it leaves out.
  // The first candidate of the default kind is taken if no pilot is made. Null = auto never tries this kind.
  std::vector<RenderPlan> (*candidates)(const RenderPlan& settings, const PackedScene& scene) = nullptr;
  // Settings of such a kind that auto does not take, mostly because it decides them.
  std::span<const std::string_view> not_by_auto{};
  // Work of these rays, for candidates. Unit: one camera ray of `path`. `device`: class of the device that renders.
  double (*work)(const RenderPlan& settings, const RayCounts& rays, DeviceClass device) = nullptr;
};

// All integrators, the default one first. host/integrators/factory.cpp defines the list; no other file does.
std::span<const IntegratorKind* const> integrators();
const IntegratorKind& default_integrator();
// The integrator of that name; null if there is none.
const IntegratorKind* find_integrator(std::string_view name);

// True if IntegratorKind::settings lists the setting, by name or by Setting::listed_as. Defined by the table of
// settings.
bool supports(const IntegratorKind& kind, std::string_view setting);
// Whether it is one of what is asked for: of --integrator auto, one that any of its candidates supports.
bool supports(const IntegratorSetting& integrator, std::string_view setting);

} // namespace wavepath
