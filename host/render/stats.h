// The stats document: everything a run measured, as JSON with fixed keys.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "host/gpu/device.h"
#include "host/film/metrics.h"
#include "host/render/render.h"
#include "host/scene/pack/pack.h"

namespace wavepath {

// The names of settings, by the values of the kSampler..., kDirect..., kHemisphere... and kFilter... constants.
inline constexpr std::string_view kSamplerNames[] = {"independent", "stratified", "sobol"};
inline constexpr std::string_view kDirectNames[] = {"mis", "nee", "bsdf"};
inline constexpr std::string_view kHemisphereNames[] = {"cosine", "uniform"};
inline constexpr std::string_view kFilterNames[] = {"box", "gaussian", "blackman-harris"};

// Of the final picture, against --reference.
struct TrueError {
  PictureMetrics metrics;
  double flip = 0.0; // mean
};

// What a run consisted of. References stay valid while the document is made.
struct Run {
  std::string scene, command;
  const DeviceInfo& device;
  const RenderSettings& settings;
  const PackedScene& packed;
  const RenderResult& result;
  double load_seconds = 0.0, write_seconds = 0.0;
  double total_seconds = 0.0; // from the start of the process
  std::uint64_t peak_bytes = 0;
  std::string kernel_cache{};           // what PipelineCache::describe() says
  std::vector<TrueError> true_errors{}; // one a checkpoint, or none
  std::vector<std::string> diagnosis{};
  std::vector<std::string> bias{};
};

// What was built: quality, seconds, expected cost, size, and the copies of triangles that spatial splits made.
nlohmann::ordered_json bvh_json(const PackedScene& packed);

nlohmann::ordered_json stats_document(const Run& run);

// Text of a document, indented; bytes that are no UTF-8 (file names) are replaced rather than refused.
std::string to_text(const nlohmann::ordered_json& document);

// The estimated relative RMS error, once enough samples exist to estimate it.
std::optional<double> estimated_error(const RenderResult& result);

} // namespace wavepath
