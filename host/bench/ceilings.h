// The limits of the device: the roofline that kernels are compared with.
#pragma once

#include <cstdint>

#include "host/gpu/device.h"

namespace wavepath {

struct Ceilings {
  double load16_per_second = 0.0; // random loads of 16 bytes, as traversal does them
  double load64_per_second = 0.0; // loads of four adjacent texels of 16 bytes
  double gflops = 0.0;            // multiply-adds count as two
};

// The fraction of what the device could do at most, of work that takes so many blocks of up to 64 bytes loaded at
// random and so many float operations each second: that of the scarcer of the two.
double roofline_fraction(const Ceilings& ceilings, double loads_per_second, double flops_per_second);

// Random loads go over `working_set` bytes (at least a page); the best of a few measurements counts.
Ceilings measure_ceilings(Device& device, std::uint64_t working_set);

} // namespace wavepath
