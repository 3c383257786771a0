// Automatic exposure (--exposure auto).
#pragma once

#include "host/picture/picture.h"

namespace wavepath {

// Exposure in stops that brings the log-average luminance of the picture to kMiddle, but lower if more than a twentieth
// of the picture would exceed kBright. Luminance is averaged over blocks, about 96 a side, so that neither noise nor
// the size of the picture matters. Black blocks, which show nothing, and mostly transparent ones do not count. Blocks
// that are more than 8 stops below the mean count as 8 stops below. The value is rounded to 1/100 stop, so that the
// printed value gives the same picture. 0 if everything is black.
double auto_exposure(const Picture& picture);

inline constexpr double kMiddle = 0.38, kBright = 1.0;

} // namespace wavepath
