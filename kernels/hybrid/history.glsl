// The history of filters that join frames: earlier frames where a pixel's point was seen, clipped to what is seen now.
#ifndef WAVEPATH_HISTORY_GLSL
#define WAVEPATH_HISTORY_GLSL

#include "kernels/hybrid/reproject.glsl"
#include "kernels/base/math.glsl"

layout(set = 0, binding = kFilterColorIn) uniform samplerBuffer color_in;
layout(set = 0, binding = kFilterColorOut, std430) writeonly buffer ColorBlock { vec4 color_out[]; };
layout(set = 0, binding = kFilterHistoryBefore) uniform samplerBuffer history_before;
layout(set = 0, binding = kFilterHistoryNow, std430) writeonly buffer HistoryBlock { vec4 history_now[]; };

const float kMostFrames = 10.0;  // most frames that a history counts for: a new frame gets a tenth
const float kClip = 1.25;        // half the clip box, in standard deviations of the neighbourhood
const float kLargest = 1e18;     // larger colours count as not finite

bool usable(vec3 c) { return is_finite(c) && all(lessThanEqual(abs(c), vec3(kLargest))); }

// Colours weigh 1 / (1 + luminance), so that one bright colour does not dominate the others.
float tone_weight(vec3 c) { return 1.0 / (1.0 + max(luminance(c), 0.0)); }
vec3 to_ycocg(vec3 c) {
  return vec3(dot(c, vec3(0.25, 0.5, 0.25)), dot(c, vec3(0.5, 0.0, -0.5)), dot(c, vec3(-0.25, 0.5, -0.25)));
}
vec3 from_ycocg(vec3 c) { return vec3(c.x + c.y - c.z, c.x + c.z, c.x - c.y - c.z); }

// Catmull-Rom's weights of the four pixels around a position, `part` after the second.
vec4 cubic(float part) {
  float p = part;
  return vec4(p * (-0.5 + p * (1.0 - 0.5 * p)), 1.0 + p * p * (-2.5 + 1.5 * p), p * (0.5 + p * (2.0 - 1.5 * p)),
              p * p * (-0.5 + 0.5 * p));
}

// The history at `position`: sharp where it can be, within the nearest four pixels so that it cannot ring. w: its
// frames.
vec4 history_at(vec2 position) {
  ivec2 corner = ivec2(floor(position));
  vec2 part = position - vec2(corner);
  vec4 across = cubic(part.x), down = cubic(part.y);
  vec3 sum = vec3(0.0), low = vec3(kFar), high = vec3(-kFar);
  float frames_in = kMostFrames;
  for (int i = 0; i < 16; ++i) {
    ivec2 step = ivec2(i & 3, i >> 2);
    vec4 tap = texelFetch(history_before, pixel_index(corner + step - 1));
    sum += across[step.x] * down[step.y] * tap.xyz;
    bool inner = all(equal((step + 1) & 2, ivec2(2)));
    low = inner ? min(low, tap.xyz) : low;
    high = inner ? max(high, tap.xyz) : high;
    frames_in = inner ? min(frames_in, tap.w) : frames_in;
  }
  return vec4(clamp(sum, low, high), frames_in);
}

// `history`, moved towards the mean of the surrounding 3x3 pixels until it lies in the clip box of their colours.
vec3 clip(vec3 history, vec3 mean, vec3 deviation) {
  float weight = tone_weight(history);
  vec3 away = to_ycocg(history * weight) - mean;
  vec3 relative = abs(away) / max(kClip * deviation, vec3(1e-7));
  float excess = max_component(relative);
  if (!(excess > 1.0)) return history;
  vec3 clipped = from_ycocg(mean + away / excess);
  return max(clipped, 0.0) / max(1.0 - luminance(clipped), 1e-7);
}

// Whether there was a picture at `position` in the frame before.
bool was_shown(vec2 position) {
  return frames.remembers != 0u && all(greaterThan(position, vec2(-0.5))) &&
         all(lessThan(position, vec2(picture_size()) - 0.5));
}

// Colours that surround a pixel, as the clip box needs them; those that are not finite do not count.
struct Neighbourhood {
  vec3 sum, squares; // tone-mapped YCoCg
  vec3 plain;        // linear
  float count;
};

void add_neighbour(vec3 color, inout Neighbourhood around) {
  if (!usable(color)) return;
  vec3 toned = to_ycocg(color * tone_weight(color));
  around.sum += toned;
  around.squares += toned * toned;
  around.plain += color;
  around.count += 1.0;
}

// `history`, clipped to the neighbourhood's mean and deviation.
vec3 clip(vec3 history, Neighbourhood around) {
  if (around.count == 0.0) return history;
  vec3 mean = around.sum / around.count;
  return clip(history, mean, sqrt(max(around.squares / around.count - mean * mean, 0.0)));
}

// A pixel's history and its colour now. w: frames in it, up to kMostFrames.
vec4 join(vec4 history, vec3 color) {
  float frames_in = min(history.w + 1.0, kMostFrames);
  float fraction = history.w == 0.0 ? 1.0 : 1.0 / frames_in;
  float now = fraction * tone_weight(color), then = (1.0 - fraction) * tone_weight(history.xyz);
  vec3 joined = fraction == 1.0 ? color : history.xyz + (color - history.xyz) * (now / (now + then));
  return vec4(joined, frames_in);
}

void store(int index, vec4 result) {
  color_out[index] = result;
  history_now[index] = result;
}

#endif
