// Picks an entry by intervals of the 32-bit integers. Entry i is picked by the numbers from the end of entry i - 1 to
// its own end (host/scene/pack/intervals.h). The rest of the number is stretched over all integers again, so that one
// number makes a choice and is then used on: points of a net that make the same choice still form a net.
#ifndef WAVEPATH_INTERVALS_GLSL
#define WAVEPATH_INTERVALS_GLSL

// The largest number that picks: an interval that ends at 2^32 is stored with its end one lower.
const uint kLargestPick = 0xfffffffeu;

// floor(offset * 2^32 / width) for offset < width, within 2: the quotient of floats errs by 2^9 at most, and that of
// the remainder takes this away.
uint stretch(uint offset, uint width) {
  uint quotient = uint(min(float(offset) * (4294967296.0 / float(width)), 4294967040.0));
  uint high, low, borrow;
  umulExtended(quotient, width, high, low);
  low = usubBorrow(0u, low, borrow);
  high = offset - high - borrow; // high:low = offset * 2^32 - quotient * width, in two's complement
  bool above = high >= 0x80000000u; // the quotient was too large
  if (above) high = ~high, low = ~low;
  uint correction = uint(min((float(high) * 4294967296.0 + float(low)) / float(width), 4096.0));
  return above ? quotient - min(correction + 1u, quotient) : quotient + min(correction, 0xffffffffu - quotient);
}

// Index of the first of `count` entries whose end lies beyond u, and its interval. END(i): the end of entry i.
#define PICK_INTERVAL(u, count, END, index, begin, end) \
  {                                                     \
    index = 0u;                                         \
    begin = 0u;                                         \
    uint beyond_ = (count) - 1u;                        \
    end = 0xffffffffu;                                  \
    while (index < beyond_) {                           \
      uint middle_ = (index + beyond_) >> 1u;           \
      uint end_ = END(middle_);                         \
      if (u < end_) {                                   \
        beyond_ = middle_;                              \
        end = end_;                                     \
      } else {                                          \
        index = middle_ + 1u;                           \
        begin = end_;                                   \
      }                                                 \
    }                                                   \
  }

// The same where words of cut_intervals() (host/scene/pack/intervals.h) tell between which entries the search is.
// CUT(i): word i. Tested at its end, the loop would find wrong entries on the CPU driver where ends are a storage block
// (benchmarks/results/NOTES.md), and it is no faster.
uint cut_bits(uint count) { return uint(clamp(findMSB(count) - kCutShift, 0, kMostCutBits)); }

#define PICK_INTERVAL_BY_CUTS(u, count, CUT, END, index, begin, end)          \
  {                                                                           \
    uint cut_ = CUT(((u) >> 1u) >> (31u - cut_bits(count)));                  \
    uint coarse_ = uint(max(findMSB(count) - 15, 0));                         \
    index = (cut_ & 0xffffu) << coarse_;                                      \
    uint beyond_ = min((((cut_ >> 16u) + 1u) << coarse_) - 1u, (count) - 1u); \
    while (index < beyond_) {                                                 \
      uint middle_ = (index + beyond_) >> 1u;                                 \
      if ((u) < END(middle_)) beyond_ = middle_;                              \
      else index = middle_ + 1u;                                              \
    }                                                                         \
    begin = index > 0u ? END(index - 1u) : 0u;                                \
    end = END(index);                                                         \
  }

#endif
