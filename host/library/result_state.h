// A finished picture of the interface.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <wavepath/result.h>

#include "host/picture/files/exr.h"
#include "host/picture/picture.h"
#include "host/session/session.h"

namespace wavepath_v0 {

struct ResultState {
  wavepath::Picture picture;
  wavepath::PictureInfo info; // for files
  std::uint32_t spp = 0;
  double seconds = 0.0;
  std::optional<double> error;
  Stop stop = Stop::samples;
  std::string stats, repeat;
  std::vector<std::string> warnings;
};

} // namespace wavepath_v0
