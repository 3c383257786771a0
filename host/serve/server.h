// HTTP and WebSocket on one port, on one thread of its own: hands out the page, lets viewers in, and takes their
// messages to whoever owns the picture. Nothing that a viewer does or leaves undone holds that one up.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "host/serve/message.h"

namespace wavepath {

struct ServerLimits {
  double handshake = 5.0;        // seconds in which a request, and then the token, has to come
  double wrong_token = 1.0;      // seconds until the answer to a wrong token
  double silence = 60.0;         // seconds after which a viewer that acknowledges nothing is let go
  std::size_t connections = 32;  // at once
  double new_connections = 8.0;  // a second, and twice as many at once
  double messages = 60.0;        // a second of a viewer, and twice as many at once; acknowledgements do not count
  std::size_t unread_texts = 64; // answers that a viewer may leave unread
  std::size_t frames_on_way = 2; // pictures without acknowledgement
};

struct ServerRequest {
  std::string address = "127.0.0.1"; // ::1 comes along with it
  std::uint16_t port = 0;            // 0 = one that is free
  std::vector<std::string> hosts;    // names that are answered besides those of this machine, as host_name() has them
  std::string token;
  std::string page;           // HTML
  std::string content_policy; // its header Content-Security-Policy
  ServerLimits limits{};
};

// News from a viewer. `message`: one that is neither hello nor ack. `wants_file`: `format` is "exr" or "png", to be
// answered by answer_file().
struct ViewerNews {
  enum class Kind { joined, left, message, wants_file };
  Kind kind = Kind::message;
  std::uint32_t viewer = 0; // number of it; of the request for wants_file
  Message message{};
  std::string format{};
};

class Server {
public:
  // Throws Error where the port cannot be had.
  explicit Server(const ServerRequest& request);
  ~Server();
  Server(Server&&) = delete;

  std::uint16_t port() const;
  // What has come; waits at most so many seconds for the first.
  std::vector<ViewerNews> take(double seconds);
  std::size_t viewers() const;
  // A viewer is there that has acknowledged what it was sent.
  bool wants_frame() const;

  // From any thread. Texts are JSON. `status`: only the newest one is kept for a viewer that is slow.
  void send(std::uint32_t viewer, std::string text);
  void send_to_all(std::string text);
  void send_status(std::string text);
  // A picture for all viewers, unless they have been given one of a higher number. One that is slow gets it, or a newer
  // one, later.
  void show(std::uint32_t number, std::string bytes);
  void answer_file(std::uint32_t request, const std::string& name, std::string bytes);
  void refuse_file(std::uint32_t request, const std::string& why);

private:
  struct Inside;
  std::unique_ptr<Inside> inside_;
};

} // namespace wavepath
