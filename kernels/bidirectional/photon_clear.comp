// Empties the cells of the photon map, and marks its photons as not there.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_PHOTONS
#include "kernels/bidirectional/bindings.glsl"

layout(local_size_x = kWorkgroupSize) in;

void main() {
  uint index = gl_GlobalInvocationID.x;
  if (index < photon_frame.cell_count) photon_cells[index] = uvec2(0u);
  if (index < kReplicates * photon_frame.path_count) photon_words[3u * index + 1u] = uvec4(0u);
}
