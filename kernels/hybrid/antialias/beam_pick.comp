// Picks what a pixel shows: of the triangles in its beam and what is seen where none is, those with the largest
// fractions of the pixel. Each of kFractions pictures shows one of them, and large ones are in several. So pictures
// have about the same weight, and few of them are nearly right already. Push constant: as for beam_find.comp.
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

// What lies behind more triangles than there is room for is not known, nor what was lost in cutting: then the others
// share the rest of the pixel.
void read_areas(uint local) {
  float rest = 1.0;
  bool knows_all = beam_triangles[local * kBeamStride + kBeamTriangles].x == 0u;
  for (uint i = 0u; i < kBeamTriangles; ++i) {
    areas[i] = beam_areas[local * kBeamTriangles + i];
    if (areas[i] >= kBeamLost) {
      areas[i] -= kBeamLost;
      knows_all = false;
    }
    rest -= areas[i];
  }
  areas[kBeamTriangles] = (knows_all && rest > kRounding) || rest > 1.0 - kRounding ? rest : 0.0;
}

// Weight of the pictures that show a part. That of a part without any is so large that it gets one, unless it is empty.
float weight_of(float fraction, uint pictures) {
  return pictures > 0u ? fraction / float(pictures) : fraction > 0.0 ? 2.0 + fraction : 0.0;
}

void main() {
  uint local = gl_GlobalInvocationID.x;
  if (local >= wave.pixel_count) return;
  read_areas(local);
  float picked[kFractions], sum = 0.0;
  uvec2 ids[kFractions];
  uint pictures[kFractions]; // that show it
  for (uint i = 0u; i < kFractions; ++i) {
    uint place = take_largest();
    picked[i] = areas[place];
    bool shows_triangle = picked[i] > 0.0 && place < kBeamTriangles;
    ids[i] = shows_triangle ? beam_triangles[local * kBeamStride + place] : uvec2(kNone);
    pictures[i] = 0u;
    areas[place] = 0.0;
    sum += picked[i];
  }
  // The next picture is for the part whose pictures have the largest weight.
  for (uint n = 0u; n < kFractions; ++n) {
    uint next = 0u;
    for (uint i = 1u; i < kFractions; ++i)
      if (weight_of(picked[i], pictures[i]) > weight_of(picked[next], pictures[next])) next = i;
    ++pictures[next];
  }
  uint written = 0u;
  for (uint i = 0u; i < kFractions; ++i)
    for (uint n = 0u; n < pictures[i]; ++n) {
      uint place = written++ * frame.width * frame.height + wave.first_pixel + local;
      beam_ids[place] = ids[i];
      fractions[place] = picked[i] / (sum * float(pictures[i]));
    }
}
