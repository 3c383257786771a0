// Solves the light of a scene's patches on a device: measures surfaces, traces the rays of shots, and leaves the light
// at the corners of patches in a buffer for cameras.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "host/gpu/kernel.h"
#include "host/integrators/radiosity/links.h"
#include "host/integrators/radiosity/patch_mesh.h"
#include "host/integrators/radiosity/patch_tree.h"
#include "host/integrators/radiosity/refinement.h"
#include "host/integrators/radiosity/settings.h"
#include "host/render/loop/render_result.h"
#include "host/render/settings/render_plan.h"
#include "host/render/workspace/kernel_set.h"

namespace wavepath {

class WaveQueue;
class Workspace;

// Stages of the program of radiosity, by index.
enum RadiosityStage : std::size_t {
  kPatchMeasure,
  kPatchLight,
  kShoot,
  kLink,
  kSee,
  kInterpolate,
  kGatherDirect,
  kGatherOther,
  kRadiosityStageCount
};

class Solver {
public:
  explicit Solver(Workspace& workspace) : workspace_(workspace) {}

  // True if cameras look up the light of patches. Else a mesh has none.
  static bool is_looked_up(const RenderPlan& settings) { return settings.max_depth > (settings.gather ? 1u : 0u); }

  bool is_at_work() const { return work_.has_value(); }
  void stop() { work_.reset(); }
  // Begins anew, with these settings.
  void begin(const RenderPlan& settings);
  // Binds the buffers of add_bindings(), which were replaced, beside those of the workspace.
  using Bind = std::function<const BindingSet&()>;
  // Does a part of the work by these kernels, and waits for it. Returns true when all is solved. Throws Error if the
  // device has no memory for the mesh, or fails.
  bool step(const KernelSet& kernels, WaveQueue& queue, const Bind& bind);

  // Numbers and kinds of its bindings, without buffers.
  static std::vector<Binding> layout();
  void add_bindings(std::vector<Binding>& bindings) const;
  std::uint64_t bytes() const;
  const RadiosityReport& report() const { return report_; }

private:
  struct Mesh { // in work
    PatchTree tree;
    PatchMesh mesh;
    std::vector<LinkNode> nodes;                  // with --form-factors links, until these are made
    bool is_uploaded = false;                     // and its surfaces are measured
    std::uint32_t lit_faces = 0, lit_samples = 0; // by lamps: whole faces, and samples of the next ones
    std::optional<Refinement> refinement;         // once the light of lamps is measured
    std::optional<Links> links;                   // in its place, with --form-factors links
    bool is_coarse = false;                       // another one follows
  };

  bool reflects() const { return settings_.max_depth > 1; }
  bool by_links() const { return settings_.form_factors == kFormFactorsLinks && is_looked_up(settings_); }
  void upload(const PatchTree& tree);
  void submit(const Kernel& kernel, const gpu::Wave& wave, WaveQueue& queue);
  void measure_surfaces(const KernelSet& kernels, WaveQueue& queue);
  bool measure_light(const KernelSet& kernels, WaveQueue& queue);
  std::vector<Face> make_faces();
  void trace(const std::vector<Shot>& shots, const KernelSet& kernels, WaveQueue& queue);
  std::vector<Shot> next_shots();
  void begin_light();
  bool trace_links(const KernelSet& kernels, WaveQueue& queue);
  template <class Solution>
  bool finish_mesh(const Solution& solution);

  Workspace& workspace_;
  Buffer roots_, nodes_, patches_, surfaces_, lamp_light_, blocks_, hits_, corners_;
  const BindingSet* set_ = nullptr;
  RenderPlan settings_;
  std::optional<Mesh> work_;
  std::vector<glm::dvec3> by_lamps_; // irradiance by face
  RadiosityReport report_;
};

} // namespace wavepath
