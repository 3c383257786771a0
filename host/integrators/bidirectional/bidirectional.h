// Bidirectional path tracing (Veach 1997): traces a light path and a camera path for every sample, and connects them.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "host/integrators/bidirectional/photon_map.h"
#include "host/integrators/path/light_trainer.h"
#include "host/integrators/path/paths.h"
#include "kernels/bidirectional/bidirectional_types.h"

namespace wavepath {

// kLobe bits that its light paths do not support.
inline constexpr gpu::Feature kBidirectionalLacks = gpu::kLobeDispersion | gpu::kLobeScattering;

class Bidirectional : public Integrator {
public:
  Bidirectional(Workspace& workspace, KernelCompiler& kernels);

  void change(const View& view, const RenderPlan& settings, TemporalHistory history) override;
  bool is_ready() override;
  double get_ready() override;
  std::uint32_t most_samples(std::uint32_t first_sample) const override;
  std::optional<Pilot> pilot() override;
  bool end_pilot() override;
  void begin_pass(WaveQueue& queue, std::uint32_t first_sample) override;
  void record_wave(Commands& commands, std::size_t band, const gpu::Wave& wave) override;
  std::uint32_t timed_dispatches() const override;
  std::uint64_t bytes() const override { return paths_.buffers.bytes() + buffers_.bytes(); }
  void describe(RenderResult& result) const override;

private:
  void send_constants(std::uint32_t techniques);
  bool merges() const { return photons_.path_count > 0; }
  void record_empty_map(Commands& commands, const gpu::PhotonFrame& map);
  void record_photons(Commands& commands, const gpu::Wave& wave);
  void record_links(Commands& commands, const gpu::Wave& wave);
  void record_light_paths(Commands& commands, std::size_t band, const gpu::Wave& wave);
  void record_splats(Commands& commands, std::size_t band, const gpu::Wave& wave, const KernelSet& kernels);
  void record_camera_paths(Commands& commands, std::size_t band, const gpu::Wave& wave);

  Workspace& workspace_;
  KernelCompiler& kernels_;
  Paths paths_; // light paths, and then camera paths
  LightTrainer trainer_;
  bool is_training_ = false; // training runs, before the first sample
  BufferSet buffers_;
  KernelNeed need_;
  std::uint32_t techniques_ = 0; // kTechnique bits that are useful in this scene
  const DeltaSurfaces delta_surfaces_;
  const bool lamps_in_bodies_;
  PhotonPlan photons_; // path_count 0 = no merging
  float first_radius_ = 0.0f;
  std::optional<std::uint32_t> first_block_, block_; // block of the render's first sample; block that the map holds
  KernelNeed photon_need_;
  std::vector<std::unique_ptr<BindingSet>> sets_; // one for each band
};

extern const KernelProgram kBidirectionalProgram;
// The need of its own kernels, those of photons left out.
KernelNeed bidirectional_need(const KernelConfig& config);
// Stages that it uses of Paths: all but those that shade.
inline constexpr std::uint32_t kSharedPathStages = kAllPathStages & ~stage_bits({kShade, kEscape, kReuse});

// Bytes of light vertices and connections for each slot. `merges`: the render has photons.
std::uint64_t light_bytes_per_slot(const RenderPlan& settings, bool merges);
std::uint64_t light_vertex_bytes_per_slot(const RenderPlan& settings);

} // namespace wavepath
