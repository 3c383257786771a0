// Ends a render: writes the pictures, makes the measurements that only the report needs, and reports.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "host/base/failure.h"
#include "host/cli/render_run.h"
#include "host/picture/picture.h"
#include "host/render/report/stats.h"

namespace wavepath {

// Writes pictures and stats of a render that goes on. What fails becomes a warning.
void save_so_far(const RenderCommandRequest& request, Prepared& prepared, const RenderResult& so_far);

// A finished render whose files are to be written. With what it owns, device and scene may go on to the next frame.
struct Unwritten {
  RenderCommandRequest request; // its list of pictures becomes that of those which could be written
  RenderPlan settings;
  Rendered rendered;
  PictureInfo info{};
  Warnings warnings{};
  Attempts attempts{};               // the picture as it was rendered is there, whatever becomes of its filtered one
  nlohmann::ordered_json document{}; // stats, but for the seconds of writing; null = nobody asked for them
  std::string text{};                // of the whole document
  std::optional<Run> run{};          // of the members above
};

// Ends a render up to its files: filters, passes, measurements. Takes `rendered`. Throws Error.
std::unique_ptr<Unwritten> end_render(const RenderCommandRequest& request, Prepared& prepared, Rendered& rendered,
                                      const std::optional<Picture>& reference);

// Writes pictures and stats: by any thread, as it needs neither device nor scene and prints nothing. What fails is told
// by tell().
void write(Unwritten& render);

// Reports what was written, and what was not. The scene must still be there for --verbose. Returns the exit code.
// Throws Error.
int tell(Unwritten& render);

// All three in one. Returns the exit code. Throws Error.
int finish(const RenderCommandRequest& request, Prepared& prepared, Rendered& rendered,
           const std::optional<Picture>& reference);

} // namespace wavepath
