// Keeps surfaces from shading themselves: a texel of a map stands for an area of a surface, of which it knows one depth.
// Include look_up.glsl first.
#ifndef WAVEPATH_SHADOW_BIAS_GLSL
#define WAVEPATH_SHADOW_BIAS_GLSL

const float kSteepest = 64.0;      // tangent of the angle to the light up to which depth is offset by slope
const float kDepthRounding = 4e-6; // of a view's depth: maps hold floats, computed from floats

// Sine of the angle between the surface and the one whose depth is the same everywhere. In perspective that is a plane, so
// that surfaces beside the axis have a slope though they face the light.
float depth_sine(Receiver r) {
  return length(cross(r.normal, r.view.kind == kViewParaboloid ? r.to_light : r.view.depth.xyz));
}

// How much depth changes across the surface, in metres for a metre across the view.
float depth_slope(Receiver r) {
  float cosine = max(dot(r.normal, r.to_light), 1e-6);
  float off_axis = r.view.kind == kViewPerspective ? -dot(r.view.depth.xyz, r.to_light) : 1.0;
  return min(depth_sine(r) * off_axis / cosine, kSteepest);
}

// Moves the point that asks, for the kind of bias that does.
void offset_receiver(inout Receiver r) {
  if (shadow.bias_kind != kBiasNormal) return;
  // By as much as a texel reaches across the surface (Holbert 2011).
  r.position += r.normal * (shadow.bias * depth_sine(r) * texel_width(r.view, r.depth));
  place_in_view(r.view, r.position, r.place);
  r.depth = view_depth(r.view, r.position);
}

// Depth of the receiver's own plane where a place in the view shows it.
float plane_depth(Receiver r, vec2 place) {
  float depth;
  if (r.view.kind == kViewParaboloid) {
    vec3 origin, direction;
    ray_of_place(r.view, place, origin, direction);
    depth = r.view.near + dot(r.normal, r.position - origin) / dot(r.normal, direction);
  } else {
    vec4 a, b;
    planes_of_place(r.view, place, a, b);
    depth = view_depth(r.view, common_point(a, b, vec4(r.normal, -dot(r.normal, r.position))));
  }
  // Near the horizon the plane may be met behind the light or nowhere.
  float reach = kSteepest * texel_width(r.view, r.depth) * (1.0 + distance(place, r.place));
  return depth > 0.0 ? clamp(depth, r.depth - reach, r.depth + reach) : r.depth;
}

// The depth up to which a map's surface at a texel, whose centre is `reach` texels away at most, is taken for the
// receiver itself.
float unshadowed_depth(Receiver r, ivec2 texel) {
  vec2 centre = vec2(texel) + 0.5;
  float width = texel_width(r.view, r.depth), rounding = kDepthRounding * r.view.far;
  vec2 away = abs(centre - r.place);
  float reach = max(away.x, away.y);
  if (shadow.bias_kind == kBiasConstant) return r.depth - shadow.bias * width;
  if (shadow.bias_kind == kBiasSlope)
    return r.depth - shadow.bias * width * depth_slope(r) * max(1.4142 * reach, 0.7072) - rounding;
  if (shadow.bias_kind == kBiasPlane) return plane_depth(r, centre) - shadow.bias * width - rounding;
  if (shadow.bias_kind == kBiasCone) return r.depth - shadow.bias * width * (0.5 + reach) - rounding;
  return r.depth - rounding; // the map's own depths are moved, or the receiver is
}

// Whether a map leaves the receiver lit at a texel.
bool texel_lights(Receiver r, ivec2 texel) { return !(map_depth(r.view, texel) < unshadowed_depth(r, texel)); }

#endif
