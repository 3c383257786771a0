// A device as the rest of the program knows it: a Context, with copies to and from memory that the host cannot map.
#pragma once

#include "host/gpu/context.h"
#include "host/gpu/staging.h"

namespace wavepath {

class Device : public Context {
public:
  using Context::Context;

  Staging& staging() { return staging_; }

private:
  Staging staging_{*this};
};

} // namespace wavepath
