// What viewers say: the messages of the protocol wavepath.1, parsed. docs/serve.md describes them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <glm/glm.hpp>

#include "host/scene/staging/view.h"
#include "host/session/requests.h"
#include "host/session/viewing/steering.h"

namespace wavepath {

inline constexpr const char* kProtocol = "wavepath.1";
inline constexpr std::size_t kLongestMessage = 4096; // bytes

enum class MessageKind {
  hello,       // token: the first one
  ack,         // frame
  take,        // asks for control
  give,        // lets another viewer have control
  steer,       // drags, flight, seconds
  view,        // camera of its own: eye, look_at, up, yfov
  camera,      // name: "reset", "frame", or the index of one of the file
  focus,       // at: turns there
  pick,        // at
  set,         // name, value: a row of the table of settings
  size,        // width, height
  display,     // shown, exposure, tonemap, gains
  environment, // source, intensity, degrees
  target,      // error
  copy
};

struct Message {
  MessageKind kind = MessageKind::ack;
  std::uint32_t count = 0; // of the viewer; frames carry that of the last one that moved their camera
  std::string name, value; // token in `value`
  std::uint32_t frame = 0;
  Drags drags{};
  Flight flight{};
  double seconds = 0.0;  // that the flight takes
  bool dragging = false; // the pointer is held: more is to come
  ViewRequest view{};
  glm::dvec2 at{0.0}; // 0 to 1 of the picture, from its left top corner
  std::uint32_t width = 0, height = 0;
  std::optional<std::string> shown{}, tonemap{};
  std::optional<double> exposure{};
  bool auto_exposure = false;
  std::vector<float> gains{};
  EnvironmentRequest environment{};
  double error = 0.0;
};

// Nothing for text that is no message: no JSON, of no known kind, with a member that is missing, of another type or out
// of its range. Members that are not known are passed over.
std::optional<Message> parse_message(std::string_view text);

} // namespace wavepath
