#include "host/gpu/kernel_statistics.h"

namespace wavepath {
namespace {

double value_of(const VkPipelineExecutableStatisticKHR& statistic) {
  switch (statistic.format) {
    case VK_PIPELINE_EXECUTABLE_STATISTIC_FORMAT_BOOL32_KHR:
      return statistic.value.b32 ? 1.0 : 0.0;
    case VK_PIPELINE_EXECUTABLE_STATISTIC_FORMAT_INT64_KHR:
      return static_cast<double>(statistic.value.i64);
    case VK_PIPELINE_EXECUTABLE_STATISTIC_FORMAT_UINT64_KHR:
      return static_cast<double>(statistic.value.u64);
    default:
      return statistic.value.f64;
  }
}

template <typename Function>
Function entry(Device& device, const char* name) {
  return reinterpret_cast<Function>(vkGetDeviceProcAddr(device.handle(), name));
}

} // namespace

std::vector<KernelStatistic> kernel_statistics(Device& device, const Kernel& kernel) {
  const auto list = entry<PFN_vkGetPipelineExecutablePropertiesKHR>(device, "vkGetPipelineExecutablePropertiesKHR");
  const auto tell = entry<PFN_vkGetPipelineExecutableStatisticsKHR>(device, "vkGetPipelineExecutableStatisticsKHR");
  const VkPipelineInfoKHR pipeline{VK_STRUCTURE_TYPE_PIPELINE_INFO_KHR, nullptr, kernel.handle()};
  std::uint32_t count = 0;
  check(list(device.handle(), &pipeline, &count, nullptr), "listing what a kernel was compiled to");
  std::vector<VkPipelineExecutablePropertiesKHR> executables(
      count, {VK_STRUCTURE_TYPE_PIPELINE_EXECUTABLE_PROPERTIES_KHR, nullptr, 0, "", "", 0});
  check(list(device.handle(), &pipeline, &count, executables.data()), "listing what a kernel was compiled to");
  std::vector<KernelStatistic> told;
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::string prefix = count > 1 ? std::string(executables[i].name) + ": " : "";
    told.push_back({prefix + "Subgroup size", static_cast<double>(executables[i].subgroupSize)});
    const VkPipelineExecutableInfoKHR one{VK_STRUCTURE_TYPE_PIPELINE_EXECUTABLE_INFO_KHR, nullptr, kernel.handle(), i};
    std::uint32_t statistics_count = 0;
    check(tell(device.handle(), &one, &statistics_count, nullptr), "reading a kernel's statistics");
    std::vector<VkPipelineExecutableStatisticKHR> statistics(statistics_count);
    for (auto& statistic : statistics) statistic.sType = VK_STRUCTURE_TYPE_PIPELINE_EXECUTABLE_STATISTIC_KHR;
    check(tell(device.handle(), &one, &statistics_count, statistics.data()), "reading a kernel's statistics");
    for (const auto& statistic : statistics) told.push_back({prefix + statistic.name, value_of(statistic)});
  }
  return told;
}

} // namespace wavepath
