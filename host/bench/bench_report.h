// The output of `wavepath bench`: a table, a JSON document, and the change against an earlier document.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "host/bench/bench.h"
#include "host/gpu/device.h"

namespace wavepath {

struct BenchRun {
  std::string scene;
  const DeviceInfo& device;
  const PackedScene& packed;
  const BenchSettings& settings;
  const BenchResult& result;
};

nlohmann::ordered_json bench_document(const BenchRun& run);

// Every number with its unit, for a terminal of 100 columns.
std::string bench_table(const BenchRun& run);

struct Change {
  std::string text;           // a line for each rate
  double worst_percent = 0.0; // the largest loss, as a positive number
};

// `before` is a document that bench_document() made. Throws Error, naming `path`, if it is none, or of another scene or
// device.
Change compare_with_baseline(const nlohmann::ordered_json& now, const nlohmann::ordered_json& before,
                             const std::string& path);

} // namespace wavepath
