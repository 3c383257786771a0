// Discrete distributions as intervals of the 32-bit integers, which kernels/base/intervals.glsl picks from.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace wavepath {

// Ends of the intervals, in the order of the weights: u picks the first entry with u < end. The last interval ends at
// 2^32 - 1, and u is at most 2^32 - 2. An entry of weight 0 has an empty interval and is never picked; every other
// entry has at least one integer. `weights`: fewer than 2^31, finite, not negative. Empty if they sum to 0.
std::vector<std::uint32_t> build_intervals(std::span<const double> weights);
// The same into `ends`, of as many. Returns the sum of the weights; if it is 0, nothing was written.
double fill_intervals(std::span<const double> weights, std::span<std::uint32_t> ends);

// Table of cut points, where the search for an entry begins (Chen and Asau, "On Generating Random Variates from an
// Empirical Distribution", AIIE Transactions 6, 1974). Integers with the same top bits have one word: its lower half is
// the first entry that they pick, its upper half the last. With 65,536 entries or more, low bits of both are dropped.
// `ends`: result of build_intervals(), not empty.
std::vector<std::uint32_t> cut_intervals(std::span<const std::uint32_t> ends);
void fill_cuts(std::span<const std::uint32_t> ends, std::span<std::uint32_t> cuts); // the same into cut_count() words
std::size_t cut_count(std::size_t entries); // words of that table: a power of two

// Probability of picking entry i: exactly its fraction of the integers.
double interval_probability(std::span<const std::uint32_t> ends, std::size_t i);

} // namespace wavepath
