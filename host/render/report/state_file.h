// A render in progress as a file, so that it can be stopped at any moment and resumed to the same bits.
#pragma once

#include <string>

#include "host/render/loop/render_state.h"

namespace wavepath {

struct StateRecord {
  std::string identity; // see identity.h
  std::string device;   // name and driver that rendered it: other ones give other bits
  std::string plan;     // as to_line() of host/plan/record.h gives it
  RenderState state;
};

// Appears whole or not at all, even if the machine stops meanwhile: `path` holds either what it held or all of this.
// Throws Error.
void write_state(const std::string& path, const std::string& identity, const std::string& device,
                 const std::string& plan, const RenderState& state);

// Throws Error if the file is no state or not intact.
StateRecord read_state(const std::string& path);

} // namespace wavepath
