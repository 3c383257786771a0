// Ambient occlusion by cones through surface voxels (Crassin et al. 2011).
#include <array>

#include "host/integrators/hybrid/occlusion/kinds.h"
#include "host/integrators/hybrid/occlusion/screen_space.h"
#include "host/integrators/hybrid/voxels/surface_voxels.h"
#include "kernels/hybrid/occlusion/cones.spv.h"

namespace wavepath {
namespace {

std::vector<Binding> cones_layout() {
  std::vector<Binding> layout = screen_space_layout();
  add_voxel_layout(layout);
  return layout;
}

const std::array<KernelCode, 1> kConesStages = {{{"cone-traced occlusion", wavepath_cones_spv}}};
const KernelProgram kConesProgram = {kConesStages, kOnlyStage, cones_layout};

} // namespace

constinit const OcclusionKind kOcclusionCones = {
    .name = "cones",
    .summary = "cones through voxels of the surfaces (voxel cone tracing, Crassin et al. 2011)",
    .program = &kConesProgram,
    .voxels = true,
};

} // namespace wavepath
