// Between stages: turns queue counts into indirect dispatch sizes, empties the queue that is written next, counts rays.
// Push constant `bounce` counts half steps: 2b before extend of bounce b, 2b + 1 before its connect.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_QUEUES
#define BIND_COUNTERS
#include "kernels/path/bindings.glsl"

layout(local_size_x = 1) in;

uint groups_for(uint count) { return (count + kWorkgroupSize - 1u) / kWorkgroupSize; }

// Adds to a 64-bit total kept as two words.
#define COUNT(total, n)                    \
  {                                        \
    uint carry_;                           \
    total[0] = uaddCarry(total[0], n, carry_); \
    total[1] += carry_;                    \
  }

void main() {
  uint bounce = wave.bounce >> 1u;
  if ((wave.bounce & 1u) == 0u) {
    uint count = queues.ray_count[bounce & 1u];
    queues.extend_groups[0] = groups_for(count);
    queues.extend_groups[1] = 1u;
    queues.extend_groups[2] = 1u;
    queues.ray_count[(bounce + 1u) & 1u] = 0u;
    queues.shadow_count = 0u;
    if (bounce == 0u) COUNT(counters.camera_rays, count) else COUNT(counters.bounce_rays, count)
  } else {
    uint count = queues.shadow_count;
    queues.connect_groups[0] = groups_for(count);
    queues.connect_groups[1] = 1u;
    queues.connect_groups[2] = 1u;
    COUNT(counters.shadow_rays, count)
  }
}
