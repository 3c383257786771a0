// A device as the rest of the program knows it: a Context, with copies to and from memory that the host cannot map.
#pragma once

#include <memory>

#include "host/gpu/context.h"
#include "host/gpu/kept_pipelines.h"
#include "host/gpu/staging.h"

namespace wavepath {

class Device : public Context {
public:
  using Context::Context;

  ~Device() {
    if (kept_pipelines_) kept_pipelines_->destroy(handle());
  }

  Staging& staging() { return staging_; }

  // From now on keeps pipelines of kernels and shares them. Not to be used where compile times are reported.
  void keep_pipelines() { kept_pipelines_ = std::make_unique<KeptPipelines>(); }
  KeptPipelines* kept_pipelines() const { return kept_pipelines_.get(); } // null: they go with their kernels

private:
  std::unique_ptr<KeptPipelines> kept_pipelines_;
  Staging staging_{*this};
};

} // namespace wavepath
