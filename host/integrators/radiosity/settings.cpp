#include "host/integrators/radiosity/settings.h"

namespace wavepath {
namespace {

using S = RenderSettings;

constexpr std::uint32_t kMostPatches = 1u << 20, kMostPatchRays = 1u << 16;

} // namespace

std::vector<Setting> radiosity_rows() {
  std::vector<Setting> rows = {
      {.name = "patches",
       .value = WholeValue{&S::patches, 1, kMostPatches},
       .meaning = "patches that surfaces are cut into. A scene of more triangles has one for each",
       .placeholder = "N",
       .label = "patches",
       .study = {"1024", "4096", "16384"}},
      {.name = "subdivision",
       .value = ChoiceValue{&S::subdivision, kSubdivisionNames},
       .meaning = "how surfaces are cut. uniform: in patches of one size. adaptive: finer where light changes, as a "
                  "coarser mesh of a quarter of the patches tells",
       .label = "subdivision",
       .study = {"uniform", "adaptive"}},
      {.name = "form-factors",
       .value = ChoiceValue{&S::form_factors, kFormFactorNames},
       .meaning = "how the light that one patch sends to another is measured. rays: from points all over the patch, "
                  "distributed like its light. hemicube: through the pixels of half a cube on its middle. links: a "
                  "formula gives the light between large and small parts of surfaces, and rays test whether anything "
                  "stands between them",
       .label = "form factors",
       .study = {"hemicube", "links", "rays"}},
      {.name = "patch-rays",
       .value = WholeValue{&S::patch_rays, 1, kMostPatchRays},
       .meaning = "rays for each patch that the light of all lamps is sent by. Light that patches send on gets as many "
                  "as its power is worth. With links: of all light together, besides those between whole triangles",
       .placeholder = "N",
       .study = {"16", "64", "256", "1024"}},
      {.name = "gather",
       .value = SwitchValue{&S::gather},
       .meaning = "a final gather: every sample of a pixel gets the light of lamps by a shadow ray, and other light by "
                  "a ray to the patches. Without it, light between the corners of patches is shown",
       .study = {"off", "on"}},
  };
  for (Setting& row : rows) {
    row.group = SettingGroup::others;
    row.advanced = true;
    row.supported_by = SupportedBy::listed_else_refused;
    row.offered = kByRender | kByView;
  }
  return rows;
}

} // namespace wavepath
