// Positions of a pixel that share shading (kHybridMultisample): frames see one each, and the first that sees a triangle
// shades it for all. Include bindings.glsl with BIND_HYBRID, BIND_VISIBILITY and BIND_POSITIONS first.
#ifndef WAVEPATH_COVERED_POSITIONS_GLSL
#define WAVEPATH_COVERED_POSITIONS_GLSL

bool multisamples() { return (hybrid.flags & kHybridMultisample) != 0u; }

uint position_index(uint sample_position, uint pixel_index) {
  return sample_position * frame.width * frame.height + pixel_index;
}

// The frame whose shading the pixel shows: this one, or one of those of its group before it.
uint shading_position(uint pixel_index) {
  uvec2 visible = texelFetch(visibility, int(pixel_index)).xy;
  for (uint p = hybrid.first_position; p < hybrid.sample_position; ++p)
    if (position_ids[position_index(p, pixel_index)] == visible) return p;
  return hybrid.sample_position;
}

#endif
