// Records of light paths and connections, read and written 16 bytes at a time (see kernels/base/records.glsl).
#ifndef WAVEPATH_BIDIRECTIONAL_RECORDS_GLSL
#define WAVEPATH_BIDIRECTIONAL_RECORDS_GLSL

#ifdef BIND_PATH_WEIGHTS
PathWeights fetch_weights(uint slot) { return PathWeights(path_weights[slot].x, path_weights[slot].y); }
void store_weights(uint slot, PathWeights weights) { path_weights[slot] = vec2(weights.connect, weights.others); }
#endif

#ifdef BIND_LIGHT_VERTICES
uint light_vertex_index(uint slot, uint k) { return k * frame.slot_count + slot; }

LightVertex fetch_light_vertex(uint index) {
  int texel = int(4u * index);
  uvec4 direction_bounce = texelFetch(light_vertex_texels, texel);
  vec4 light_connect = uintBitsToFloat(texelFetch(light_vertex_texels, texel + 1));
  uvec4 hit = texelFetch(light_vertex_texels, texel + 2);
  uvec4 others_outside = texelFetch(light_vertex_texels, texel + 3);
  return LightVertex(uintBitsToFloat(direction_bounce.xyz), direction_bounce.w, light_connect.xyz, light_connect.w,
                     hit.x, hit.y, uintBitsToFloat(hit.z), uintBitsToFloat(hit.w), uintBitsToFloat(others_outside.x),
                     others_outside.y, others_outside.z, 0u);
}
void store_light_vertex(uint index, LightVertex v) {
  light_vertex_words[4u * index] = uvec4(floatBitsToUint(v.direction), v.bounce);
  light_vertex_words[4u * index + 1u] = uvec4(floatBitsToUint(v.light), floatBitsToUint(v.connect));
  light_vertex_words[4u * index + 2u] = uvec4(v.triangle, v.instance, floatBitsToUint(v.b1), floatBitsToUint(v.b2));
  light_vertex_words[4u * index + 3u] = uvec4(floatBitsToUint(v.others), v.outside, v.group, 0u);
}
#endif

#ifdef BIND_CONNECTIONS
void store_connection(uint index, Connection c) {
  connection_words[4u * index] = uvec4(floatBitsToUint(c.origin), c.slot);
  connection_words[4u * index + 1u] = uvec4(floatBitsToUint(c.direction), c.triangle);
  connection_words[4u * index + 2u] = uvec4(floatBitsToUint(c.contribution), c.instance);
  connection_words[4u * index + 3u] = uvec4(c.pixel, c.group, c.in_body, 0u);
}
Connection fetch_connection(uint index) {
  int texel = int(4u * index);
  uvec4 origin_slot = texelFetch(connection_texels, texel);
  uvec4 direction_triangle = texelFetch(connection_texels, texel + 1);
  uvec4 contribution_instance = texelFetch(connection_texels, texel + 2);
  uvec4 pixel_group = texelFetch(connection_texels, texel + 3);
  return Connection(uintBitsToFloat(origin_slot.xyz), origin_slot.w, uintBitsToFloat(direction_triangle.xyz),
                    direction_triangle.w, uintBitsToFloat(contribution_instance.xyz), contribution_instance.w,
                    pixel_group.x, pixel_group.y, pixel_group.z, 0u);
}
#endif

#endif
