// Threshold of the cost that pilots predict: one constant for all of them.
#pragma once

namespace wavepath {

// Relative costs above this do not differ significantly from 1.
inline constexpr double kWorthwhile = 0.9;

} // namespace wavepath
