// Between stages: turns queue counts into indirect dispatch sizes, empties the queues that are written next, counts
// rays. Push constant `bounce`: see kAdvanceSteps.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_QUEUES
#define BIND_COUNTERS
#include "kernels/base/config.glsl"
#include "kernels/path/bindings.glsl"
#include "kernels/path/sky.glsl"

layout(local_size_x = 1) in;

uint groups_for(uint count) { return (count + kWorkgroupSize - 1u) / kWorkgroupSize; }

#define SIZE(groups, count)      \
  {                              \
    groups[0] = groups_for(count); \
    groups[1] = 1u;              \
    groups[2] = 1u;              \
  }

// Adds to a 64-bit total kept as two words.
#define COUNT(total, n)                    \
  {                                        \
    uint carry_;                           \
    total[0] = uaddCarry(total[0], n, carry_); \
    total[1] += carry_;                    \
  }

void prepare_extend(uint bounce) {
  uint count = queues.ray_count[bounce & 1u];
  SIZE(queues.extend_groups, count)
  queues.ray_count[(bounce + 1u) & 1u] = 0u;
  queues.hit_count = queues.escape_count = queues.next_ray = 0u;
  if (bounce == 0u) COUNT(counters.camera_rays, count) else COUNT(counters.bounce_rays, count)
}

void prepare_connect(uint light_sample) {
  if (light_sample > 0u) queues.shadow_count[0] = queues.shadow_count[light_sample];
  queues.first_shadow = light_sample * frame.slot_count;
  queues.next_shadow_ray = 0u;
  uint count = queues.shadow_count[0];
  SIZE(queues.connect_groups, count)
  COUNT(counters.shadow_rays, count)
}

void empty_shadow_queues() {
  queues.shadow_count[0] = 0u;
  for (uint i = 1u; i < shadow_queue_count(); ++i) queues.shadow_count[i] = 0u;
}

void main() {
  uint bounce = wave.bounce / kAdvanceSteps, step_ = wave.bounce % kAdvanceSteps;
  if (step_ == kBeforeExtend) {
    prepare_extend(bounce);
    empty_shadow_queues();
  } else if (step_ == kBeforeShade) {
    SIZE(queues.shade_groups, queues.hit_count)
    SIZE(queues.escape_groups, queues.escape_count)
    empty_shadow_queues(); // not when preparing extend, which may happen while connect still reads the queues
  } else {
    prepare_connect((step_ - kBeforeConnect) % kMostLightSamples);
    if (step_ >= kBeforeLastConnect) prepare_extend(bounce + 1u);
  }
}
