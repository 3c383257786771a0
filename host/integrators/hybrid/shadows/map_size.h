// How large maps are where --shadow-size is left at its default, and the device cannot hold as many of that size.
#pragma once

#include <cstdint>

#include "host/render/settings/render_plan.h"

namespace wavepath {

// The size that is set; or where that is the default and does not fit, the largest multiple of 16 that does, so that
// defaults render whatever the number of lights. `fits`: whether the device can hold what a technique keeps at that
// size. A size that was chosen, and a scene that no size is small enough for, are left to be refused.
template <class Fits>
std::uint32_t size_that_fits(std::uint32_t set, Fits fits) {
  constexpr std::uint32_t kStep = 16; // the smallest map
  if (set != RenderPlan{}.shadow_size) return set;
  for (std::uint32_t size = set; size >= kStep; size -= kStep)
    if (fits(size)) return size;
  return set;
}

} // namespace wavepath
