// Keeps surfaces from shading themselves: a texel of a map stands for an area of a surface, of which it knows one depth.
// Include look_up.glsl first.
#ifndef WAVEPATH_SHADOW_BIAS_GLSL
#define WAVEPATH_SHADOW_BIAS_GLSL

const float kSteepest = 64.0;      // tangent of the angle to the light up to which depth is offset by slope
const float kDepthRounding = 4e-6; // of a view's depth: maps hold floats, computed from floats

// Moves the point that asks, for the kind of bias that does.
void offset_receiver(inout Receiver r) {
  if (shadow.bias_kind != kBiasNormal) return;
  // By as much as a texel reaches across the surface (Holbert 2011).
  float sine = sqrt(max(1.0 - dot(r.normal, r.to_light) * dot(r.normal, r.to_light), 0.0));
  r.position += r.normal * (shadow.bias * sine * texel_width(r.view, r.depth));
  place_in_view(r.view, r.position, r.place);
  r.depth = view_depth(r.view, r.position);
}

// Depth of the receiver's own plane where a place in the view shows it.
float plane_depth(Receiver r, vec2 place) {
  vec4 a, b;
  planes_of_place(r.view, place, a, b);
  vec3 p = common_point(a, b, vec4(r.normal, -dot(r.normal, r.position)));
  float depth = view_depth(r.view, p);
  // Near the horizon the plane may be met behind the light or nowhere.
  float reach = kSteepest * texel_width(r.view, r.depth) * (1.0 + distance(place, r.place));
  return depth > 0.0 ? clamp(depth, r.depth - reach, r.depth + reach) : r.depth;
}

// The depth up to which a map's surface, seen at a place of the view, is taken for the receiver itself; `reach`: how many
// texels away from the receiver at most the map has sampled it.
float unshadowed_depth(Receiver r, vec2 place, float reach) {
  float width = texel_width(r.view, r.depth), rounding = kDepthRounding * r.view.far;
  if (shadow.bias_kind == kBiasConstant) return r.depth - shadow.bias * width;
  if (shadow.bias_kind == kBiasSlope) {
    float cosine = max(dot(r.normal, r.to_light), 1e-6);
    float slope = min(sqrt(max(1.0 - cosine * cosine, 0.0)) / cosine, kSteepest);
    return r.depth - shadow.bias * width * slope * 1.4142 * reach - rounding;
  }
  if (shadow.bias_kind == kBiasPlane && r.view.kind != kViewParaboloid)
    return plane_depth(r, place) - shadow.bias * width - rounding;
  if (shadow.bias_kind == kBiasCone) return r.depth - shadow.bias * width * (0.5 + reach) - rounding;
  return r.depth - rounding; // the map's own depths are moved, or the receiver is
}

// Of a texel, which sampled the surface at its centre.
float unshadowed_depth(Receiver r, ivec2 texel) {
  vec2 centre = vec2(texel) + 0.5, away = abs(centre - r.place);
  return unshadowed_depth(r, centre, max(max(away.x, away.y), 0.5));
}

// Whether a map leaves the receiver lit at a texel.
bool texel_lights(Receiver r, ivec2 texel) { return !(map_depth(r.view, texel) < unshadowed_depth(r, texel)); }

#endif
