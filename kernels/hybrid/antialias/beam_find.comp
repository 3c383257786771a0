// Finds the triangles that the beam of each pixel meets, by a walk of the BVH that goes where the beam does. The
// nearest are kept, up to kBeamTriangles. Push constant: first_pixel = the first one, row by row from the top left,
// pixel_count = how many, bounce = shape of the pixel.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_ballot : require

#define BIND_GEOMETRY
#define BIND_SURFACES
#define BIND_HYBRID
#include "kernels/hybrid/bindings.glsl"
#include "kernels/hybrid/antialias/beam.glsl"
#include "kernels/hybrid/seen_through.glsl"
#include "kernels/bvh/known_triangle.glsl"

layout(set = 0, binding = kBindBeamTriangles, std430) writeonly buffer BeamTriangleBlock { uvec2 beam_triangles[]; };

layout(local_size_x = kWorkgroupSize) in;

// A CPU driver ends all loops of an invocation together after 65,535 rounds. A triangle takes 60 at most.
const uint kMostTests = 768u, kMostVisits = 8192u;
const float kMargin = 0.02; // pixels by which boxes are tested more generously
const uint kEndOfInstance = 0xfffffffeu;

// ---- the list -------------------------------------------------------------------------------------------------------
uvec2 kept[kBeamTriangles];
uint kept_ids[kBeamTriangles]; // of triangles: spatial splits make copies
float kept_depths[kBeamTriangles];
uint kept_count;
float farthest; // depth behind which nothing is seen, or kept

bool is_kept(uint id, uint instance) {
  for (uint i = 0u; i < kept_count; ++i)
    if (kept_ids[i] == id && kept[i].y == instance) return true;
  return false;
}

void keep(uvec2 triangle, uint id, float depth) {
  uint place = min(kept_count, kBeamTriangles - 1u);
  if (kept_count == kBeamTriangles && depth >= kept_depths[place]) return;
  for (; place > 0u && kept_depths[place - 1u] > depth; --place) {
    kept[place] = kept[place - 1u];
    kept_ids[place] = kept_ids[place - 1u];
    kept_depths[place] = kept_depths[place - 1u];
  }
  kept[place] = triangle;
  kept_ids[place] = id;
  kept_depths[place] = depth;
  kept_count = min(kept_count + 1u, kBeamTriangles);
  if (kept_count == kBeamTriangles) farthest = min(farthest, kept_depths[kBeamTriangles - 1u]);
}

// ---- triangles ------------------------------------------------------------------------------------------------------
uvec2 pixel;

// Least and largest weight in the square, of a corner whose line it is.
vec2 range_of(vec3 line) {
  float reach = beam_half() * (abs(line.x) + abs(line.y));
  return line.z + vec2(-reach, reach);
}

bool is_hidden(uint triangle, uint instance, bool clockwise) {
  return CULLS_BACKS && (hidden_sides_of(triangle, instance) & (clockwise ? 1u : 2u)) != 0u;
}

bool is_hole_at_middle(uint triangle, uint instance) {
  uint flags = floatBitsToUint(texelFetch(triangles, int(triangle * kTriangleTexels)).w);
  if (!has(kFeatureAlpha) || (flags & kTriangleAlpha) == 0u) return false;
  vec3 origin, direction;
  hybrid_camera_ray(pixel, origin, direction);
  return is_seen_through(hit_of_triangle(triangle, instance, origin, direction), pixel);
}

void test(uint item, uint instance) {
  BeamTriangle triangle = beam_triangle(pixel, item, instance);
  if (triangle.orientation == 0.0) return;
  vec2 a = range_of(triangle.lines[0]), b = range_of(triangle.lines[1]), c = range_of(triangle.lines[2]);
  if (min(a.y, min(b.y, c.y)) <= 0.0 || is_hidden(item, instance, triangle.orientation > 0.0)) return;
  bool covers = min(a.x, min(b.x, c.x)) >= 0.0;
  Polygon seen = square_of(beam_half());
  if (!covers) {
    seen = part_inside(seen, triangle);
    if (area_of(seen) <= kSmallestArea) return;
  }
  vec2 depths = vec2(kFar, 0.0);
  for (uint i = 0u; i < seen.count; ++i) {
    float depth = depth_at(triangle, seen.corners[i]);
    depths = vec2(min(depths.x, depth), max(depths.y, depth));
  }
  uint id = floatBitsToUint(texelFetch(triangles, int(item * kTriangleTexels + 1u)).w);
  if (depths.x > farthest || depths.y <= 0.0 || is_kept(id, instance) || is_hole_at_middle(item, instance)) return;
  keep(uvec2(item, instance), id, depths.x);
  if (covers) farthest = min(farthest, depths.y * 1.00001);
}

// ---- the walk -------------------------------------------------------------------------------------------------------
// Sides of the beam and the view axis, as planes in the space of the walk: dot(normal, p) + offset is how far p is
// inside, or its depth.
vec3 normals[5];
float offsets[5];

// Planes in the world, relative to the eye.
void begin_planes() {
  vec2 size = 0.5 * vec2(frame.width, frame.height), at = vec2(pixel) + 0.5 - size;
  vec3 right = frame.camera_right * (size.x / dot(frame.camera_right, frame.camera_right)),
       down = frame.camera_up * (-size.y / dot(frame.camera_up, frame.camera_up));
  float half_ = beam_half() + kMargin;
  // What a depth of 1 shifts; parallel rays are shifted wherever they are.
  vec3 along = is_orthographic() ? vec3(0.0) : frame.camera_forward;
  normals[0] = right + (half_ - at.x) * along;
  normals[1] = (half_ + at.x) * along - right;
  normals[2] = down + (half_ - at.y) * along;
  normals[3] = (half_ + at.y) * along - down;
  normals[4] = frame.camera_forward;
  vec4 shifts = is_orthographic() ? vec4(half_ - at.x, half_ + at.x, half_ - at.y, half_ + at.y) : vec4(0.0);
  for (uint i = 0u; i < 5u; ++i) offsets[i] = i < 4u ? shifts[i] : 0.0;
}

void end_instance() {
  begin_planes();
  for (uint i = 0u; i < 5u; ++i) offsets[i] -= dot(normals[i], frame.camera_position);
}

void begin_instance(uint instance) {
  begin_planes();
  int texel = int(instance * kInstanceTexels + 3u);
  vec4 x = texelFetch(instances, texel), y = texelFetch(instances, texel + 1), z = texelFetch(instances, texel + 2);
  for (uint i = 0u; i < 5u; ++i) {
    offsets[i] += dot(normals[i], vec3(x.w, y.w, z.w) - frame.camera_position);
    normals[i] = normals[i].x * x.xyz + normals[i].y * y.xyz + normals[i].z * z.xyz;
  }
}

float cell_size(uint layout_, uint shift) {
  return uintBitsToFloat(((layout_ >> shift & 127u) + 127u - kCellBias) << 23u);
}

vec4 bytes_of(uint word) { return vec4(word & 255u, word >> 8u & 255u, word >> 16u & 255u, word >> 24u); }

uint stack[3u * kStackSize + 8u];
uint stack_size;
void push(uint entry) { stack[stack_size++] = entry; }

// The children that may be met go to the stack, the nearest last.
void visit(uint node) {
  int texel = int(node * kNodeTexels);
  uvec4 grid = texelFetch(nodes, texel), xy = texelFetch(nodes, texel + 1), zw = texelFetch(nodes, texel + 2);
  vec3 origin = uintBitsToFloat(grid.xyz);
  vec3 cells = vec3(cell_size(grid.w, 0u), cell_size(grid.w, 7u), cell_size(grid.w, 14u));
  vec4 low_x = origin.x + cells.x * bytes_of(xy.x), high_x = origin.x + cells.x * bytes_of(xy.y),
       low_y = origin.y + cells.y * bytes_of(xy.z), high_y = origin.y + cells.y * bytes_of(xy.w),
       low_z = origin.z + cells.z * bytes_of(zw.x), high_z = origin.z + cells.z * bytes_of(zw.y);
  vec4 most = vec4(kFar), nearest, deepest;
  for (uint i = 0u; i < 5u; ++i) {
    vec3 n = normals[i];
    vec4 inside = n.x * (n.x > 0.0 ? high_x : low_x) + n.y * (n.y > 0.0 ? high_y : low_y) +
                  n.z * (n.z > 0.0 ? high_z : low_z) + offsets[i];
    most = min(most, inside);
    if (i == 4u)
      nearest = n.x * (n.x > 0.0 ? low_x : high_x) + n.y * (n.y > 0.0 ? low_y : high_y) +
                n.z * (n.z > 0.0 ? low_z : high_z) + offsets[i];
  }
  uvec4 counts = grid.wwww >> uvec4(24u, 26u, 28u, 30u) & 3u;
  uvec4 firsts = zw.w + uvec4(0u, counts.x, counts.x + counts.y, counts.x + counts.y + counts.z);
  uint inner_count = grid.w >> 21u & 7u;
  for (uint i = 0u; i < 4u; ++i) {
    bool is_met = most[i] >= 0.0 && nearest[i] <= farthest && (i < inner_count || counts[i] > 0u);
    if (!is_met) nearest[i] = -kFar;
  }
  for (uint i = 0u; i < 4u; ++i) { // the farthest of those that are left
    float depth = max(max(nearest.x, nearest.y), max(nearest.z, nearest.w));
    if (depth == -kFar) break;
    uint child = nearest.x == depth ? 0u : nearest.y == depth ? 1u : nearest.z == depth ? 2u : 3u;
    push(child < inner_count ? zw.z + child : kLeafBit | counts[child] << kLeafCountShift | firsts[child]);
    nearest[child] = -kFar;
  }
}

void walk() {
  bool in_top_level = has(kFeatureInstances) && frame.root_is_top != 0u;
  uint instance = 0u, tests = 0u;
  end_instance();
  stack_size = 0u;
  if (frame.root != kNone) push(frame.root);
  for (uint visits = 0u; stack_size > 0u && tests < kMostTests && visits < kMostVisits; ++visits) {
    uint entry = stack[--stack_size];
    if (entry == kEndOfInstance) {
      in_top_level = true;
      end_instance();
    } else if ((entry & kLeafBit) == 0u) {
      visit(entry);
    } else {
      uint first = entry & kLeafFirstMask, count = entry >> kLeafCountShift & 7u;
      if (in_top_level) {
        if (count > 1u) push(kLeafBit | (count - 1u) << kLeafCountShift | (first + 1u));
        push(kEndOfInstance);
        instance = first;
        begin_instance(instance);
        push(floatBitsToUint(texelFetch(instances, int(instance * kInstanceTexels + 6u)).x));
        in_top_level = false;
      } else {
        for (uint i = 0u; i < count; ++i) test(first + i, instance);
        tests += count;
      }
    }
  }
}

void main() {
  uint local = gl_GlobalInvocationID.x;
  if (local >= wave.pixel_count) return;
  uint pixel_index = wave.first_pixel + local;
  pixel = uvec2(pixel_index % frame.width, pixel_index / frame.width);
  kept_count = 0u;
  farthest = kFar;
  walk();
  bool may_be_more = kept_count == kBeamTriangles || stack_size > 0u;
  while (kept_count > 0u && kept_depths[kept_count - 1u] > farthest) --kept_count; // what a triangle hides
  for (uint i = 0u; i < kBeamTriangles; ++i)
    beam_triangles[local * kBeamStride + i] = i < kept_count ? kept[i] : uvec2(kNone);
  beam_triangles[local * kBeamStride + kBeamTriangles] = uvec2(may_be_more ? 1u : 0u, 0u);
}
