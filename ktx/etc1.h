// What all kinds of ETC1 blocks share: the modifiers, and the widening of base colours.
#pragma once

#include <array>
#include <cstdint>

namespace wavepath::ktx {

// By table codeword, then -b, -a, +a, +b.
constexpr std::array<std::array<std::int16_t, 4>, 8> kEtc1Modifiers = {{{-8, -2, 2, 8},
                                                                        {-17, -5, 5, 17},
                                                                        {-29, -9, 9, 29},
                                                                        {-42, -13, 13, 42},
                                                                        {-60, -18, 18, 60},
                                                                        {-80, -24, 24, 80},
                                                                        {-106, -33, 33, 106},
                                                                        {-183, -47, 47, 183}}};

constexpr int widen4(int value) { return value * 17; }
constexpr int widen5(int value) { return value << 3 | value >> 2; }
constexpr int widen6(int value) { return value << 2 | value >> 4; }
constexpr int widen7(int value) { return value << 1 | value >> 6; }

} // namespace wavepath::ktx
