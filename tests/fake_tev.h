// Listens as tev does and keeps what it is shown. Reads packets strictly: one that tev would refuse is a failure. And
// one that hangs.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <cstring>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <gtest/gtest.h>

#include "host/picture/picture.h"

namespace wavepath::test {

class FakeTev {
public:
  // `hangs_up_after`: closes the connection after so many pictures; 0 = never. A picture ends with its last row.
  explicit FakeTev(int hangs_up_after = 0) : hangs_up_after_(hangs_up_after) {
    listener_ = socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    EXPECT_EQ(bind(listener_, reinterpret_cast<sockaddr*>(&address), size), 0);
    EXPECT_EQ(listen(listener_, 1), 0);
    EXPECT_EQ(getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size), 0);
    port_ = ntohs(address.sin_port);
    thread_ = std::thread([this] { serve(); });
  }
  ~FakeTev() {
    shutdown(listener_, SHUT_RDWR); // where nobody came
    wait();
    close(listener_);
  }
  FakeTev(const FakeTev&) = delete;

  std::string address() const { return "127.0.0.1:" + std::to_string(port_); }
  // Until somebody has come, and has closed the connection, or this has.
  void wait() {
    if (thread_.joinable()) thread_.join();
  }

  // Valid after wait().
  std::map<std::string, Picture> images;
  int pictures = 0, packets = 0;

private:
  struct Reader {
    const std::string& bytes;
    std::size_t at = 0;
    template <class T>
    T number() {
      T value{};
      EXPECT_LE(at + sizeof value, bytes.size());
      if (at + sizeof value <= bytes.size()) std::memcpy(&value, &bytes[at], sizeof value);
      at += sizeof value;
      return value;
    }
    std::string text() {
      const std::string value = bytes.c_str() + std::min(at, bytes.size());
      at += value.size() + 1;
      return value;
    }
  };

  bool receive(std::string& bytes, std::size_t count) {
    bytes.resize(count);
    for (std::size_t done = 0; done < count;) {
      const ssize_t got = recv(connection_, &bytes[done], count - done, 0);
      if (got <= 0) return false;
      done += static_cast<std::size_t>(got);
    }
    return true;
  }

  void serve() {
    pollfd coming{listener_, POLLIN, 0};
    poll(&coming, 1, 60000); // a test that nobody comes to fails
    connection_ = accept4(listener_, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
    shutdown(listener_, SHUT_RDWR); // whoever comes next is refused
    if (connection_ >= 0) fcntl(connection_, F_SETFL, 0);
    std::string length, packet;
    while (connection_ >= 0 && receive(length, 4)) {
      std::uint32_t size = 0;
      std::memcpy(&size, length.data(), sizeof size);
      if (size <= 4 || !receive(packet, size - 4)) break;
      ++packets;
      take(packet);
      if (hangs_up_after_ > 0 && pictures >= hangs_up_after_) break;
    }
    if (connection_ >= 0) close(connection_);
  }

  void take(const std::string& packet) {
    Reader in{packet};
    const char operation = in.number<char>();
    const bool grab_focus = in.number<char>() != 0;
    const std::string name = in.text();
    ASSERT_TRUE(operation == 4 || operation == 5) << int{operation};
    EXPECT_EQ(grab_focus, operation == 4)
        << "an image comes into view when it is new, and then where the user wants it";
    if (operation == 4) {
      Picture& picture = images[name] = {};
      picture.width = in.number<std::uint32_t>(), picture.height = in.number<std::uint32_t>();
      for (auto count = in.number<std::uint32_t>(); count > 0; --count)
        picture.channels.push_back({in.text(), std::vector<float>(picture.width * picture.height, -1.0f)});
    } else {
      ASSERT_TRUE(images.contains(name)) << name;
      Picture& picture = images[name];
      ASSERT_EQ(in.number<std::uint32_t>(), picture.channels.size());
      for (const Channel& channel : picture.channels) ASSERT_EQ(in.text(), channel.name);
      const auto x = in.number<std::uint32_t>(), y = in.number<std::uint32_t>(), width = in.number<std::uint32_t>(),
                 height = in.number<std::uint32_t>();
      ASSERT_TRUE(x == 0 && width == picture.width && y + height <= picture.height);
      for (Channel& channel : picture.channels)
        for (std::uint32_t i = 0; i < width * height; ++i) channel.values[y * width + i] = in.number<float>();
      pictures += y + height == picture.height;
    }
    EXPECT_EQ(in.at, packet.size());
  }

  const int hangs_up_after_;
  int listener_ = -1, connection_ = -1;
  std::uint16_t port_ = 0;
  std::thread thread_;
};

// A viewer that hangs: the system takes connections for it, and as much as its buffers hold. With a queue that is full,
// not even that.
class SilentTev {
public:
  explicit SilentTev(bool is_full = false) {
    listener_ = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    const int small = 4096;
    setsockopt(listener_, SOL_SOCKET, SO_RCVBUF, &small, sizeof small);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    EXPECT_EQ(bind(listener_, reinterpret_cast<sockaddr*>(&address), size), 0);
    EXPECT_EQ(listen(listener_, is_full ? 0 : 8), 0);
    EXPECT_EQ(getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size), 0);
    port_ = ntohs(address.sin_port);
    for (int i = 0; is_full && i < 4; ++i) {
      guests_.push_back(socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
      connect(guests_.back(), reinterpret_cast<sockaddr*>(&address), size);
    }
  }
  ~SilentTev() {
    for (const int guest : guests_) close(guest);
    close(listener_);
  }
  SilentTev(const SilentTev&) = delete;

  std::string address() const { return "127.0.0.1:" + std::to_string(port_); }

private:
  int listener_ = -1;
  std::vector<int> guests_;
  std::uint16_t port_ = 0;
};

} // namespace wavepath::test
