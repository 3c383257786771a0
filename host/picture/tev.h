// Shows pictures in tev, a viewer that listens on a TCP port (github.com/Tom94/tev, src/Ipc.cpp).
#pragma once

#include <memory>
#include <string>

#include "host/picture/picture.h"

namespace wavepath {

// Connection to a running tev. A thread of its own serves it, so that a render never waits for it. Supports
// little-endian hosts only.
class TevViewer {
public:
  // `address`: HOST or HOST:PORT; the port is 14158 by default, and an IPv6 address with a port is in brackets. Throws
  // UsageError for an invalid address, and Error if no tev answers within a second.
  explicit TevViewer(const std::string& address);
  ~TevViewer(); // waits for nothing
  TevViewer(const TevViewer&) = delete;

  // Queues all channels of `picture`, to be shown as the image `name`; tev selects a new image. A queued picture that
  // is not being sent yet is replaced. Returns false, and does nothing from then on, after tev has closed or has
  // accepted no data for ten seconds.
  bool show(const std::string& name, const Picture& picture);

  // Waits until everything is sent. Returns false if tev has closed or accepts less than 1 MiB/s.
  bool finish();

private:
  struct Link;
  std::shared_ptr<Link> link_; // shared with the thread, which may outlive this: a name look-up cannot be cancelled
};

} // namespace wavepath
