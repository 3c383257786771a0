// Parts of pixels that consecutive frames see (kHybridFractions). Include bindings.glsl with BIND_HYBRID and
// BIND_FRACTIONS first.
#ifndef WAVEPATH_FRACTIONS_GLSL
#define WAVEPATH_FRACTIONS_GLSL

// Fraction of the pixel that the frame sees; 1 where frames see whole pixels.
float seen_fraction(uint pixel_index) {
  if ((hybrid.flags & kHybridFractions) == 0u) return 1.0;
  return fractions[hybrid.sample_position * frame.width * frame.height + pixel_index];
}

// Weight of the frame among those that see the pixel's parts, so that their mean is the sum over these.
float frame_weight(uint pixel_index) {
  return (hybrid.flags & kHybridFractions) == 0u ? 1.0 : float(kFractions) * seen_fraction(pixel_index);
}

#endif
