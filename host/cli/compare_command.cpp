// wavepath compare: how far an image is from a reference, as numbers, as a map and as a check.
#include <algorithm>
#include <filesystem>
#include <memory>
#include <numeric>

#include <fmt/format.h>

#include "host/base/atomic_file.h"
#include "host/base/error.h"
#include "host/base/output_files.h"
#include "host/base/print.h"
#include "host/cli/commands.h"
#include "host/cli/flags.h"
#include "host/picture/error_map.h"
#include "host/picture/files/picture_io.h"
#include "host/picture/metrics/metrics.h"
#include "host/picture/place.h"
#include "host/render/report/comparison.h"
#include "host/render/report/stats.h"

namespace wavepath {
namespace {

using Json = nlohmann::ordered_json;

struct Limit {
  std::string metric;
  double value = 0.0;
};

struct CompareCommandRequest {
  std::string image, reference, map;
  std::vector<Limit> limits;
  bool json = false;
};

// Metrics that --max can bound: all those where less is better.
const std::string_view kBoundable[] = {"mse", "relmse", "mrse", "relative_rms", "flip", "max", "p99.9"};

bool is_display(const std::string& path) {
  const auto format = picture_format(path);
  return format == PictureFormat::png || format == PictureFormat::jpg;
}

void print(const Json& json) {
  for (const auto& [name, value] : json.items()) {
    std::string text;
    if (value.is_string()) text = value.get<std::string>();
    if (value.is_number()) text = fmt::format("{:.8g}", value.get<double>());
    if (name == "mean_ratio") text = fmt::format("{:.6f}", fmt::join(value.get<std::vector<double>>(), " "));
    if (name == "nonfinite")
      text = fmt::format("image {}, reference {}", value["image"].get<std::uint64_t>(),
                         value["reference"].get<std::uint64_t>());
    print_out("{:<13}{}\n", name, text);
  }
}

int run_compare(const CompareCommandRequest& request) {
  if (!request.map.empty()) {
    if (!is_display(request.map))
      throw UsageError(request.map, "is no .png or .jpg", "give the map one of these extensions");
    const std::string inputs[] = {request.image, request.reference};
    refuse_overwriting({&request.map, 1}, inputs);
    require_writable(request.map);
  }
  const Picture image = read_picture(request.image);
  Picture reference = read_picture(request.reference);
  if (std::optional<Picture> part = cut_to(reference, image)) reference = *std::move(part);
  if (!request.map.empty()) require_format(request.map, image.width, image.height);
  const bool display = image.display && reference.display;
  const PictureMetrics metrics = compare_pictures(image, reference, display ? 1.0 : 0.0);
  double flip = 0.0;
  if (metrics.finite()) {
    const std::vector<float> map = display ? ldr_flip(image, reference) : hdr_flip(image, reference);
    flip = std::accumulate(map.begin(), map.end(), 0.0) / static_cast<double>(map.size());
    if (!request.map.empty())
      write_picture(request.map, error_map(image.width, image.height, map), {}, {false, 0.0, Tonemap::none});
  }

  Json json{{"image", request.image}, {"reference", request.reference}};
  add_metrics(json, metrics, flip);
  std::string exceeded;
  if (metrics.finite())
    for (const Limit& limit : request.limits)
      if (const double value = json[limit.metric]; !(value <= limit.value))
        exceeded += fmt::format("{}{} is {:.8g}, more than {:.8g}", exceeded.empty() ? "" : ", ", limit.metric, value,
                                limit.value);
  if (request.json) {
    print_out("{}", to_text(json));
  } else {
    print(json);
  }
  if (!metrics.finite())
    throw Error(metrics.nonfinite_image > 0 ? request.image : request.reference, "holds values that are not finite",
                "an image with such values has no score");
  if (!exceeded.empty()) throw Error(request.image, exceeded, "look at both pictures, or use --map");
  return kExitDone;
}

void read_limit(const FlagValue& value, std::vector<Limit>& limits) {
  const std::size_t middle = value.text.find('=');
  if (middle == std::string::npos) value.refuse("has the wrong form", "write it as METRIC=VALUE, such as relmse=0.01");
  const FlagValue metric{value.flag, value.text.substr(0, middle)}, bound{value.flag, value.text.substr(middle + 1)};
  metric.choice(kBoundable);
  limits.push_back({metric.text, bound.number(0.0, 1e30)});
}

} // namespace

Command add_compare(CLI::App& app) {
  CLI::App* command = add_command(
      app, "compare", "measure the difference between a picture and a reference",
      "All metrics use linear values of all pixels and R, G, B. Pictures of 8 and 16 bits, such as .png and .jpg, are "
      "first decoded from sRGB. FLIP is HDR-FLIP, or LDR-FLIP if both pictures have 8 or 16 bits. The peak of PSNR is "
      "the largest value of the reference, or 1 if both pictures have 8 or 16 bits.");
  const auto request = std::make_shared<CompareCommandRequest>();
  const auto keep = [](std::string& text) { return [&text](const FlagValue& value) { text = value.text; }; };
  require(add_flag(*command, "Pictures",
                   {"IMAGE", "FILE", "picture to measure: .exr, .hdr, .png, .jpg or another format"},
                   keep(request->image)));
  require(add_flag(*command, "Pictures", {"REFERENCE", "FILE", "reference picture of the same size"},
                   keep(request->reference)));
  add_flag(*command, "Output",
           {"--map", "FILE.png", "picture of the FLIP error to write. Black is 0, pale yellow is 1", "not written"},
           keep(request->map));
  add_flag(
      *command, "Output",
      {"--max", "METRIC=VALUE",
       "limit of a metric: mse, relmse, mrse, relative_rms, flip, max, p99.9; repeatable. Exit code 1 if the metric is "
       "larger"},
      [request](const FlagValue& value) { read_limit(value, request->limits); }, true);
  add_switch(*command, "Output", {"--json", "", "print one JSON document", "off"}, request->json);
  return [request] { return run_compare(*request); };
}

} // namespace wavepath
