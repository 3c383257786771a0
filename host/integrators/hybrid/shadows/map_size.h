// Size of maps if --shadow-size has its default and the device cannot hold all maps of that size.
#pragma once

#include <cstdint>

#include "host/render/settings/render_plan.h"

namespace wavepath {

// Returns the size that is set. If it is the default and does not fit, returns the largest multiple of 16 that does, so
// that defaults render any number of lights. `fits`: tells whether the device can hold the technique's data at a size.
// A size that the user chose, and a scene for which no size fits, are refused later.
template <class Fits>
std::uint32_t size_that_fits(std::uint32_t set, Fits fits) {
  constexpr std::uint32_t kStep = 16; // the smallest map
  if (set != RenderPlan{}.shadow_size) return set;
  for (std::uint32_t size = set; size >= kStep; size -= kStep)
    if (fits(size)) return size;
  return set;
}

} // namespace wavepath
