// Appending to a queue with one atomic a subgroup. Include bindings.glsl with BIND_QUEUES first; needs subgroup ballot.
#ifndef WAVEPATH_QUEUE_GLSL
#define WAVEPATH_QUEUE_GLSL

// Slot of this lane's entry in the queue counted by `counter`; meaningless where `wanted` is false.
#define APPEND(counter, wanted, slot)                                     \
  {                                                                       \
    uvec4 ballot_ = subgroupBallot(wanted);                               \
    uint first_ = 0u;                                                     \
    if (subgroupElect()) first_ = atomicAdd(counter, subgroupBallotBitCount(ballot_)); \
    slot = subgroupBroadcastFirst(first_) + subgroupBallotExclusiveBitCount(ballot_);  \
  }

#endif
