// Colours of a pixel that frames share (kHybridMultisample): each frame sees one position, and the first that sees a
// triangle shades it for all. Include bindings.glsl with BIND_HYBRID, BIND_VISIBILITY and BIND_SHARED_COLORS first.
#ifndef WAVEPATH_SHARED_COLORS_GLSL
#define WAVEPATH_SHARED_COLORS_GLSL

const uvec2 kNoColor = uvec2(kNone - 1u, 0u); // no triangle, nor what is seen where none is

bool multisamples() { return (hybrid.flags & kHybridMultisample) != 0u; }

uint color_index(uint color, uint pixel_index) { return color * frame.width * frame.height + pixel_index; }

struct SharedColor {
  uint color;  // the one that the pixel shows in this frame
  bool shades; // this frame is the first with it
};

// A triangle for which no colour is left takes the last one (Young 2006: coverage without a colour of its own).
SharedColor shared_color(uint pixel_index) {
  if (hybrid.sample_position == hybrid.first_position) return SharedColor(0u, true);
  uvec2 visible = texelFetch(visibility, int(pixel_index)).xy;
  for (uint color = 0u; color < kSharedColors; ++color) {
    uvec2 id = color_ids[color_index(color, pixel_index)];
    if (id == visible || id == kNoColor) return SharedColor(color, id != visible);
  }
  return SharedColor(kSharedColors - 1u, false);
}

#endif
