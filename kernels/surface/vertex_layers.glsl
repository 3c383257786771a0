// Layers of a vertex's material, beyond metallic-roughness. Only for LAYERED kernels; included by vertex.glsl.
#ifndef WAVEPATH_VERTEX_LAYERS_GLSL
#define WAVEPATH_VERTEX_LAYERS_GLSL

// Colour channel of the path being shaded, once it has met glass that disperses: 0, 1, 2 = red, green, blue. Kernels
// that do not set it see all glass with the middle ior.
uint path_channel = 1u;

vec4 layer_value(uint index, vec4 uv) { return index == kNone ? vec4(1.0) : sample_texture(index, uv, false); }
vec4 layer_color(uint index, vec4 uv) { return index == kNone ? vec4(1.0) : sample_texture(index, uv, true); }

// Tangent of a layer whose texture is read by other coordinates than the normal map. layer: 0 = coat, 1 = grain.
// `first`: see MaterialLayers.
vec4 layer_tangent(Surface surface, uint first, int layer) {
  if (first == 0u) return surface.tangent;
  uvec3 vertex = texelFetch(triangle_vertices, int(surface.hit.triangle)).xyz;
  vec4 t[3];
  for (int k = 0; k < 3; ++k) {
    vec4 texel = texelFetch(vertex_normals, int(vertex[k] + first));
    t[k] = unpack_tangent(texel[layer]);
    if (kMoves) t[k].xyz = mix(t[k].xyz, unpack_tangent(texel[layer + 2]).xyz, shutter_time);
  }
  vec3 weights = vec3(1.0 - surface.hit.b1 - surface.hit.b2, surface.hit.b1, surface.hit.b2);
  vec4 tangent = vec4(interpolated(t[0].xyz, t[1].xyz, t[2].xyz, weights), t[0].w);
  return is_instanced() ? tangent_to_world(surface.hit.instance, tangent) : tangent;
}

// Fills in what the material has beyond metallic-roughness: rows of MaterialLayers.
void read_layers(inout Vertex v) {
  v.bsdf.coat = Coat(0.0, 0.0, vec3(0.0, 0.0, 1.0));
  v.bsdf.sheen = Sheen(vec3(0.0), 0.0, 0u);
  v.bsdf.film = Film(0.0, 1.0, 0.0);
  v.bsdf.stretched_alpha = vec2(v.bsdf.alpha);
  v.bsdf.diffuse_through = vec3(0.0);
  v.bsdf.diffuse_transmission = 0.0;
  v.bsdf.disperses = false;
  v.coat_normal = v.bumped;
  v.grain = vec3(0.0);
  uint m = v.surface.material;
  vec4 uv = v.surface.uv;
  if (uses_lobe(kLobeCoat)) {
    vec4 factors = uintBitsToFloat(fetch_layers(m, 1u));
    uvec4 maps = fetch_layers(m, 2u);
    if (factors.x > 0.0) {
      v.bsdf.coat.weight = factors.x * layer_value(floatBitsToUint(factors.w), uv).r;
      float roughness = factors.y * layer_value(maps.x, uv).g;
      v.bsdf.coat.alpha = roughness * roughness;
      vec3 n = v.surface.vertex_normal;
      bool reversed = dot(n, v.front ? v.surface.geometric_normal : -v.surface.geometric_normal) < 0.0;
      if (maps.y != kNone && has(kFeatureNormalMaps) && has_tangent(v.surface))
        n = mapped_normal(v.surface, layer_tangent(v.surface, fetch_layers(m, 3u).w, 0), n, maps.y, factors.z);
      v.coat_normal = reversed ? -n : n;
    }
  }
  if (uses_lobe(kLobeSheen)) {
    vec4 sheen = uintBitsToFloat(fetch_layers(m, 0u));
    if (max_component(sheen.rgb) > 0.0) {
      uvec4 maps = fetch_layers(m, 2u);
      v.bsdf.sheen.color = sheen.rgb * layer_color(maps.z, uv).rgb;
      v.bsdf.sheen.roughness = sheen.a * layer_value(maps.w, uv).a;
      v.bsdf.sheen.table = fetch_layers(m, 8u).z;
    }
  }
  if (uses_lobe(kLobeAnisotropy)) {
    uvec4 words = fetch_layers(m, 3u);
    float strength = uintBitsToFloat(words.x), rotation = uintBitsToFloat(words.y);
    if (strength > 0.0 && has_tangent(v.surface)) {
      vec2 direction = vec2(1.0, 0.0);
      if (words.z != kNone) {
        vec4 map = sample_texture(words.z, uv, false);
        direction = map.xy * 2.0 - 1.0;
        strength *= map.z;
      }
      direction = mat2(cos(rotation), sin(rotation), -sin(rotation), cos(rotation)) * direction;
      vec3 n = v.surface.vertex_normal;
      vec4 tangent = layer_tangent(v.surface, words.w, 1);
      vec3 t = safe_normalize(tangent.xyz - n * dot(n, tangent.xyz), vec3(0.0));
      v.grain = t * direction.x + cross(n, t) * (tangent.w * direction.y);
      float across = max(v.bsdf.alpha, kMinAlpha);
      v.bsdf.stretched_alpha = vec2(mix(across, 1.0, strength * strength), across);
    }
  }
  if (uses_lobe(kLobeIridescence)) {
    vec4 film = uintBitsToFloat(fetch_layers(m, 4u));
    if (film.x > 0.0) {
      uvec4 maps = fetch_layers(m, 5u);
      float weight = film.x * layer_value(maps.x, uv).r;
      v.bsdf.film = Film(weight, film.y, mix(film.z, film.w, layer_value(maps.y, uv).g));
      if (v.bsdf.film.nanometres <= 0.0) v.bsdf.film.weight = 0.0;
    }
  }
  if (uses_lobe(kLobeDispersion) && !v.bsdf.thin && v.bsdf.ior > 1.0) {
    // The ior falls linearly from blue to red, by (ior - 1) / Abbe number over the range, as KHR_materials_dispersion
    // has it.
    float dispersion = uintBitsToFloat(fetch_layers(m, 5u).z);
    v.bsdf.disperses = dispersion > 0.0 && v.bsdf.transmission > 0.0;
    float half_spread = 0.025 * dispersion * (v.bsdf.ior - 1.0);
    if (v.bsdf.disperses) v.bsdf.ior = max(v.bsdf.ior + (float(path_channel) - 1.0) * half_spread, 1.0);
  }
  if (uses_lobe(kLobeDiffuseTransmission)) {
    vec4 through = uintBitsToFloat(fetch_layers(m, 6u));
    if (through.w > 0.0) {
      uint share_map = fetch_layers(m, 7u).w, color_map = fetch_layers(m, 8u).x;
      v.bsdf.diffuse_through = through.rgb * layer_color(color_map, uv).rgb;
      v.bsdf.diffuse_transmission = through.w * layer_value(share_map, uv).a;
    }
  }
}

// The same in the local basis, which follows the grain of stretched microfacets.
void set_layer_basis(inout Vertex v) {
  if (has_lobe(kLobeAnisotropy) && is_stretched(v.bsdf)) {
    v.tangent = safe_normalize(v.grain - v.normal * dot(v.normal, v.grain), v.tangent);
    v.bitangent = cross(v.normal, v.tangent);
  }
  if (has_lobe(kLobeCoat) && v.bsdf.coat.weight > 0.0)
    v.bsdf.coat.normal = to_local(held_normal(v.coat_normal, v.wo), v.tangent, v.bitangent, v.normal);
}

bool lets_light_pass(Vertex v) {
  return v.bsdf.transmission > 0.0 || (has_lobe(kLobeDiffuseTransmission) && v.bsdf.diffuse_transmission > 0.0);
}

void turn_layers(inout Vertex v) { v.coat_normal = -v.coat_normal; }

#endif
