// Four floats at a time, in the vectors that GCC and Clang have for every processor.
#pragma once

#include <cstring>

namespace wavepath::bvh {

using Lanes = float __attribute__((vector_size(16)));
using IntLanes = int __attribute__((vector_size(16)));

inline Lanes load(const float* four) {
  Lanes lanes;
  std::memcpy(&lanes, four, sizeof lanes);
  return lanes;
}
inline Lanes load_aligned(const float* four) {
  return load(static_cast<const float*>(__builtin_assume_aligned(four, 16)));
}
inline void store_aligned(float* four, Lanes lanes) {
  std::memcpy(__builtin_assume_aligned(four, 16), &lanes, sizeof lanes);
}
inline Lanes splat(float value) { return Lanes{value, value, value, value}; }

// Lane-wise minimum and maximum; `b` where `a` is NaN, as the processors' own instructions do. The order of arguments
// decides which of two zeros is returned.
inline Lanes smaller(Lanes a, Lanes b) { return a < b ? a : b; }
inline Lanes larger(Lanes a, Lanes b) { return a > b ? a : b; }
inline Lanes magnitude(Lanes a) { return (Lanes)((IntLanes)a & 0x7fffffff); }
// True if the mask is set in all, or in any, of the first three lanes.
inline bool all(IntLanes mask) { return (mask[0] & mask[1] & mask[2]) != 0; }
inline bool any(IntLanes mask) { return (mask[0] | mask[1] | mask[2]) != 0; }
inline Lanes yzx(Lanes a) { return __builtin_shufflevector(a, a, 1, 2, 0, 3); }

} // namespace wavepath::bvh
