// Places of a pixel that share shading (kHybridMultisample): frames see one each, and the first that sees a triangle
// shades it for all. Include bindings.glsl with BIND_HYBRID, BIND_VISIBILITY and BIND_PLACES first.
#ifndef WAVEPATH_COVERED_PLACES_GLSL
#define WAVEPATH_COVERED_PLACES_GLSL

bool multisamples() { return (hybrid.flags & kHybridMultisample) != 0u; }

uint place_entry(uint sample_place, uint place) { return sample_place * frame.width * frame.height + place; }

// The frame whose shading the pixel shows: this one, or one of those of its group before it.
uint shading_place(uint place) {
  uvec2 visible = texelFetch(visibility, int(place)).xy;
  for (uint p = hybrid.first_place; p < hybrid.sample_place; ++p)
    if (place_ids[place_entry(p, place)] == visible) return p;
  return hybrid.sample_place;
}

#endif
