// Shows pictures in tev, a viewer that listens on a TCP port (github.com/Tom94/tev, src/Ipc.cpp).
#pragma once

#include <cstdint>
#include <string>

#include "host/film/picture.h"

namespace wavepath {

// A connection to a tev that runs. Little-endian hosts alone.
class TevViewer {
public:
  // `address`: HOST or HOST:PORT, where an IPv6 address with a port is in brackets; the port is 14158 if none is named.
  // Throws UsageError for an address that is none, Error where no tev answers within five seconds.
  explicit TevViewer(const std::string& address);
  ~TevViewer();
  TevViewer(const TevViewer&) = delete;

  // Shows all channels of `picture` as the image `name`, which comes into view when it is new. Waits until it is sent.
  // Returns false, and does nothing from then on, once tev is gone or has taken nothing for ten seconds.
  bool show(const std::string& name, const Picture& picture);

private:
  bool send(std::string& packet);

  int socket_ = -1;
  std::string shown_; // name of the image that tev has
};

} // namespace wavepath
