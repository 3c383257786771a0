// The interface of integrators: what is known before there is a device, and the work on one.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "host/render/settings.h"
#include "kernels/frame_types.h"

namespace wavepath {

class Commands;
class Integrator;
class KernelCompiler;
class WaveQueue;
class Workspace;
struct DeviceInfo;
struct FilmBand;
struct View;
struct PackedScene;
struct RenderResult;

// A stage or buffer that the integrator leaves out, and why, for the report.
struct OmittedStage {
  std::string what, why;
};

// What is known of an integrator before there is a device. One constant for each stands in its folder.
struct IntegratorKind {
  std::string_view name;    // value of --integrator
  std::string_view summary; // for --help: one clause
  // Names of the settings that it takes besides those that all take: a setting of no use to it is refused.
  std::span<const std::string_view> settings{};
  std::span<const std::string_view> aovs{}; // values of --aov besides those of all
  bool finds_light = true;                  // false: its picture is the unoccluded share, whatever the lights
  bool traces_paths = true;                 // false: a sample is a frame, which reaches the film as a whole
  bool measures_depth_cut = false; // the light beyond --max-depth is measured, and told in the first sentence of bias()
  // Stages that find the first hits, by whose time integrators are compared.
  std::span<const std::string_view> first_hit_stages{};

  // kFeature bits of its kernels, besides those of the scene and of RenderSettings::adaptive.
  std::uint32_t (*features)(const RenderSettings& settings) = nullptr;
  // Begins compiling for a scene of these kFeature bits, before the scene is there. A wrong guess costs time alone.
  void (*start_kernels)(KernelCompiler& kernels, const DeviceInfo& device, std::uint32_t features,
                        const RenderSettings& settings) = nullptr;
  // Device memory that a path in flight takes, for the kFeature bits given, and the largest record of one in any
  // buffer.
  std::uint64_t (*bytes_per_slot)(std::uint32_t features) = nullptr;
  std::uint64_t largest_record = 1;
  // Paths that a pixel takes in every wave.
  std::uint32_t (*slots_per_pixel)(const RenderSettings& settings) = nullptr;
  // Device memory that a pixel takes besides paths and film.
  std::uint64_t (*bytes_per_pixel)(const RenderSettings& settings) = nullptr;
  // Whether the picture converges to something else than the light of all paths up to --max-depth.
  bool (*is_biased)(const RenderSettings& settings) = nullptr;
  // What of the light is approximated or missing, a sentence each; the first one is about long paths.
  std::vector<std::string> (*bias)(const RenderSettings& settings, const RenderResult& result) = nullptr;
  std::vector<OmittedStage> (*omitted)(const RenderSettings& settings) = nullptr;
  // Of its own settings as they were used, for the stats document; null if it has none.
  nlohmann::ordered_json (*stats)(const RenderSettings& settings, const PackedScene& scene,
                                  const RenderResult& result) = nullptr;
  std::unique_ptr<Integrator> (*make)(Workspace& workspace, KernelCompiler& kernels) = nullptr;
};

// Whether coming frames use what an integrator learned from earlier ones: a camera in motion, or a cut.
enum class Past { forget, keep };

// Pixels that a pass treats alike: a band of the film, or in an adaptive render the runs of one level within a band.
struct Segment {
  std::size_t band = 0;
  std::uint32_t first_place = 0, pixel_count = 0; // in tile order, or in the order of the list of runs
  int level = 0;
};

// Samples that are rendered before the first ones of the picture, to learn from, and thrown away.
struct Pilot {
  std::vector<Segment> segments;
  std::uint32_t samples = 1;
  std::uint32_t seed = 0; // by exclusive or with the render's own
};

// An integrator on a device. The render loop cuts passes into waves and calls, in this order: change(), get_ready(),
// the pilot's pass and learn() if there is a pilot, then for every pass begin_pass(), record_wave() for all its waves,
// end_pass(). What the integrator records is executed in that order.
class Integrator {
public:
  virtual ~Integrator() = default;

  // Takes up the view and the settings that the workspace was changed to: adapts the constants, begins compiling,
  // makes room. Throws Error if the device cannot hold it.
  virtual void change(const View& view, const RenderSettings& settings, Past past) = 0;
  // Whether the kernels are compiled, so that get_ready() will not wait.
  virtual bool is_ready() = 0;
  // Returns the seconds that compiling took. Throws what compiling threw.
  virtual double get_ready() = 0;

  virtual std::optional<Pilot> pilot() { return std::nullopt; }
  // After the pilot's waves were rendered and waited for. Nothing is in flight.
  virtual void learn() {}

  // Paths that a pixel of a wave counts for, when it gets so many samples.
  virtual std::uint32_t paths_per_pixel(std::uint32_t samples) const { return samples; }
  // Samples of a pass at most.
  virtual std::uint32_t most_samples() const = 0;
  // A pass covers all pixels, beginning with sample `first_sample`.
  virtual void begin_pass(WaveQueue& queue, std::uint32_t first_sample) = 0;
  // What a wave's kernels are told: `count` samples from `first_sample` on of pixels at places from `first_place` on.
  virtual gpu::Wave wave(const FilmBand& band, std::uint32_t first_place, std::uint32_t pixel_count,
                         std::uint32_t first_sample, std::uint32_t count) const = 0;
  // Records the wave, and nothing else: submits nothing and waits for nothing. `band`: its place among the film's.
  virtual void record_wave(Commands& commands, std::size_t band, const gpu::Wave& wave) = 0;
  virtual void end_pass(WaveQueue&) {}

  virtual std::uint32_t timed_dispatches() const = 0; // of a wave
  virtual std::uint64_t bytes() const = 0;            // of device memory besides the workspace's
  virtual void describe(RenderResult&) const {}       // what the report says of its own
};

// All of them, the default first. Defined by host/integrators/factory.cpp, which alone knows their names.
std::span<const IntegratorKind* const> integrators();
const IntegratorKind& default_integrator();
// Null if there is none of that name.
const IntegratorKind* find_integrator(std::string_view name);

// Whether a setting that not all integrators take is one of this one's.
bool takes(const IntegratorKind& kind, std::string_view setting);

} // namespace wavepath
