// Ends the notes of a pilot's paths: what each has gathered, one lane a path.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_PATHS
#define BIND_GUIDE
#include "kernels/path/bindings.glsl"
#include "kernels/path/guide.glsl"
#include "kernels/path/records.glsl"

layout(local_size_x = kWorkgroupSize) in;

void main() {
  uint slot = gl_GlobalInvocationID.x;
  if (slot >= wave.pixel_count) return;
  float gathered = luminance(fetch_path(slot).radiance);
  for (uint bounce = 0u; bounce < kGuideBounces; ++bounce)
    guide_records[guide_record(wave.first_pixel + slot, bounce) + 2u].z = gathered;
}
