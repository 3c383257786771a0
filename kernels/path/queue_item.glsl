// Assigns the entries of a queue to invocations.
//
// llvmpipe gives each of its threads one run of a dispatch's workgroups, and waits for the slowest thread. But
// neighbours in a queue are alike: noisy levels come first, and what one thread appended while the other had ended
// stands last. So workgroups take slices of the queue from all over it, and any run of them has some of everything.
#ifndef WAVEPATH_PATH_QUEUE_ITEM_GLSL
#define WAVEPATH_PATH_QUEUE_ITEM_GLSL

#include "kernels/base/config.glsl"

const uint kSliceGroups = 32u; // workgroups that stay neighbours, so that threads seldom write to one line of the cache
const uint kFarApart = 8u;     // parts of the queue that consecutive slices are taken from in turn

uint queue_item() {
  if (!kInStep) return gl_GlobalInvocationID.x;
  uint slice = gl_WorkGroupID.x / kSliceGroups, rows = gl_NumWorkGroups.x / (kSliceGroups * kFarApart);
  if (slice >= rows * kFarApart) return gl_GlobalInvocationID.x;
  slice = slice % kFarApart * rows + slice / kFarApart;
  return (slice * kSliceGroups + gl_WorkGroupID.x % kSliceGroups) * kWorkgroupSize + gl_LocalInvocationID.x;
}

#endif
