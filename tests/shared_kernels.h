// Kernels that all tests of a program share, so that each is compiled once. They go after the last test: at the end of
// the program the statics of a layer or a driver may be gone before a kernel that is still being compiled.
#pragma once

#include <memory>

#include <gtest/gtest.h>

#include "host/render/workspace/kernel_compiler.h"

namespace wavepath::test {

class SharedKernels : public testing::Environment {
public:
  KernelCompiler& of(Device& device) {
    if (!kernels_) kernels_ = std::make_unique<KernelCompiler>(device);
    return *kernels_;
  }
  void TearDown() override { kernels_.reset(); }

private:
  std::unique_ptr<KernelCompiler> kernels_;
};

inline SharedKernels& kSharedKernels =
    *static_cast<SharedKernels*>(testing::AddGlobalTestEnvironment(new SharedKernels)); // googletest owns it

inline KernelCompiler& shared_kernels(Device& device) { return kSharedKernels.of(device); }

} // namespace wavepath::test
