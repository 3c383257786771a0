#include "host/serve/message.h"

#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <glm/gtc/constants.hpp>
#include <nlohmann/json.hpp>

namespace wavepath {
namespace {

using Json = nlohmann::json;

constexpr std::array<std::pair<std::string_view, MessageKind>, 15> kKinds = {{{"hello", MessageKind::hello},
                                                                              {"ack", MessageKind::ack},
                                                                              {"take", MessageKind::take},
                                                                              {"give", MessageKind::give},
                                                                              {"steer", MessageKind::steer},
                                                                              {"view", MessageKind::view},
                                                                              {"camera", MessageKind::camera},
                                                                              {"focus", MessageKind::focus},
                                                                              {"pick", MessageKind::pick},
                                                                              {"set", MessageKind::set},
                                                                              {"size", MessageKind::size},
                                                                              {"display", MessageKind::display},
                                                                              {"environment", MessageKind::environment},
                                                                              {"target", MessageKind::target},
                                                                              {"copy", MessageKind::copy}}};
constexpr std::size_t kMostGains = 64;

struct Malformed : std::runtime_error {
  Malformed() : std::runtime_error("message") {}
};

const Json& member(const Json& body, const char* name) {
  const auto found = body.find(name);
  if (found == body.end()) throw Malformed();
  return *found;
}

double number_in(const Json& value, double low, double high) {
  if (!value.is_number()) throw Malformed();
  const auto number = value.get<double>();
  if (!(number >= low && number <= high)) throw Malformed(); // what is not finite, too
  return number;
}

std::uint32_t whole_in(const Json& value, double high) {
  const double number = number_in(value, 0.0, high);
  if (number != std::floor(number)) throw Malformed();
  return static_cast<std::uint32_t>(number);
}

std::string text_of(const Json& value) {
  if (!value.is_string()) throw Malformed();
  return value.get<std::string>();
}

template <int N>
glm::vec<N, double> vector_in(const Json& value, double most) {
  if (!value.is_array() || value.size() != N) throw Malformed();
  glm::vec<N, double> vector;
  for (int i = 0; i < N; ++i) vector[i] = number_in(value[static_cast<std::size_t>(i)], -most, most);
  return vector;
}

bool flag(const Json& body, const char* name) {
  const auto found = body.find(name);
  if (found == body.end()) return false;
  if (!found->is_boolean()) throw Malformed();
  return found->get<bool>();
}

void read_steering(const Json& body, Message& message) {
  constexpr double kFar = 100.0; // heights of the picture
  const auto way = [&](const char* name) {
    return body.contains(name) ? vector_in<2>(body[name], kFar) : glm::dvec2(0.0);
  };
  message.drags = {.left = way("left"), .middle = way("middle"), .right = way("right"), .shift = flag(body, "shift")};
  if (body.contains("scroll")) message.drags.scroll = number_in(body["scroll"], -kFar, kFar);
  if (body.contains("fly")) message.flight.direction = vector_in<3>(body["fly"], 1.0);
  message.flight.fast = flag(body, "fast");
  if (body.contains("seconds")) message.seconds = number_in(body["seconds"], 0.0, 10.0);
  message.dragging = flag(body, "dragging");
}

void read_view(const Json& body, Message& message) {
  constexpr double kFarthest = 1e12; // metres
  if (body.contains("eye")) message.view.eye = vector_in<3>(body["eye"], kFarthest);
  if (body.contains("look_at")) message.view.look_at = vector_in<3>(body["look_at"], kFarthest);
  if (body.contains("up")) message.view.up = vector_in<3>(body["up"], 1e6);
  if (body.contains("yfov")) message.view.yfov = glm::radians(number_in(body["yfov"], 1e-3, 179.0));
}

void read_display(const Json& body, Message& message) {
  if (body.contains("shown")) message.shown = text_of(body["shown"]);
  if (body.contains("tonemap")) message.tonemap = text_of(body["tonemap"]);
  if (body.contains("exposure")) {
    if (body["exposure"] == "auto")
      message.auto_exposure = true;
    else
      message.exposure = number_in(body["exposure"], -100.0, 100.0);
  }
  if (!body.contains("gains")) return;
  const Json& gains = body["gains"];
  if (!gains.is_array() || gains.size() > kMostGains) throw Malformed();
  for (const Json& gain : gains) message.gains.push_back(static_cast<float>(number_in(gain, 0.0, 1e4)));
}

Message read_message(const Json& body) {
  const std::string kind = text_of(member(body, "type"));
  Message message;
  bool known = false;
  for (const auto& [name, value] : kKinds)
    if (kind == name) message.kind = value, known = true;
  if (!known) throw Malformed();
  if (body.contains("count")) message.count = whole_in(body["count"], 4294967295.0);
  switch (message.kind) {
    case MessageKind::hello:
      message.value = text_of(member(body, "token"));
      break;
    case MessageKind::ack:
      message.frame = whole_in(member(body, "frame"), 4294967295.0);
      break;
    case MessageKind::steer:
      read_steering(body, message);
      break;
    case MessageKind::view:
      read_view(body, message);
      break;
    case MessageKind::camera:
      message.name = text_of(member(body, "to"));
      break;
    case MessageKind::focus:
    case MessageKind::pick:
      message.at = {number_in(member(body, "x"), 0.0, 1.0), number_in(member(body, "y"), 0.0, 1.0)};
      break;
    case MessageKind::set:
      message.name = text_of(member(body, "name"));
      message.value = text_of(member(body, "value"));
      break;
    case MessageKind::size:
      message.width = whole_in(member(body, "width"), 65535.0);
      message.height = whole_in(member(body, "height"), 65535.0);
      break;
    case MessageKind::display:
      read_display(body, message);
      break;
    case MessageKind::environment:
      message.environment = {text_of(member(body, "source")), number_in(member(body, "intensity"), 0.0, 1e6),
                             number_in(member(body, "degrees"), -36000.0, 36000.0)};
      break;
    case MessageKind::target:
      message.error = number_in(member(body, "error"), 0.0, 1.0);
      break;
    case MessageKind::take:
    case MessageKind::give:
    case MessageKind::copy:
      break;
  }
  return message;
}

} // namespace

std::optional<Message> parse_message(std::string_view text) {
  if (text.size() > kLongestMessage) return std::nullopt;
  const Json body = Json::parse(text, nullptr, false);
  if (!body.is_object()) return std::nullopt; // text that is no JSON, too
  try {
    return read_message(body);
  } catch (const Malformed&) {
    return std::nullopt;
  }
}

} // namespace wavepath
