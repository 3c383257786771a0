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
#include "host/scene/staging/view.h"

namespace wavepath {

// A picture that is a frame of a sequence.
struct FrameReport {
  std::uint32_t number = 0;
  double at = 0.0, fps = 0.0; // seconds in the animation, of --at; frames a second
  double turned = 0.0;        // degrees, of a turntable
  double pose_seconds = 0.0, pack_seconds = 0.0;
  bool kept_surfaces = false, kept_geometry = false; // from the frame before
  std::uint64_t built_triangles = 0;                 // triangles of the trees that were built for this frame
};

// An execution of `wavepath render`, the input of the stats document. The references must stay valid while it is made.
struct Run {
  std::string scene, command;
  const DeviceInfo& device;
  const RenderPlan& settings;
  const PackedScene& packed;
  const RenderResult& result;
  double load_seconds = 0.0, write_seconds = 0.0;
  std::optional<double> pass_seconds{}; // of passes of --aov; empty if none is asked for
  double total_seconds = 0.0;           // from the start of the process
  std::uint64_t peak_bytes = 0;
  std::string kernel_cache{};                // text of PipelineCache::describe()
  std::vector<TrueError> true_errors{};      // one for each checkpoint; empty without a reference
  std::optional<TrueError> denoised_error{}; // of the filtered picture; empty without one
  std::vector<std::string> diagnosis{};
  std::vector<std::string> bias{};
  std::vector<Decision> plan{};              // decisions with their outcomes (add_outcomes())
  std::optional<FrameReport> frame{};        // empty = no sequence
  std::string repeat{};                      // command that renders the same bits; empty if there is none
  const MultiDeviceResult* shared = nullptr; // result of --devices; null on one device
  const View* view = nullptr;
};

// The BVH: quality, seconds to build, expected cost, size, and copies of triangles made by spatial splits.
nlohmann::ordered_json bvh_json(const PackedScene& packed);

nlohmann::ordered_json stats_document(const Run& run);

// Replaces in a document the seconds that are known only once the pictures are written.
void set_last_seconds(const Run& run, nlohmann::ordered_json& document);

// Text of a document, indented. Bytes that are no UTF-8, as in file names, are replaced.
std::string to_text(const nlohmann::ordered_json& document);

// The estimated relative RMS error; empty if there are too few samples.
std::optional<double> estimated_error(const RenderResult& result);

} // namespace wavepath
