// State files: a render in progress, which can be stopped at any moment and resumed to the same bits.
#pragma once

#include <string>

#include "host/render/loop/render_state.h"

namespace wavepath {

struct StateRecord {
  std::string identity; // see identity.h
  std::string device;   // name and driver of the device; other devices give other bits
  std::string plan;     // result of to_line() in host/plan/record.h
  RenderState state;
};

// Writes a state. The file is replaced as a whole or not at all, even if the machine stops meanwhile. Throws Error.
void write_state(const std::string& path, const std::string& identity, const std::string& device,
                 const std::string& plan, const RenderState& state);

// Reads a state. Throws Error if the file is no state or is damaged.
StateRecord read_state(const std::string& path);

} // namespace wavepath
