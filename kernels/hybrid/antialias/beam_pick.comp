// Picks what a pixel shows: of the triangles in its beam and what is seen where none is, those with the largest
// fractions of the pixel, the largest first. Push constant: as for beam_find.comp.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_FRACTIONS
#include "kernels/hybrid/bindings.glsl"
#include "kernels/base/config.glsl"
#include "kernels/hybrid/antialias/beam_types.h"

layout(set = 0, binding = kBindBeamTriangles, std430) readonly buffer BeamTriangleBlock { uvec2 beam_triangles[]; };
layout(set = 0, binding = kBindBeamAreas, std430) readonly buffer BeamAreaBlock { float beam_areas[]; };
layout(set = 0, binding = kBindBeamIds, std430) writeonly buffer BeamIdBlock { uvec2 beam_ids[]; };

layout(local_size_x = kWorkgroupSize) in;

const float kRounding = 3e-6; // of the sum of areas
float areas[kBeamTriangles + 1u]; // the last one: no triangle

uint take_largest() {
  uint largest = 0u;
  for (uint i = 1u; i <= kBeamTriangles; ++i)
    if (areas[i] > areas[largest]) largest = i;
  return largest;
}

// What lies behind more triangles than there is room for is not known: then the others share the rest of the pixel.
void read_areas(uint local) {
  float rest = 1.0;
  for (uint i = 0u; i < kBeamTriangles; ++i) {
    areas[i] = beam_areas[local * kBeamTriangles + i];
    rest -= areas[i];
  }
  bool knows_all = beam_triangles[local * kBeamStride + kBeamTriangles].x == 0u;
  areas[kBeamTriangles] = (knows_all && rest > kRounding) || rest > 1.0 - kRounding ? rest : 0.0;
}

void main() {
  uint local = gl_GlobalInvocationID.x;
  if (local >= wave.pixel_count) return;
  read_areas(local);
  float picked[kFractions], sum = 0.0;
  uvec2 ids[kFractions];
  for (uint i = 0u; i < kFractions; ++i) {
    uint place = take_largest();
    picked[i] = areas[place];
    bool shows_triangle = picked[i] > 0.0 && place < kBeamTriangles;
    ids[i] = shows_triangle ? beam_triangles[local * kBeamStride + place] : uvec2(kNone);
    areas[place] = 0.0;
    sum += picked[i];
  }
  for (uint i = 0u; i < kFractions; ++i) {
    uint place = i * frame.width * frame.height + wave.first_pixel + local;
    beam_ids[place] = ids[i];
    fractions[place] = picked[i] / sum;
  }
}
