#include "host/film/tev.h"

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstring>
#include <memory>
#include <span>
#include <utility>

#include <fcntl.h>
#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <fmt/format.h>

#include "host/base/error.h"

namespace wavepath {
namespace {

static_assert(std::endian::native == std::endian::little, "packets are written as the host has numbers");

constexpr const char* kDefaultPort = "14158";
constexpr int kLongestConnect = 5000;           // ms
constexpr int kLongestSend = 10;                // s
constexpr std::uint64_t kMostValues = 1u << 20; // of a packet: tev keeps a buffer of the largest that it was sent

enum Operation : char { create_image = 4, update_image = 5 };

// Begins a packet; its length comes first, itself included, and is known at the end.
std::string begin_packet(Operation operation, bool grab_focus, const std::string& name) {
  std::string packet(sizeof(std::uint32_t), '\0');
  packet += operation;
  packet += static_cast<char>(grab_focus);
  packet.append(name.c_str(), name.size() + 1);
  return packet;
}

void add(std::string& packet, std::uint32_t number) {
  packet.append(reinterpret_cast<const char*>(&number), sizeof number);
}

void add_names(std::string& packet, std::span<const Channel> channels) {
  for (const Channel& channel : channels) packet.append(channel.name.c_str(), channel.name.size() + 1);
}

std::pair<std::string, std::string> host_and_port(const std::string& address) {
  std::string host = address, port = kDefaultPort;
  const std::size_t colons = static_cast<std::size_t>(std::count(address.begin(), address.end(), ':'));
  if (address.starts_with('[')) { // an IPv6 address, which has colons itself
    const std::size_t end = std::min(address.find(']'), address.size());
    host = address.substr(1, end - 1);
    const std::string rest = address.substr(std::min(end + 1, address.size()));
    if (!rest.empty()) port = rest.starts_with(':') ? rest.substr(1) : rest;
  } else if (colons == 1) {
    host = address.substr(0, address.find(':'));
    port = address.substr(address.find(':') + 1);
  }
  const bool is_number = !port.empty() && port.size() <= 5 && port.find_first_not_of("0123456789") == std::string::npos;
  if (host.empty()) throw UsageError("--tev", fmt::format("'{}' names no host", address), "write HOST or HOST:PORT");
  if (!is_number || std::stoi(port) < 1 || std::stoi(port) > 65535)
    throw UsageError("--tev", fmt::format("'{}' is no port", port), "write one of 1 to 65535, or none for 14158");
  return {host, port};
}

// A socket that is connected within kLongestConnect, or -1.
int connect_to(const addrinfo& target) {
  const int socket = ::socket(target.ai_family, target.ai_socktype | SOCK_NONBLOCK | SOCK_CLOEXEC, target.ai_protocol);
  if (socket < 0) return -1;
  int problem = connect(socket, target.ai_addr, target.ai_addrlen) == 0 ? 0 : errno;
  if (problem == EINPROGRESS) {
    pollfd waiting{socket, POLLOUT, 0};
    socklen_t size = sizeof problem;
    if (poll(&waiting, 1, kLongestConnect) != 1)
      problem = ETIMEDOUT;
    else
      getsockopt(socket, SOL_SOCKET, SO_ERROR, &problem, &size);
  }
  const timeval longest{kLongestSend, 0};
  if (problem == 0 && fcntl(socket, F_SETFL, 0) == 0 &&
      setsockopt(socket, SOL_SOCKET, SO_SNDTIMEO, &longest, sizeof longest) == 0)
    return socket;
  close(socket);
  errno = problem != 0 ? problem : errno;
  return -1;
}

} // namespace

TevViewer::TevViewer(const std::string& address) {
  const auto [host, port] = host_and_port(address);
  addrinfo wanted{};
  wanted.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  const int result = getaddrinfo(host.c_str(), port.c_str(), &wanted, &found);
  if (result != 0)
    throw Error("--tev", fmt::format("the host {} is not known: {}", host, gai_strerror(result)),
                "check its name, or leave out --tev");
  const std::unique_ptr<addrinfo, decltype(&freeaddrinfo)> targets(found, &freeaddrinfo);
  for (const addrinfo* target = found; target && socket_ < 0; target = target->ai_next) socket_ = connect_to(*target);
  if (socket_ < 0)
    throw Error("--tev", fmt::format("no tev answers at {}:{}: {}", host, port, std::strerror(errno)),
                "start tev there, or leave out --tev");
}

TevViewer::~TevViewer() {
  if (socket_ >= 0) close(socket_);
}

bool TevViewer::send(std::string& packet) {
  const auto length = static_cast<std::uint32_t>(packet.size());
  std::memcpy(packet.data(), &length, sizeof length);
  for (std::size_t sent = 0; sent < packet.size();) {
    const ssize_t count = ::send(socket_, packet.data() + sent, packet.size() - sent, MSG_NOSIGNAL);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) {
      close(std::exchange(socket_, -1));
      return false;
    }
    sent += static_cast<std::size_t>(count);
  }
  return true;
}

bool TevViewer::show(const std::string& name, const Picture& picture) {
  if (socket_ < 0) return false;
  const std::uint64_t count = picture.channels.size();
  if (name != shown_) {
    std::string packet = begin_packet(create_image, true, name);
    for (const std::uint64_t number : {std::uint64_t{picture.width}, std::uint64_t{picture.height}, count})
      add(packet, static_cast<std::uint32_t>(number));
    add_names(packet, picture.channels);
    if (!send(packet)) return false;
    shown_ = name;
  }
  const auto rows = static_cast<std::uint32_t>(std::clamp<std::uint64_t>(
      kMostValues / std::max<std::uint64_t>(picture.width * count, 1), 1, std::max(picture.height, 1u)));
  for (std::uint32_t y = 0; y < picture.height; y += rows) {
    const std::uint32_t height = std::min(rows, picture.height - y);
    std::string packet = begin_packet(update_image, false, name);
    add(packet, static_cast<std::uint32_t>(count));
    add_names(packet, picture.channels);
    for (const std::uint32_t number : {0u, y, picture.width, height}) add(packet, number);
    for (const Channel& channel : picture.channels)
      packet.append(reinterpret_cast<const char*>(&channel.values[std::size_t{y} * picture.width]),
                    std::size_t{height} * picture.width * sizeof(float));
    if (!send(packet)) return false;
  }
  return true;
}

} // namespace wavepath
