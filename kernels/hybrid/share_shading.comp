// Gives a pixel the light that a frame before found for the triangle that this one sees, or keeps what this one found.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_HYBRID
#define BIND_VISIBILITY
#define BIND_SIGNALS
#define BIND_SEEN
#define BIND_SHARED_COLORS
#include "kernels/hybrid/bindings.glsl"
#include "kernels/path/bindings.glsl"
#include "kernels/hybrid/shared_colors.glsl"
#include "kernels/hybrid/frame_terms.glsl"

layout(local_size_x = kWorkgroupSize) in;

// Push constant: first_pixel = the first one, row by row from the top left, pixel_count = how many.
void main() {
  if (gl_GlobalInvocationID.x >= wave.pixel_count) return;
  uint pixel_index = wave.first_pixel + gl_GlobalInvocationID.x;
  SharedColor shared_ = shared_color(pixel_index);
  uint kept = color_index(shared_.color, pixel_index);
  if (!shared_.shades) {
    signals[pixel_index] = color_signals[kept];
    if (wants_lights()) seen[pixel_index] = color_seen[kept];
    return;
  }
  if (hybrid.sample_position == hybrid.first_position)
    for (uint color = 1u; color < kSharedColors; ++color) color_ids[color_index(color, pixel_index)] = kNoColor;
  color_ids[kept] = texelFetch(visibility, int(pixel_index)).xy;
  color_signals[kept] = signals[pixel_index];
  if (wants_lights()) color_seen[kept] = seen[pixel_index]; // otherwise nothing has a place in `seen`
}
