// Transforms points and vectors between the world and an instance's space. Include bindings.glsl with BIND_GEOMETRY
// first.
#ifndef WAVEPATH_INSTANCE_GLSL
#define WAVEPATH_INSTANCE_GLSL

vec3 transform_point(uint first_texel, vec3 p) {
  vec4 q = vec4(p, 1.0);
  return vec3(dot(texelFetch(instances, int(first_texel)), q), dot(texelFetch(instances, int(first_texel + 1u)), q),
              dot(texelFetch(instances, int(first_texel + 2u)), q));
}
vec3 transform_vector(uint first_texel, vec3 v) {
  return vec3(dot(texelFetch(instances, int(first_texel)).xyz, v),
              dot(texelFetch(instances, int(first_texel + 1u)).xyz, v),
              dot(texelFetch(instances, int(first_texel + 2u)).xyz, v));
}

#endif
