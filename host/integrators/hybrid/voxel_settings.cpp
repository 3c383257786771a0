#include "host/integrators/hybrid/voxel_settings.h"

#include "host/base/error.h"
#include "host/integrators/hybrid/bounce/catalogue.h"
#include "host/integrators/hybrid/occlusion/catalogue.h"
#include "host/integrators/hybrid/shadows/catalogue.h"
#include "host/render/settings/integrator_kind.h"

namespace wavepath {
namespace {

constexpr std::string_view kVoxelsFlag = "voxels";
constexpr std::uint32_t kFewestAcross = 8, kMostAcross = 1024; // the most: see kMostSurfaceLevels

} // namespace

bool uses_voxels(const RenderPlan& settings) {
  const bool finds_light = settings.integrator->finds_light;
  const OcclusionKind* occlusion =
      !finds_light || settings.max_depth > 1 ? kOcclusionTechniques.find(settings) : nullptr;
  const ShadowKind* shadows = finds_light ? kShadowTechniques.find(settings) : nullptr;
  const ReflectionKind* bounce = finds_light ? kBounceTechniques.find(settings) : nullptr;
  return (occlusion && occlusion->voxels) || (shadows && shadows->voxels) || (bounce && bounce->voxels);
}

std::vector<Setting> voxel_rows() {
  return {{.name = kVoxelsFlag,
           .value = WholeValue{&RenderSettings::voxels, kFewestAcross, kMostAcross},
           .meaning = "--occlusion, --shadows and --bounce cones: voxels along the longest side of the scene",
           .placeholder = "N",
           .study = {"64", "128", "256", "512"}}};
}

bool voxels_support(const RenderPlan& settings, std::string_view setting) {
  return setting != kVoxelsFlag || uses_voxels(settings);
}

void check_voxel_settings(const RenderPlan& settings) {
  if (settings.voxels != RenderPlan{}.voxels && !uses_voxels(settings))
    throw UsageError("--voxels", "is for cones, which no technique in use traces",
                     "leave it out, or use --occlusion cones, --shadows cones or --bounce cones");
}

} // namespace wavepath
