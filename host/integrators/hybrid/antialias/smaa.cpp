// Subpixel morphological anti-aliasing, its 1x variant (Jimenez, Echevarria, Sousa and Gutierrez 2012).
#include <array>

#include "host/integrators/hybrid/antialias/kinds.h"
#include "kernels/hybrid/antialias/smaa.spv.h"
#include "kernels/hybrid/antialias/smaa_edges.spv.h"

namespace wavepath {
namespace {

const std::array<KernelCode, 2> kSmaaPasses = {{{"smaa edges", wavepath_smaa_edges_spv}, {"smaa", wavepath_smaa_spv}}};

} // namespace

const AntialiasKind kAntialiasSmaa = {.name = "smaa",
                                      .summary = "edges redrawn from their steps (SMAA 1x, Jimenez et al. 2012)",
                                      .position = pixel_centre,
                                      .passes = kSmaaPasses};

} // namespace wavepath
