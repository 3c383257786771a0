// Turns the count of connections into the size of an indirect dispatch, counts their rays, and empties the queue: push
// constant `bounce` 0 empties it alone.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_CONNECTIONS
#define BIND_COUNTERS
#include "kernels/bidirectional/bindings.glsl"

layout(local_size_x = 1) in;

void main() {
  if (wave.bounce == 0u) {
    connections.count = 0u;
    return;
  }
  uint count = connections.count, carry;
  connections.groups[0] = (count + kWorkgroupSize - 1u) / kWorkgroupSize;
  connections.groups[1] = 1u;
  connections.groups[2] = 1u;
  counters.shadow_rays[0] = uaddCarry(counters.shadow_rays[0], count, carry);
  counters.shadow_rays[1] += carry;
}
