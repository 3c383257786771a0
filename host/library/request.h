// From settings of the interface to the request of a render, by the flags of the command line.
#pragma once

#include <optional>

#include <wavepath/scene.h>
#include <wavepath/settings.h>

#include "host/cli/render_request.h"
#include "host/picture/files/write_options.h"

namespace wavepath {

struct LibraryRequest {
  RenderCommandRequest command;     // complete and checked, as resolve() leaves it
  std::optional<Picture> reference; // of --reference
};

// Reads and checks all settings. Throws UsageError for names that no flag has, and what the command line would throw.
LibraryRequest read_request(const wavepath_v0::Scene& scene, const wavepath_v0::Settings& settings);

// Of a picture of these files: exposure, tonemap, half and others. Throws UsageError.
WriteOptions read_write_options(const std::string& file, const wavepath_v0::Settings& settings);

} // namespace wavepath
