// The stats document: everything measured during a render, as JSON with fixed keys.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "host/gpu/device.h"
#include "host/plan/decision.h"
#include "host/render/multi_device/several_devices.h"
#include "host/render/render.h"
#include "host/render/report/true_error.h"
#include "host/scene/pack/pack.h"

namespace wavepath {

// An execution of `wavepath render`. The references must stay valid while the document is made.
struct Run {
  std::string scene, command;
  const DeviceInfo& device;
  const RenderPlan& settings;
  const PackedScene& packed;
  const RenderResult& result;
  double load_seconds = 0.0, write_seconds = 0.0;
  double total_seconds = 0.0; // from the start of the process
  std::uint64_t peak_bytes = 0;
  std::string kernel_cache{};                // what PipelineCache::describe() says
  std::vector<TrueError> true_errors{};      // one a checkpoint, or none
  std::optional<TrueError> denoised_error{}; // of the filtered picture
  std::vector<std::string> diagnosis{};
  std::vector<std::string> bias{};
  std::vector<Decision> plan{};              // with what came of it
  std::string repeat{};                      // a command that renders the same bits; empty = there is none
  const MultiDeviceResult* shared = nullptr; // of --devices
};

// The BVH: quality, seconds to build, expected cost, size, and copies of triangles made by spatial splits.
nlohmann::ordered_json bvh_json(const PackedScene& packed);

nlohmann::ordered_json stats_document(const Run& run);

// Text of a document, indented; bytes that are no UTF-8 (file names) are replaced rather than refused.
std::string to_text(const nlohmann::ordered_json& document);

// The estimated relative RMS error, once enough samples exist to estimate it.
std::optional<double> estimated_error(const RenderResult& result);

} // namespace wavepath
