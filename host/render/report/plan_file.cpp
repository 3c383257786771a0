#include "host/render/report/plan_file.h"

#include <fstream>

#include <nlohmann/json.hpp>

#include "host/base/error.h"
#include "host/picture/files/exr.h"
#include "host/picture/picture_format.h"
#include "host/render/report/state_file.h"

namespace wavepath {
namespace {

using Json = nlohmann::ordered_json;

} // namespace

PlanRecord read_plan(const std::string& path) try {
  if (path.ends_with(".exr")) {
    const std::string text = read_attribute(path, "wavepath.plan");
    if (text.empty())
      throw Error(path, "holds no plan of a render", "name a picture that wavepath render wrote, or its stats");
    return record_from(Json::parse(text));
  }
  if (path.ends_with(".json")) {
    std::ifstream file(path);
    if (!file) throw Error(path, "cannot be read", "check the name");
    return record_from(Json::parse(file).at("plan"));
  }
  return record_from(Json::parse(read_state(path).plan));
} catch (const nlohmann::json::exception&) {
  throw Error(path, "holds no plan of a render", "name a picture, a state or stats that wavepath render wrote");
}

} // namespace wavepath
