// Puts the photons of a map into the lists of their cells, and thins out those of crowded cells: which ones stay is a
// function of the photon alone.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_PHOTONS
#include "kernels/bidirectional/bindings.glsl"
#include "kernels/bidirectional/photons.glsl"

layout(local_size_x = kWorkgroupSize) in;

void main() {
  uint index = gl_GlobalInvocationID.x;
  if (index >= kReplicates * photon_frame.path_count) return;
  Photon photon = fetch_photon(index);
  if (photon.link == 0u) return;
  uint cell = cell_index(cell_of(photon.position), replicate_of_photon(index));
  float probability = float(kMostInCell) / float(photon_cells[cell].x);
  if (probability < 1.0) {
    if (!(unit_float(pcg3d(uvec3(frame.seed, index, wave.first_sample)).x) < probability)) return;
    store_photon_light(index, photon.light / probability, photon.others);
  }
  uint next = atomicExchange(photon_cells[cell].y, index + 1u);
  photon_words[3u * index + 1u].w = photon.link | next;
}
