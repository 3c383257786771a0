// The fraction of its pixel that shows each triangle in a beam: what is in the triangle and in none that is nearer
// there. Pieces of the triangle are cut along the edges of nearer ones until none is left to cut by. Triangles are
// taken not to pass through each other within the pixel. Push constant: as for beam_find.comp.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_GEOMETRY
#define BIND_HYBRID
#include "kernels/hybrid/bindings.glsl"
#include "kernels/hybrid/antialias/beam.glsl"

layout(set = 0, binding = kBindBeamTriangles, std430) readonly buffer BeamTriangleBlock { uvec2 beam_triangles[]; };
layout(set = 0, binding = kBindBeamAreas, std430) writeonly buffer BeamAreaBlock { float beam_areas[]; };

layout(local_size_x = kWorkgroupSize) in;

// A piece becomes three at most, which wait for the triangles behind the one that cut it.
const uint kMostPieces = 2u * kBeamTriangles + 2u;
const uint kMostCuts = 400u; // of a triangle: a cut takes up to a hundred rounds of loops, and drivers end after 65,535
Polygon pieces[kMostPieces];
uint next_cutters[kMostPieces];
uint piece_count;
bool lost_pieces = false; // there was no room for them, or no time

void push(Polygon piece, uint next_cutter) {
  if (area_of(piece) <= kSmallestArea) return;
  if (piece_count == kMostPieces) {
    lost_pieces = true;
    return;
  }
  pieces[piece_count] = piece;
  next_cutters[piece_count++] = next_cutter;
}

vec2 middle_of(Polygon polygon) {
  vec2 sum = vec2(0.0);
  for (uint i = 0u; i < polygon.count; ++i) sum += polygon.corners[i];
  return sum / float(polygon.count);
}

// Of two triangles as deep, the first one in the list counts as nearer.
bool hides(BeamTriangle other, BeamTriangle own, vec2 point, bool comes_first) {
  float other_depth = depth_at(other, point), own_depth = depth_at(own, point);
  return other_depth < own_depth || (other_depth == own_depth && comes_first);
}

// Cuts what `other` hides from the piece, and leaves the rest to be looked at. False if it hides nothing.
bool cut(Polygon piece, BeamTriangle own, BeamTriangle other, bool comes_first, uint next_cutter) {
  Polygon overlap = part_inside(piece, other);
  if (area_of(overlap) <= kSmallestArea || !hides(other, own, middle_of(overlap), comes_first)) return false;
  for (uint i = 0u; i < 3u; ++i) {
    push(part_inside(piece, -other.lines[i]), next_cutter);
    piece = part_inside(piece, other.lines[i]);
  }
  return true;
}

void main() {
  // Neighbours in a workgroup have the same place in the lists of neighbouring pixels, which are about as long.
  uint local = gl_GlobalInvocationID.x % wave.pixel_count, own_index = gl_GlobalInvocationID.x / wave.pixel_count;
  if (own_index >= kBeamTriangles) return;
  uint pixel_index = wave.first_pixel + local, list = local * kBeamStride;
  uvec2 pixel = uvec2(pixel_index % frame.width, pixel_index / frame.width), id = beam_triangles[list + own_index];
  float area = 0.0;
  if (id.x != kNone) {
    BeamTriangle own = beam_triangle(pixel, id.x, id.y);
    piece_count = 0u;
    push(part_inside(square_of(beam_half()), own), 0u);
    uint cuts = 0u;
    while (piece_count > 0u) {
      Polygon piece = pieces[--piece_count];
      uint cutter = next_cutters[piece_count];
      bool is_cut = false;
      for (; cutter < kBeamTriangles && !is_cut; ++cutter) {
        if (++cuts > kMostCuts) break;
        uvec2 other = beam_triangles[list + cutter];
        if (other.x == kNone) break;
        if (cutter == own_index) continue;
        is_cut = cut(piece, own, beam_triangle(pixel, other.x, other.y), cutter < own_index, cutter + 1u);
      }
      if (cuts > kMostCuts) {
        lost_pieces = true;
        break;
      }
      if (!is_cut) area += fraction_in(piece);
    }
  }
  beam_areas[local * kBeamTriangles + own_index] = area + (lost_pieces || lost_corners ? kBeamLost : 0.0);
}
