// Finds the cells of a light's view that every triangle covers. It is conservative: a shadow ray is listed in one cell,
// and every triangle that the ray's test may hit is listed in that cell as well, whatever the rounding.
//
// A ray from o towards a light at L is the line from o to L but for an error e of its direction (two roundings) and of
// the view's rows (one each): no point of it is farther than 2^-20 * R from that line, where R bounds the coordinates
// of the scene and of the light, summed. The triangle test accepts rays that pass it by less than 2^-20 * R. Triangles
// are grown by 2^-18 * R, times the condition number of the transform of their instance. The line projects to one
// point, that of o, whose cell is known to half a cell (ShadowView::near keeps points away for which it is not), so
// covered cells are taken one cell wider.
#pragma once

#include <vector>

#include <glm/glm.hpp>

#include "host/scene/pack/packed_scene.h"
#include "kernels/hybrid/shadows/shadow_types.h"

namespace wavepath {

// Sets the bounds of a view. ShadowView::radius: distance by which triangles are grown. ShadowView::texel: distance by
// which rays may miss their light (for a sun: length by which directions may differ). ShadowView::near: least w of
// points whose cell is known well enough. `lo`, `hi`: box of the scene. The view may be parallel or perspective.
void bound_rounding(gpu::ShadowView& view, std::uint32_t size, const glm::dvec3& lo, const glm::dvec3& hi);

// Data of kBindIzbItems, in the order of the views, each of size * size cells. Triangles are clipped to the view and
// cut into pieces of about ten cells' sides, so that none takes long.
std::vector<glm::uvec4> cover_cells(const PackedScene& scene, const std::vector<gpu::ShadowView>& views,
                                    std::uint32_t size);

} // namespace wavepath
