// The metrics of a comparison as a document: what `compare --json` prints.
#pragma once

#include <nlohmann/json.hpp>

#include "host/picture/metrics/metrics.h"

namespace wavepath {

// Appends metrics, if both pictures are finite, and the numbers of values that are not. `flip`: the mean over pixels.
void add_metrics(nlohmann::ordered_json& document, const PictureMetrics& metrics, double flip);

} // namespace wavepath
