#include "host/picture/tev.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <cstring>
#include <memory>
#include <mutex>
#include <new>
#include <optional>
#include <span>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <fmt/format.h>

#include "host/base/clock.h"
#include "host/base/error.h"

namespace wavepath {
namespace {

static_assert(std::endian::native == std::endian::little, "packets are written as the host has numbers");

constexpr const char* kDefaultPort = "14158";
constexpr std::chrono::seconds kLongestConnect{1}, kLongestSend{10};
constexpr std::chrono::seconds kEndWait{1}; // at the end, for each kEndBytes
constexpr std::uint64_t kEndBytes = 1u << 20;
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

int milliseconds_until(Clock::time_point end) {
  const auto left = std::chrono::ceil<std::chrono::milliseconds>(end - Clock::now());
  return static_cast<int>(std::max<std::chrono::milliseconds::rep>(left.count(), 0));
}

// A socket that is connected by then, or -1 with the reason in errno.
int connect_to(const addrinfo& target, Clock::time_point end) {
  const int socket = ::socket(target.ai_family, target.ai_socktype | SOCK_NONBLOCK | SOCK_CLOEXEC, target.ai_protocol);
  if (socket < 0) return -1;
  int problem = connect(socket, target.ai_addr, target.ai_addrlen) == 0 ? 0 : errno;
  if (problem == EINPROGRESS) {
    pollfd waiting{socket, POLLOUT, 0};
    socklen_t size = sizeof problem;
    if (poll(&waiting, 1, milliseconds_until(end)) != 1)
      problem = ETIMEDOUT;
    else
      getsockopt(socket, SOL_SOCKET, SO_ERROR, &problem, &size);
  }
  if (problem == 0) return socket;
  close(socket);
  errno = problem;
  return -1;
}

} // namespace

struct TevViewer::Link {
  struct Shown {
    std::string name;
    Picture picture;
  };

  // Used by the thread alone.
  void serve(const std::string& host, const std::string& port);
  void connect_within(const std::string& host, const std::string& port, Clock::time_point end);
  bool send(std::string& packet);
  bool send(const Shown& shown);
  int socket = -1;
  std::string named;               // image that tev has
  std::uint64_t channel_count = 0; // and how many channels it has: the last picture may have passes besides

  std::mutex mutex;
  std::condition_variable changed;
  // Guarded.
  bool connecting = true, gone = false, closing = false, sending = false;
  std::string no_host, problem; // why there is no connection
  std::optional<Shown> waiting;
  std::atomic<bool> abandoned = false;  // nobody waits for what is still to be sent
  std::atomic<std::uint64_t> bytes = 0; // sent so far
};

void TevViewer::Link::connect_within(const std::string& host, const std::string& port, Clock::time_point end) {
  addrinfo wanted{};
  wanted.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  const int result = getaddrinfo(host.c_str(), port.c_str(), &wanted, &found);
  const std::unique_ptr<addrinfo, void (*)(addrinfo*)> targets(found, [](addrinfo* list) {
    if (list) freeaddrinfo(list);
  });
  // Half of the time for each but the last: the first address of a host may be one that its network drops.
  for (const addrinfo* target = found; target && socket < 0; target = target->ai_next)
    socket = connect_to(*target, target->ai_next ? Clock::now() + (end - Clock::now()) / 2 : end);
  const std::string why = std::strerror(errno);
  const std::lock_guard lock(mutex);
  if (result != 0) no_host = gai_strerror(result);
  if (socket < 0) problem = why;
  connecting = false;
  gone |= socket < 0;
}

void TevViewer::Link::serve(const std::string& host, const std::string& port) {
  connect_within(host, port, Clock::now() + kLongestConnect);
  changed.notify_all();
  std::unique_lock lock(mutex);
  while (!gone) {
    changed.wait(lock, [&] { return waiting || closing; });
    if (!waiting || abandoned) break;
    const Shown shown = *std::exchange(waiting, std::nullopt);
    sending = true;
    lock.unlock();
    const bool sent = send(shown);
    lock.lock();
    sending = false;
    gone |= !sent;
    changed.notify_all();
  }
  if (socket >= 0) close(std::exchange(socket, -1));
}

bool TevViewer::Link::send(std::string& packet) {
  const auto length = static_cast<std::uint32_t>(packet.size());
  std::memcpy(packet.data(), &length, sizeof length);
  Clock::time_point taken = Clock::now();
  for (std::size_t sent = 0; sent < packet.size();) {
    const ssize_t count = ::send(socket, packet.data() + sent, packet.size() - sent, MSG_NOSIGNAL);
    if (count > 0) {
      sent += static_cast<std::size_t>(count);
      bytes += static_cast<std::uint64_t>(count);
      taken = Clock::now();
      continue;
    }
    if (count < 0 && errno == EINTR) continue;
    const bool full = count < 0 && (errno == EAGAIN || errno == EWOULDBLOCK);
    if (!full || abandoned || Clock::now() - taken > kLongestSend) return false;
    pollfd waiting_for{socket, POLLOUT, 0};
    poll(&waiting_for, 1, 100);
  }
  return true;
}

bool TevViewer::Link::send(const Shown& shown) {
  const auto& [name, picture] = shown;
  const std::uint64_t count = picture.channels.size();
  if (name != named || count != channel_count) {
    std::string packet = begin_packet(create_image, true, name);
    for (const std::uint64_t number : {std::uint64_t{picture.width}, std::uint64_t{picture.height}, count})
      add(packet, static_cast<std::uint32_t>(number));
    add_names(packet, picture.channels);
    if (!send(packet)) return false;
    named = name, channel_count = count;
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

TevViewer::TevViewer(const std::string& address) : link_(std::make_shared<Link>()) {
  const auto [host, port] = host_and_port(address);
  std::thread([link = link_, host = host, port = port] {
    try {
      link->serve(host, port);
    } catch (const std::exception&) { // as of a picture that there is no room for
      const std::lock_guard lock(link->mutex);
      link->gone = true, link->connecting = link->sending = false;
      link->changed.notify_all();
    }
  }).detach();
  std::unique_lock lock(link_->mutex);
  const bool answered = link_->changed.wait_for(lock, kLongestConnect, [&] { return !link_->connecting; });
  if (!link_->no_host.empty())
    throw Error("--tev", fmt::format("the host {} is not known: {}", host, link_->no_host),
                "check its name, or leave out --tev");
  if (answered && !link_->gone) return;
  link_->closing = link_->abandoned = true;
  link_->changed.notify_all();
  throw Error("--tev",
              fmt::format("no tev answers at {}:{}: {}", host, port,
                          answered ? link_->problem : std::string(std::strerror(ETIMEDOUT))),
              "start tev there, or leave out --tev");
}

TevViewer::~TevViewer() {
  const std::lock_guard lock(link_->mutex);
  link_->closing = link_->abandoned = true;
  link_->changed.notify_all();
}

bool TevViewer::show(const std::string& name, const Picture& picture) {
  Link::Shown shown{name, picture};
  const std::lock_guard lock(link_->mutex);
  if (link_->gone) return false;
  link_->waiting = std::move(shown);
  link_->changed.notify_all();
  return true;
}

bool TevViewer::finish() {
  std::unique_lock lock(link_->mutex);
  const auto is_over = [&] { return link_->gone || (!link_->waiting && !link_->sending); };
  std::uint64_t before = link_->bytes;
  while (!link_->changed.wait_for(lock, kEndWait, is_over)) {
    const std::uint64_t now = link_->bytes;
    if (now - before < kEndBytes) link_->gone = true;
    before = now;
  }
  return !link_->gone;
}

} // namespace wavepath
