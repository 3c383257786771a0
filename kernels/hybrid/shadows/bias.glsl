// Keeps surfaces from shading themselves: a texel of a map stands for an area of a surface, of which it knows one
// depth. Include look_up.glsl first.
#ifndef WAVEPATH_SHADOW_BIAS_GLSL
#define WAVEPATH_SHADOW_BIAS_GLSL

const float kSteepest = 64.0;      // metres of depth for a metre across, up to which depth is offset by slope
const float kDepthRounding = 4e-6; // rounding of a view's depth: maps hold floats, computed from floats

// Metres that the receiver's own plane falls back from the light over a metre across the view, at most kSteepest. Maps
// hold depths along the view's axis, so that it is the axis, not the ray, against which a plane slopes.
float plane_slope(Receiver r) {
  bool is_radial = r.view.kind == kViewParaboloid;
  vec3 axis = is_radial ? -r.to_light : normalize(r.view.depth.xyz);
  vec3 ray = r.view.kind == kViewPerspective ? (r.position - r.view.light) / r.depth : axis;
  float across = length(r.normal - axis * dot(r.normal, axis));
  return min(across / max(abs(dot(r.normal, ray)), 1e-6), kSteepest);
}

// Moves the point that asks, for the kind of bias that does.
void offset_receiver(inout Receiver r) {
  if (shadow.bias_kind != kBiasNormal) return;
  // Offset by the extent of a texel across the surface (Holbert 2011).
  float slope = plane_slope(r), sine = slope / sqrt(1.0 + slope * slope);
  r.position += r.normal * (shadow.bias * sine * texel_width(r.view, r.depth));
  project_to_view(r.view, r.position, r.map_position);
  r.depth = view_depth(r.view, r.position);
}

// Depth of the receiver's own plane where a position in the view shows it.
float plane_depth(Receiver r, vec2 position) {
  float depth;
  if (r.view.kind == kViewParaboloid) {
    vec3 origin, direction;
    ray_of_texel(r.view, position, origin, direction);
    depth = r.view.near + dot(r.normal, r.position - origin) / dot(r.normal, direction);
  } else {
    vec4 a, b;
    planes_of_texel(r.view, position, a, b);
    depth = view_depth(r.view, common_point(a, b, vec4(r.normal, -dot(r.normal, r.position))));
  }
  // Near the horizon the plane may be met behind the light or nowhere.
  float reach = kSteepest * texel_width(r.view, r.depth) * (1.0 + distance(position, r.map_position));
  return depth > 0.0 ? clamp(depth, r.depth - reach, r.depth + reach) : r.depth;
}

// The depth up to which a map's surface, seen at a position of the view, is taken for the receiver itself; `reach`: how
// many texels away from the receiver at most the map has sampled it.
float unshadowed_depth(Receiver r, vec2 position, float reach) {
  float width = texel_width(r.view, r.depth), rounding = kDepthRounding * r.view.far;
  if (shadow.bias_kind == kBiasConstant) return r.depth - shadow.bias * width;
  if (shadow.bias_kind == kBiasSlope) // depth that the plane gains up to the texel's centre
    return r.depth - shadow.bias * width * plane_slope(r) * 1.4142 * reach - rounding;
  if (shadow.bias_kind == kBiasPlane) return plane_depth(r, position) - shadow.bias * width - rounding;
  if (shadow.bias_kind == kBiasCone) return r.depth - shadow.bias * width * (0.5 + reach) - rounding;
  return r.depth - rounding; // the map's own depths are moved, or the receiver is
}

// Depth of the surface at a texel, which was sampled at its centre.
float unshadowed_depth(Receiver r, ivec2 texel) {
  vec2 centre = vec2(texel) + 0.5, away = abs(centre - r.map_position);
  return unshadowed_depth(r, centre, max(max(away.x, away.y), 0.5));
}

// True if the map leaves the receiver lit at a texel.
bool texel_lights(Receiver r, ivec2 texel) { return !(map_depth(r.view, texel) < unshadowed_depth(r, texel)); }

#endif
