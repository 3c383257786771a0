// The main() of kernels that trace a queue of rays. Include it behind trace.glsl and queue.glsl, and define before:
// RAY_COUNT; NEXT_RAY, the counter of those that some lane has begun; IS_COHERENT, whether neighbours in the queue take
// the same way; begin_ray(index), which sets the variables queued_...; end_ray(index, hit).
//
// Rays take very different numbers of steps, and a subgroup is done when its slowest ray is. So where lanes branch by
// themselves, those that are done take the next rays of the queue as soon as too few of their subgroup have one left
// (Aila and Laine 2009, Understanding the Efficiency of Ray Traversal on GPUs, section 4). APPEND needs lanes that
// enter it together to go through it together, as those of a basic block do; which lanes these are does not matter.
#ifndef WAVEPATH_TRACE_QUEUE_GLSL
#define WAVEPATH_TRACE_QUEUE_GLSL

#include "kernels/path/queue_item.glsl"

void trace_one(uint index) {
  if (index >= RAY_COUNT) return;
  begin_ray(index);
#ifdef ANY_HIT
  end_ray(index, trace(queued_origin, queued_direction, queued_t_max, queued_target, queued_target_instance));
#else
  end_ray(index, trace(queued_origin, queued_direction, queued_t_max));
#endif
}

#ifndef RAY_QUERY
// Half of a subgroup is kept busy.
bool is_half_busy(bool tracing) { return 2u * subgroupBallotBitCount(subgroupBallot(tracing)) >= gl_SubgroupSize; }

void trace_many() {
  uint count = RAY_COUNT, index = 0u, taken = 0u;
  bool tracing = false;
  for (;;) {
    if (!tracing) {
      if (taken++ == kLaneRays) return; // no ray is left over: a dispatch has a lane for each
      APPEND(NEXT_RAY, true, index);
      if (index >= count) return;
      begin_ray(index);
#ifdef ANY_HIT
      begin_kind(queued_target, queued_target_instance);
#else
      begin_kind();
#endif
      begin_traversal(queued_origin, queued_direction, queued_t_max);
      tracing = !is_over_by_lane();
    }
    do {
      if (tracing) {
        walk_by_lane(queued_origin, queued_direction, queued_t_max);
        tracing = !is_over_by_lane();
      }
    } while (is_half_busy(tracing));
    if (!tracing) end_ray(index, best);
  }
}
#endif

void main() {
#ifndef RAY_QUERY
  if (!kInStep && kLaneRays > 1u && !IS_COHERENT) {
    trace_many();
    return;
  }
#endif
  trace_one(queue_item());
}

#endif
