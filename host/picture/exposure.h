// The exposure that a picture asks for: --exposure auto.
#pragma once

#include "host/picture/picture.h"

namespace wavepath {

// Stops that bring the log-average of the picture's luminance to kMiddle, or fewer, so that all but the brightest
// twentieth of it stays at kBright or below. Luminance is that of blocks, some 96 to a side, so that neither noise nor
// the picture's size matters; black blocks, where nothing is, do not count, and what is more than 8 stops below the
// mean counts as that. In hundredths of a stop, so that the value as it is printed gives the same picture. 0 if all is
// black.
double auto_exposure(const Picture& picture);

inline constexpr double kMiddle = 0.38, kBright = 1.0;

} // namespace wavepath
