// Prints the trace of one path.
#pragma once

#include <cstdint>

#include <nlohmann/json.hpp>

#include "host/integrators/path/path_replay.h"

namespace wavepath {

// Positions are in the scene's world. Numbers that are not finite are the texts "inf", "-inf" and "nan".
nlohmann::ordered_json trace_document(const PathTrace& trace, const PackedScene& scene, const RenderPlan& settings);

// The same document as text for a terminal.
std::string trace_text(const nlohmann::ordered_json& document);

} // namespace wavepath
