// Discrete distributions as intervals of the 32-bit integers, which kernels/base/intervals.glsl picks from.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace wavepath {

// Ends of the intervals, in the order of the weights: u picks the first entry with u < end. The last one ends at
// 2^32 - 1, where u is at most 2^32 - 2. An entry of weight zero has an empty interval and is never picked; every other
// one has at least one integer. `weights`: finite, none negative, fewer than 2^31. Empty if they sum to zero.
std::vector<std::uint32_t> build_intervals(std::span<const double> weights);

// Where the search for the entry that u picks begins: a table of cut points (Chen and Asau, "On Generating Random
// Variates from an Empirical Distribution", AIIE Transactions 6, 1974). Integers that agree in their top bits share a
// word: the first entry that they pick in its lower half, the last in its upper half, both without the bits for which
// 65,536 entries and more leave no room. `ends`: as build_intervals() makes them, at least one.
std::vector<std::uint32_t> cut_intervals(std::span<const std::uint32_t> ends);
std::size_t cut_count(std::size_t entries); // words of it: a power of two

// Of picking entry i: exactly its fraction of the integers.
double interval_probability(std::span<const std::uint32_t> ends, std::size_t i);

} // namespace wavepath
