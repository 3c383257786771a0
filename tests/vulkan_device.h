// The Vulkan device of a test program, and what its tests do where there is none: they are skipped, which
// tests/main.cpp reports, or they fail if WAVEPATH_REQUIRE_VULKAN=1 says that there must be one.
#pragma once

#include <cstdlib>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include "host/base/error.h"
#include "host/gpu/device.h"

namespace wavepath::test {

inline bool vulkan_is_required() {
  const char* required = std::getenv("WAVEPATH_REQUIRE_VULKAN");
  return required && *required != '\0' && std::string_view(required) != "0";
}

// Ends the current test if `problem` says why there is no device. Called from SetUp(), it keeps the body from running.
inline void end_test_without_device(const std::string& problem) {
  if (problem.empty()) return;
  if (vulkan_is_required()) FAIL() << "WAVEPATH_REQUIRE_VULKAN is set, but there is no Vulkan device: " << problem;
  GTEST_SKIP() << "no Vulkan device: " << problem;
}

// The one device of this process, WAVEPATH_DEVICE if that is set. Null without one; `problem` then says why.
struct TestDevice {
  Device* device = nullptr;
  std::string problem;
};
inline const TestDevice& test_device() {
  static const TestDevice result = [] {
    const char* wanted = std::getenv("WAVEPATH_DEVICE");
    try {
      auto* device = new Device(wanted ? wanted : "");
      device->keep_pipelines(); // tests compile the same kernels for many scenes
      return TestDevice{device, ""};
    } catch (const Error& error) {
      return TestDevice{nullptr, error.what()};
    }
  }();
  return result;
}

// Base of every test that uses the device itself; fails on validation messages.
class VulkanTest : public ::testing::Test {
protected:
  void SetUp() override {
    messages_before_ = Device::validation_messages();
    end_test_without_device(test_device().problem);
  }
  void TearDown() override { EXPECT_EQ(Device::validation_messages(), messages_before_) << "validation spoke up"; }
  Device& device() { return *test_device().device; }

private:
  std::uint32_t messages_before_ = 0;
};

// Base of every test that runs the program on a device of its own choice.
class ProgramTest : public ::testing::Test {
protected:
  void SetUp() override { end_test_without_device(list_devices().empty() ? "no driver offers one" : ""); }
};

} // namespace wavepath::test
