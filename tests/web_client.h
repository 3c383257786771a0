// A small client of HTTP and WebSocket on sockets, which can also do what no browser does.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <fmt/format.h>

namespace wavepath::test {

struct WebMessage {
  int opcode = 0; // 1 text, 2 binary, 8 close
  std::string bytes;
  // Of a close.
  int code() const {
    return bytes.size() < 2 ? 0 : static_cast<unsigned char>(bytes[0]) << 8 | static_cast<unsigned char>(bytes[1]);
  }
};

class WebClient {
public:
  explicit WebClient(std::uint16_t port) : port_(port) {
    socket_ = ::socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    connected_ = ::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  }
  ~WebClient() { leave(); }
  WebClient(WebClient&&) = delete;

  bool connected() const { return connected_; }
  // Without a word.
  void leave() {
    if (socket_ >= 0) ::close(socket_);
    socket_ = -1;
  }

  void send_bytes(std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t count = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (count <= 0) return;
      bytes.remove_prefix(static_cast<std::size_t>(count));
    }
  }

  // All that comes until the other end closes; empty `ended` after so many seconds.
  std::string read_to_end(double seconds, bool* ended = nullptr) {
    while (fill(seconds)) {
    }
    if (ended) *ended = at_end_;
    return std::exchange(buffer_, {});
  }

  // The whole response to a request of these lines, without the empty one.
  std::string request(const std::string& lines, double seconds = 20.0) {
    send_bytes(lines + "\r\n\r\n");
    return read_to_end(seconds);
  }
  std::string get(const std::string& target, const std::string& more = "") {
    return request(fmt::format("GET {} HTTP/1.1\r\nHost: 127.0.0.1:{}{}", target, port_, more));
  }

  // The handshake of a WebSocket; returns the status of the answer.
  int open(const std::string& host = "localhost", const std::string& more = "") {
    send_bytes(
        fmt::format("GET /session HTTP/1.1\r\nHost: {}:{}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                    "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13{}\r\n\r\n",
                    host, port_, more));
    std::size_t end = 0;
    while ((end = buffer_.find("\r\n\r\n")) == std::string::npos)
      if (!fill(20.0)) return 0;
    const int status = std::atoi(buffer_.c_str() + std::strlen("HTTP/1.1 "));
    buffer_.erase(0, end + 4);
    return status;
  }
  bool join(const std::string& token) {
    if (open() != 101) return false;
    say(fmt::format(R"({{"type":"hello","token":"{}"}})", token));
    return true;
  }

  void say(std::string_view text, int opcode = 1) {
    std::string bytes(1, static_cast<char>(0x80 | opcode));
    if (text.size() < 126) {
      bytes += static_cast<char>(0x80 | text.size());
    } else {
      const bool is_short = text.size() < 65536;
      bytes += static_cast<char>(0x80 | (is_short ? 126 : 127));
      for (int shift = is_short ? 8 : 56; shift >= 0; shift -= 8)
        bytes += static_cast<char>(text.size() >> shift & 0xff);
    }
    bytes += std::string(4, '\0'); // a mask that changes nothing
    bytes += text;
    send_bytes(bytes);
  }

  // The next message that is no ping; nothing where the other end has gone, or after so many seconds.
  std::optional<WebMessage> next(double seconds = 20.0) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
    const auto left = [&] {
      return std::max(0.0, std::chrono::duration<double>(end - std::chrono::steady_clock::now()).count());
    };
    WebMessage message;
    for (bool whole = false; !whole;) {
      if (!need(2, left())) return std::nullopt;
      const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(buffer_[i]); };
      const int opcode = byte(0) & 15;
      const bool last = (byte(0) & 0x80) != 0;
      std::size_t length = byte(1) & 127, header = 2;
      if (length >= 126) {
        header = length == 126 ? 4 : 10;
        if (!need(header, left())) return std::nullopt;
        length = 0;
        for (std::size_t i = 2; i < header; ++i) length = length << 8 | byte(i);
      }
      if (!need(header + length, left())) return std::nullopt;
      const std::string payload = buffer_.substr(header, length);
      buffer_.erase(0, header + length);
      if (opcode == 9) {
        say(payload, 10);
        continue;
      }
      if (opcode != 0) message.opcode = opcode;
      message.bytes += payload;
      whole = last;
    }
    return message;
  }
  // The code with which the other end closes, 0 if it only goes; -1 if it does not within so many seconds.
  int close_code(double seconds = 20.0) {
    while (const std::optional<WebMessage> message = next(seconds))
      if (message->opcode == 8) return message->code();
    return at_end_ ? 0 : -1;
  }

private:
  bool need(std::size_t bytes, double seconds) {
    while (buffer_.size() < bytes)
      if (!fill(seconds)) return false;
    return true;
  }
  // Reads what comes within so many seconds. False at the end, or if nothing does.
  bool fill(double seconds) {
    pollfd wait{socket_, POLLIN, 0};
    if (::poll(&wait, 1, static_cast<int>(seconds * 1e3)) <= 0) return false;
    char bytes[65536];
    const ssize_t count = ::recv(socket_, bytes, sizeof bytes, 0);
    at_end_ = count <= 0;
    if (count > 0) buffer_.append(bytes, static_cast<std::size_t>(count));
    return count > 0;
  }

  std::uint16_t port_;
  int socket_ = -1;
  bool connected_ = false, at_end_ = false;
  std::string buffer_;
};

} // namespace wavepath::test
