#include "ktx/astc_parts.h"

namespace wavepath::ktx {
namespace {

// The five trits of 8 bits.
constexpr std::array<std::uint8_t, 5> trits_of(std::uint32_t t) {
  std::uint32_t c = 0, t4 = 0, t3 = 0;
  if ((t >> 2 & 7) == 7) {
    c = (t >> 5 & 7) << 2 | (t & 3);
    t4 = t3 = 2;
  } else {
    c = t & 31;
    if ((t >> 5 & 3) == 3) {
      t4 = 2;
      t3 = t >> 7 & 1;
    } else {
      t4 = t >> 7 & 1;
      t3 = t >> 5 & 3;
    }
  }
  std::uint32_t t2 = 0, t1 = 0, t0 = 0;
  if ((c & 3) == 3) {
    t2 = 2;
    t1 = c >> 4 & 1;
    t0 = (c >> 3 & 1) << 1 | ((c >> 2 & 1) & (~(c >> 3) & 1));
  } else if ((c >> 2 & 3) == 3) {
    t2 = t1 = 2;
    t0 = c & 3;
  } else {
    t2 = c >> 4 & 1;
    t1 = c >> 2 & 3;
    t0 = (c >> 1 & 1) << 1 | ((c & 1) & (~(c >> 1) & 1));
  }
  return {static_cast<std::uint8_t>(t0), static_cast<std::uint8_t>(t1), static_cast<std::uint8_t>(t2),
          static_cast<std::uint8_t>(t3), static_cast<std::uint8_t>(t4)};
}

// The three quints of 7 bits.
constexpr std::array<std::uint8_t, 5> quints_of(std::uint32_t q) {
  std::uint32_t q2 = 0, q1 = 0, q0 = 0;
  if ((q >> 1 & 3) == 3 && (q >> 5 & 3) == 0) {
    const std::uint32_t low = q & 1, others = low ? 0 : q >> 3 & 3;
    q2 = low << 2 | others;
    q1 = q0 = 4;
  } else {
    std::uint32_t c = 0;
    if ((q >> 1 & 3) == 3) {
      q2 = 4;
      c = (q >> 3 & 3) << 3 | (~(q >> 5) & 3) << 1 | (q & 1);
    } else {
      q2 = q >> 5 & 3;
      c = q & 31;
    }
    if ((c & 7) == 5) {
      q1 = 4;
      q0 = c >> 3 & 3;
    } else {
      q1 = c >> 3 & 3;
      q0 = c & 7;
    }
  }
  return {static_cast<std::uint8_t>(q0), static_cast<std::uint8_t>(q1), static_cast<std::uint8_t>(q2), 0, 0};
}

template <std::size_t count, class Decode>
constexpr std::array<std::array<std::uint8_t, 5>, count> table_of(Decode decode) {
  std::array<std::array<std::uint8_t, 5>, count> table{};
  for (std::size_t i = 0; i < count; ++i) table[i] = decode(static_cast<std::uint32_t>(i));
  return table;
}

constexpr auto kTrits = table_of<256>(trits_of);
constexpr auto kQuints = table_of<128>(quints_of);

// Packed trits or quints lie between the bits of their values: `shares` of them behind each.
template <std::size_t size>
void read_packed(const BlockBits& bits, unsigned first, unsigned low_bits, unsigned count,
                 const std::array<unsigned, size>& shares, const std::array<std::uint8_t, 5>* table,
                 std::uint8_t* values) {
  for (unsigned done = 0; done < count; done += size) {
    std::uint32_t low[size] = {}, packed = 0;
    const unsigned here = count - done < size ? count - done : static_cast<unsigned>(size);
    for (unsigned i = 0, shift = 0; i < here; shift += shares[i], ++i) {
      low[i] = bits.at(first, low_bits);
      packed |= bits.at(first + low_bits, shares[i]) << shift;
      first += low_bits + shares[i];
    }
    for (unsigned i = 0; i < here; ++i)
      values[done + i] = static_cast<std::uint8_t>(table[packed][i] << low_bits | low[i]);
  }
}

std::uint32_t hash52(std::uint32_t p) {
  p ^= p >> 15;
  p -= p << 17;
  p += p << 7;
  p += p << 4;
  p ^= p >> 5;
  p += p << 16;
  p ^= p >> 7;
  p ^= p >> 3;
  p ^= p << 6;
  p ^= p >> 17;
  return p;
}

// Repeats the bits of a value until `width` are filled.
constexpr std::uint32_t replicate(std::uint32_t value, unsigned bits, unsigned width) {
  std::uint32_t result = 0;
  for (int shift = static_cast<int>(width - bits); shift > -static_cast<int>(bits); shift -= static_cast<int>(bits))
    result |= shift >= 0 ? value << shift : value >> -shift;
  return result;
}

} // namespace

void read_integers(const BlockBits& bits, unsigned first, IntegerRange range, unsigned count, std::uint8_t* values) {
  if (range.trits > 0)
    read_packed<5>(bits, first, range.bits, count, {2, 2, 1, 2, 1}, kTrits.data(), values);
  else if (range.quints > 0)
    read_packed<3>(bits, first, range.bits, count, {3, 2, 2}, kQuints.data(), values);
  else
    for (unsigned i = 0; i < count; ++i)
      values[i] = static_cast<std::uint8_t>(bits.at(first + i * range.bits, range.bits));
}

std::uint8_t unquantize_color(IntegerRange range, std::uint32_t value) {
  if (range.trits + range.quints == 0) return static_cast<std::uint8_t>(replicate(value, range.bits, 8));
  // x: the bits above the lowest one, which B repeats in patterns of its own.
  constexpr std::uint32_t kTritFactors[7] = {0, 204, 93, 44, 22, 11, 5}, kQuintFactors[6] = {0, 113, 54, 26, 13, 6};
  const std::uint32_t d = value >> range.bits, m = value & ((1u << range.bits) - 1), x = m >> 1;
  const std::uint32_t a = m & 1 ? 0x1ff : 0;
  std::uint32_t b = 0;
  if (range.trits > 0) {
    switch (range.bits) {
      case 2:
        b = x << 8 | x << 4 | x << 2 | x << 1;
        break;
      case 3:
        b = x << 7 | x << 2 | x;
        break;
      case 4:
        b = x << 6 | x;
        break;
      case 5:
        b = x << 5 | x >> 2;
        break;
      case 6:
        b = x << 4 | x >> 4;
        break;
      default:
        break;
    }
  } else {
    switch (range.bits) {
      case 2:
        b = x << 8 | x << 3 | x << 2;
        break;
      case 3:
        b = x << 7 | x << 1 | x >> 1;
        break;
      case 4:
        b = x << 6 | x >> 1;
        break;
      case 5:
        b = x << 5 | x >> 3;
        break;
      default:
        break;
    }
  }
  const std::uint32_t c = range.trits > 0 ? kTritFactors[range.bits] : kQuintFactors[range.bits];
  const std::uint32_t mixed = (d * c + b) ^ a;
  return static_cast<std::uint8_t>((a & 0x80) | mixed >> 2);
}

std::uint8_t unquantize_weight(IntegerRange range, std::uint32_t value) {
  constexpr std::uint32_t kTritWeights[3] = {0, 32, 63}, kQuintWeights[5] = {0, 16, 32, 47, 63};
  constexpr std::uint32_t kTritFactors[4] = {0, 50, 23, 11}, kQuintFactors[3] = {0, 28, 13};
  std::uint32_t weight = 0;
  if (range.trits + range.quints == 0) {
    weight = replicate(value, range.bits, 6);
  } else if (range.bits == 0) {
    weight = range.trits > 0 ? kTritWeights[value] : kQuintWeights[value];
  } else {
    const std::uint32_t d = value >> range.bits, m = value & ((1u << range.bits) - 1), x = m >> 1;
    const std::uint32_t a = m & 1 ? 0x7f : 0;
    std::uint32_t b = 0;
    if (range.trits > 0)
      b = range.bits == 2 ? x << 6 | x << 2 | x : range.bits == 3 ? x << 5 | x : 0;
    else
      b = range.bits == 2 ? x << 6 | x << 1 : 0;
    const std::uint32_t c = range.trits > 0 ? kTritFactors[range.bits] : kQuintFactors[range.bits];
    weight = (a & 0x20) | ((d * c + b) ^ a) >> 2;
  }
  return static_cast<std::uint8_t>(weight > 32 ? weight + 1 : weight);
}

std::uint32_t partition_of(std::uint32_t seed, std::uint32_t x, std::uint32_t y, std::uint32_t partitions, bool small) {
  if (small) {
    x <<= 1;
    y <<= 1;
  }
  seed += (partitions - 1) * 1024;
  const std::uint32_t random = hash52(seed);
  const std::uint32_t one = seed & 2 ? 4 : 5, other = partitions == 3 ? 6 : 5;
  const std::uint32_t even = seed & 1 ? one : other, odd = seed & 1 ? other : one;
  const auto factor = [&](unsigned shift, std::uint32_t down) {
    const std::uint32_t nibble = random >> shift & 15;
    return nibble * nibble >> down;
  };
  const std::uint32_t a = (factor(0, even) * x + factor(4, odd) * y + (random >> 14)) & 63;
  const std::uint32_t b = (factor(8, even) * x + factor(12, odd) * y + (random >> 10)) & 63;
  const std::uint32_t c = partitions < 3 ? 0 : (factor(16, even) * x + factor(20, odd) * y + (random >> 6)) & 63;
  const std::uint32_t d = partitions < 4 ? 0 : (factor(24, even) * x + factor(28, odd) * y + (random >> 2)) & 63;
  if (a >= b && a >= c && a >= d) return 0;
  if (b >= c && b >= d) return 1;
  return c >= d ? 2 : 3;
}

} // namespace wavepath::ktx
