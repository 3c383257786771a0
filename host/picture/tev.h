// Shows pictures in tev, a viewer that listens on a TCP port (github.com/Tom94/tev, src/Ipc.cpp).
#pragma once

#include <memory>
#include <string>

#include "host/picture/picture.h"

namespace wavepath {

// A connection to a tev that runs, served by a thread of its own, so that a render never waits for it. Little-endian
// hosts alone.
class TevViewer {
public:
  // `address`: HOST or HOST:PORT, where an IPv6 address with a port is in brackets; the port is 14158 if none is named.
  // Throws UsageError for an address that is none, Error where no tev answers within a second.
  explicit TevViewer(const std::string& address);
  ~TevViewer(); // waits for nothing
  TevViewer(const TevViewer&) = delete;

  // Hands over all channels of `picture`, to be shown as the image `name`, which comes into view when it is new. One
  // that has not begun to be sent yet is replaced. Returns false, and does nothing from then on, once tev is gone or
  // has taken nothing for ten seconds.
  bool show(const std::string& name, const Picture& picture);

  // Waits until tev has what it was handed. Returns false where it is gone, or takes less than a MiB in a second.
  bool finish();

private:
  struct Link;
  std::shared_ptr<Link> link_; // with the thread, which may outlive this: a name server cannot be hurried
};

} // namespace wavepath
