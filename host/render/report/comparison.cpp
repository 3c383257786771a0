#include "host/render/report/comparison.h"

#include <cmath>

namespace wavepath {

void add_metrics(nlohmann::ordered_json& document, const PictureMetrics& metrics, double flip) {
  if (metrics.finite()) {
    document["mse"] = metrics.mse;
    document["relmse"] = metrics.relmse;
    document["mrse"] = metrics.mrse;
    document["relative_rms"] = std::sqrt(metrics.relmse);
    document["psnr"] = metrics.psnr;
    document["flip"] = flip;
    document["max"] = metrics.max;
    document["p99.9"] = metrics.p999;
    document["mean_ratio"] = metrics.mean_ratio;
  }
  document["nonfinite"] = {{"image", metrics.nonfinite_image}, {"reference", metrics.nonfinite_reference}};
}

} // namespace wavepath
