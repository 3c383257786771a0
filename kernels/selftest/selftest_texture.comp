// Evaluates a texture. Input: in the queue, slot = texture and origin.xy = coordinates; t_max < 0: of values, not of
// colours. Output: the colour, as the words of a hit.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_SURFACES
#define BIND_RAYS
#define BIND_QUEUES
#include "kernels/path/bindings.glsl"
#include "kernels/path/records.glsl"
#include "kernels/surface/texture.glsl"

layout(local_size_x = kWorkgroupSize) in;

void main() {
  uint index = gl_GlobalInvocationID.x;
  if (index >= queues.ray_count[0]) return;
  Ray request = fetch_ray(index);
  vec4 uv = vec4(request.origin.xy, 0.0, 0.0);
  vec4 color;
  if (request.t_max < 0.0)
    color = sample_texture(request.slot, uv, false);
  else
    color = sample_texture(request.slot, uv, true);
  store_hit(index, Hit(floatBitsToUint(color.r), floatBitsToUint(color.g), color.b, color.a));
}
