// Device selection and creation: core Vulkan 1.3 without optional extensions; the error for a device names what it
// lacks.
#include "host/gpu/context.h"

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <optional>

#include <fmt/format.h>
#include <sys/resource.h>
#ifdef WAVEPATH_SANITIZE
#include <sanitizer/lsan_interface.h>
#endif

#include "host/base/error.h"
#include "host/gpu/device_choice.h"
#include "host/gpu/pipeline_cache.h"
#include "kernels/base/gpu.h"

namespace wavepath {
namespace {

constexpr const char* kValidationLayer = "VK_LAYER_KHRONOS_validation";
std::atomic<std::uint32_t> validation_message_count{0};

VKAPI_ATTR VkBool32 VKAPI_CALL on_validation_message(VkDebugUtilsMessageSeverityFlagBitsEXT,
                                                     VkDebugUtilsMessageTypeFlagsEXT,
                                                     const VkDebugUtilsMessengerCallbackDataEXT* data, void*) {
  ++validation_message_count;
  std::fprintf(stderr, "wavepath: validation: %s\n", data->pMessage);
  return VK_FALSE;
}

const char* result_name(VkResult result) {
  switch (result) {
    case VK_ERROR_OUT_OF_HOST_MEMORY:
      return "out of host memory";
    case VK_ERROR_OUT_OF_DEVICE_MEMORY:
      return "out of device memory";
    case VK_ERROR_INITIALIZATION_FAILED:
      return "initialization failed";
    case VK_ERROR_DEVICE_LOST:
      return "device lost";
    case VK_ERROR_LAYER_NOT_PRESENT:
      return "layer not present";
    case VK_ERROR_EXTENSION_NOT_PRESENT:
      return "extension not present";
    case VK_ERROR_FEATURE_NOT_PRESENT:
      return "feature not present";
    case VK_ERROR_INCOMPATIBLE_DRIVER:
      return "no Vulkan driver";
    case VK_TIMEOUT:
      return "the device does not answer";
    default:
      return "error";
  }
}

bool validation_wanted() {
  const char* value = std::getenv("WAVEPATH_VALIDATION");
  return value != nullptr && *value != '\0' && std::strcmp(value, "0") != 0;
}

// A CPU driver that emulates a discrete GPU takes every choice that a GPU would get: staging for all copies, the walk
// by lane, a large pool of paths, generic kernels first. A device may also emulate one whose texel buffers are as small
// as Vulkan lets them be. Tests reach that code on machines without such devices.
enum class Emulation { none, discrete, few_texels };

Emulation emulation_wanted() {
  const char* value = std::getenv("WAVEPATH_EMULATE");
  if (value == nullptr || *value == '\0') return Emulation::none;
  if (std::strcmp(value, "discrete") == 0) return Emulation::discrete;
  if (std::strcmp(value, "few-texels") == 0) return Emulation::few_texels;
  throw Error("WAVEPATH_EMULATE", fmt::format("unknown value '{}'", value),
              "set it to discrete or few-texels, or unset it");
}

bool layer_present(const char* name) {
  std::uint32_t count = 0;
  vkEnumerateInstanceLayerProperties(&count, nullptr);
  std::vector<VkLayerProperties> layers(count);
  vkEnumerateInstanceLayerProperties(&count, layers.data());
  return std::any_of(layers.begin(), layers.end(), [&](const auto& l) { return std::strcmp(l.layerName, name) == 0; });
}

bool extension_present(VkPhysicalDevice physical, const char* name) {
  std::uint32_t count = 0;
  vkEnumerateDeviceExtensionProperties(physical, nullptr, &count, nullptr);
  std::vector<VkExtensionProperties> extensions(count);
  vkEnumerateDeviceExtensionProperties(physical, nullptr, &count, extensions.data());
  return std::any_of(extensions.begin(), extensions.end(),
                     [&](const auto& e) { return std::strcmp(e.extensionName, name) == 0; });
}

VkDebugUtilsMessengerCreateInfoEXT messenger_info() {
  VkDebugUtilsMessengerCreateInfoEXT info{VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT};
  info.messageSeverity =
      VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
  info.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT;
  info.pfnUserCallback = on_validation_message;
  return info;
}

// Drivers keep tables that they allocate at their first use (Mesa: the caches of a processor by AMD). The loader
// unloads a driver together with the pointers to these tables, and LeakSanitizer would take them for leaks of ours.
struct DriverTables {
#ifdef WAVEPATH_SANITIZE
  __lsan::ScopedDisabler unwatched;
#else
  DriverTables() {} // not trivial: a guard that nobody reads
#endif
};

VkInstance create_instance(bool validation, std::span<const char* const> window_extensions = {}) {
  std::uint32_t version = VK_API_VERSION_1_0;
  check(vkEnumerateInstanceVersion(&version), "asking for the loader's version");
  if (version < VK_API_VERSION_1_3)
    throw Error("Vulkan", "the loader knows no Vulkan 1.3", "update libvulkan1 and the graphics driver");
  if (validation && !layer_present(kValidationLayer))
    throw Error("WAVEPATH_VALIDATION", "the validation layer is not installed",
                "install vulkan-validationlayers or unset it");

  VkApplicationInfo application{VK_STRUCTURE_TYPE_APPLICATION_INFO};
  application.pApplicationName = "wavepath";
  application.apiVersion = VK_API_VERSION_1_3;
  std::vector<const char*> extensions(window_extensions.begin(), window_extensions.end());
  VkDebugUtilsMessengerCreateInfoEXT messenger = messenger_info();
  const VkValidationFeatureEnableEXT enable = VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT;
  VkValidationFeaturesEXT features{VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT};
  features.pNext = &messenger;
  features.enabledValidationFeatureCount = 1;
  features.pEnabledValidationFeatures = &enable;
  VkInstanceCreateInfo info{VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO};
  info.pApplicationInfo = &application;
  if (validation) {
    info.pNext = &features;
    info.enabledLayerCount = 1;
    info.ppEnabledLayerNames = &kValidationLayer;
    extensions.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
  }
  info.enabledExtensionCount = static_cast<std::uint32_t>(extensions.size());
  info.ppEnabledExtensionNames = extensions.data();
  VkInstance instance = VK_NULL_HANDLE;
  const DriverTables tables;
  const VkResult result = vkCreateInstance(&info, nullptr, &instance);
  if (result == VK_ERROR_INCOMPATIBLE_DRIVER) throw Error("Vulkan", "there is no driver", driver_remedy());
  check(result, "creating a Vulkan instance");
  return instance;
}

std::vector<VkPhysicalDevice> physical_devices(VkInstance instance) {
  const DriverTables tables;
  std::uint32_t count = 0;
  check(vkEnumeratePhysicalDevices(instance, &count, nullptr), "listing devices");
  std::vector<VkPhysicalDevice> devices(count);
  check(vkEnumeratePhysicalDevices(instance, &count, devices.data()), "listing devices");
  return devices;
}

const char* type_name(VkPhysicalDeviceType type) {
  switch (type) {
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
      return "discrete";
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
      return "integrated";
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
      return "virtual";
    case VK_PHYSICAL_DEVICE_TYPE_CPU:
      return "cpu";
    default:
      return "other";
  }
}

struct QueueFamily {
  std::uint32_t index = gpu::kNone; // none that computes
  std::uint32_t timestamp_bits = 0;
  bool rasterizes = false;
};

// The first that computes, or better the first that also rasterizes.
QueueFamily choose_family(VkPhysicalDevice physical) {
  std::uint32_t count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, families.data());
  QueueFamily chosen;
  for (std::uint32_t i = 0; i < count; ++i) {
    if (!(families[i].queueFlags & VK_QUEUE_COMPUTE_BIT)) continue;
    const bool rasterizes = families[i].queueFlags & VK_QUEUE_GRAPHICS_BIT;
    if (chosen.index == gpu::kNone || (rasterizes && !chosen.rasterizes))
      chosen = {i, families[i].timestampValidBits, rasterizes};
  }
  return chosen;
}

constexpr std::uint32_t kFewestTexels = 1u << 16; // elements of a texel buffer that Vulkan guarantees
constexpr std::uint32_t kUsualTexels = 1u << 27;  // elements that drivers of GPUs have at least

constexpr const char* kRayQueryExtensions[] = {VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME,
                                               VK_KHR_DEFERRED_HOST_OPERATIONS_EXTENSION_NAME,
                                               VK_KHR_RAY_QUERY_EXTENSION_NAME};

// Device features that ray queries need, to be queried or enabled.
struct RayQueryFeatures {
  VkPhysicalDeviceRayQueryFeaturesKHR query{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_QUERY_FEATURES_KHR};
  VkPhysicalDeviceAccelerationStructureFeaturesKHR structures{
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ACCELERATION_STRUCTURE_FEATURES_KHR, &query};
  VkPhysicalDeviceVulkan12Features core12{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES, &structures};
};

void describe_ray_queries(VkPhysicalDevice physical, DeviceInfo& info) {
  for (const char* extension : kRayQueryExtensions)
    if (!extension_present(physical, extension)) return;
  RayQueryFeatures has;
  VkPhysicalDeviceFeatures2 features{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, &has.core12};
  vkGetPhysicalDeviceFeatures2(physical, &features);
  info.has_ray_queries = has.query.rayQuery && has.structures.accelerationStructure && has.core12.bufferDeviceAddress;
  VkPhysicalDeviceAccelerationStructurePropertiesKHR limits{
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ACCELERATION_STRUCTURE_PROPERTIES_KHR};
  VkPhysicalDeviceProperties2 properties{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &limits};
  vkGetPhysicalDeviceProperties2(physical, &properties);
  info.max_query_triangles = limits.maxPrimitiveCount;
  info.max_query_instances = limits.maxInstanceCount;
}

// Every device samples both formats.
void describe_images(VkPhysicalDevice physical, DeviceInfo& info) {
  constexpr VkImageUsageFlags kUsage =
      VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
  info.max_image_side = info.max_image_layers = ~0u;
  info.max_image_bytes = ~std::uint64_t{0};
  for (const VkFormat format : {VK_FORMAT_R8G8B8A8_UNORM, VK_FORMAT_R8G8B8A8_SRGB}) {
    VkImageFormatProperties most{};
    check(vkGetPhysicalDeviceImageFormatProperties(physical, format, VK_IMAGE_TYPE_2D, VK_IMAGE_TILING_OPTIMAL, kUsage,
                                                   0, &most),
          "asking for the limits of an image");
    info.max_image_side = std::min({info.max_image_side, most.maxExtent.width, most.maxExtent.height});
    info.max_image_layers = std::min(info.max_image_layers, most.maxArrayLayers);
    info.max_image_bytes = std::min<std::uint64_t>(info.max_image_bytes, most.maxResourceSize);
  }
}

DeviceInfo describe(VkPhysicalDevice physical, Emulation emulation) {
  VkPhysicalDeviceProperties base{};
  vkGetPhysicalDeviceProperties(physical, &base);
  DeviceInfo info;
  info.name = base.deviceName;
  const bool emulates = emulation == Emulation::discrete && base.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU;
  info.type = type_name(emulates ? VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU : base.deviceType);
  info.api = fmt::format("{}.{}.{}", VK_API_VERSION_MAJOR(base.apiVersion), VK_API_VERSION_MINOR(base.apiVersion),
                         VK_API_VERSION_PATCH(base.apiVersion));
  if (base.apiVersion < VK_API_VERSION_1_3) {
    info.missing.push_back("Vulkan 1.3 (it has " + info.api + ")");
    return info;
  }

  VkPhysicalDeviceVulkan11Properties core11{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_PROPERTIES};
  VkPhysicalDeviceVulkan12Properties core12{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_PROPERTIES};
  core11.pNext = &core12;
  VkPhysicalDeviceProperties2 properties{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2};
  properties.pNext = &core11;
  vkGetPhysicalDeviceProperties2(physical, &properties);
  const VkPhysicalDeviceLimits& limits = properties.properties.limits;
  info.driver = fmt::format("{} {}", core12.driverName, core12.driverInfo);
  info.dispatches_at_once = info.ends_long_loops = core12.driverID == VK_DRIVER_ID_MESA_LLVMPIPE;
  info.subgroup_size = core11.subgroupSize;
  info.max_allocation = core11.maxMemoryAllocationSize;
  info.max_storage_range = limits.maxStorageBufferRange - kBufferPadding;
  const std::uint32_t texels = emulation == Emulation::few_texels ? kFewestTexels : limits.maxTexelBufferElements;
  info.max_texel_elements = texels - kBufferPadding / sizeof(std::uint32_t);
  info.has_few_texels = texels < kUsualTexels;
  info.max_storage = limits.maxPerStageDescriptorStorageBuffers;
  info.max_sampled = limits.maxPerStageDescriptorSampledImages;
  info.max_groups = limits.maxComputeWorkGroupCount[0];

  describe_images(physical, info);

  VkPhysicalDeviceMemoryProperties memory{};
  vkGetPhysicalDeviceMemoryProperties(physical, &memory);
  // The heap that an integrated GPU calls its own may be a small part of the memory that it reaches as fast.
  const bool all_alike = base.deviceType == VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU;
  for (std::uint32_t i = 0; i < memory.memoryHeapCount; ++i)
    if (all_alike || (memory.memoryHeaps[i].flags & VK_MEMORY_HEAP_DEVICE_LOCAL_BIT))
      info.memory_bytes = std::max<std::uint64_t>(info.memory_bytes, memory.memoryHeaps[i].size);

  describe_ray_queries(physical, info);
  const QueueFamily family = choose_family(physical);
  info.rasterizes = family.rasterizes;
  info.draws_slowly = draws_slowly(info.name);
  if (family.index == gpu::kNone) info.missing.push_back("a queue for compute");
  if (family.timestamp_bits >= 36) {
    info.timestamp_period_ns = limits.timestampPeriod;
    info.timestamp_bits = family.timestamp_bits;
  }
  if (!(core11.subgroupSupportedStages & VK_SHADER_STAGE_COMPUTE_BIT) ||
      !(core11.subgroupSupportedOperations & VK_SUBGROUP_FEATURE_BALLOT_BIT))
    info.missing.push_back("subgroup ballot in compute shaders");
  if (info.max_storage < 16) info.missing.push_back("16 storage buffers a stage");
  if (info.max_sampled < 21) info.missing.push_back("21 texel buffers a stage");
  return info;
}

} // namespace

void check(VkResult result, const char* what) {
  if (result == VK_SUCCESS) return;
  if (result == VK_ERROR_DEVICE_LOST || result == VK_TIMEOUT)
    throw DeviceLost("Vulkan", fmt::format("{} failed: {}", what, result_name(result)),
                     "see the system's log for why; run again, or choose another device with --device");
  const bool memory = result == VK_ERROR_OUT_OF_HOST_MEMORY || result == VK_ERROR_OUT_OF_DEVICE_MEMORY;
  rlimit limit{};
  if (result == VK_ERROR_INITIALIZATION_FAILED && getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY)
    throw Error("Vulkan",
                fmt::format("{} failed: the driver finds too little memory, of which {} MiB are allowed", what,
                            limit.rlim_cur >> 20),
                "allow more (ulimit -v)");
  throw Error("Vulkan", fmt::format("{} failed: {} ({})", what, result_name(result), static_cast<int>(result)),
              memory ? "use a smaller --size or scene, or close other programs"
                     : "run `wavepath info` to see the device, or choose another with --device");
}

std::vector<DeviceInfo> list_devices() {
  const Emulation emulation = emulation_wanted();
  VkInstance instance = VK_NULL_HANDLE;
  try {
    instance = create_instance(false);
  } catch (const Error&) {
    return {}; // a machine without any driver has no devices
  }
  std::vector<DeviceInfo> devices;
  for (VkPhysicalDevice physical : physical_devices(instance)) devices.push_back(describe(physical, emulation));
  vkDestroyInstance(instance, nullptr);
  return devices;
}

std::uint32_t Context::validation_messages() { return validation_message_count; }

// WAVEPATH_LOSE_DEVICE=N.
std::uint64_t Context::submissions_of_test() {
  static std::atomic<std::uint64_t> opened = 0;
  const std::uint64_t number = opened++;
  const char* value = std::getenv("WAVEPATH_LOSE_DEVICE");
  if (!value || !*value) return ~std::uint64_t{0};
  const char* which = std::strchr(value, '@');
  if (which && std::strtoull(which + 1, nullptr, 10) != number) return ~std::uint64_t{0};
  return std::strtoull(value, nullptr, 10);
}

VkResult Context::submit(const VkSubmitInfo2& work, VkFence fence) {
  const std::lock_guard lock(queue_mutex_);
  if (submissions_left_ == 0 || gone_) return VK_ERROR_DEVICE_LOST;
  --submissions_left_;
  return vkQueueSubmit2(queue_, 1, &work, fence);
}

// Waits in slices: a process that was stopped for hours and continues has waited for only one of them.
VkResult Context::wait(VkFence fence) const {
  if (gone_) return VK_ERROR_DEVICE_LOST;
  VkResult result = VK_TIMEOUT;
  for (std::uint64_t waited = 0; result == VK_TIMEOUT && waited < kLongestWait; waited += kWaitSlice)
    result = vkWaitForFences(device_, 1, &fence, VK_TRUE, kWaitSlice);
  if (result == VK_TIMEOUT || result == VK_ERROR_DEVICE_LOST) gone_ = true;
  return result;
}

Context::Context(const std::string& wanted, std::span<const char* const> window_extensions, DeviceUse use)
    : use_(use), has_rasterized_(!window_extensions.empty()) {
  const bool validation = validation_wanted();
  const Emulation emulation = emulation_wanted();
  instance_ = create_instance(validation, window_extensions);
  try {
    if (validation) {
      const auto create = reinterpret_cast<PFN_vkCreateDebugUtilsMessengerEXT>(
          vkGetInstanceProcAddr(instance_, "vkCreateDebugUtilsMessengerEXT"));
      const VkDebugUtilsMessengerCreateInfoEXT info = messenger_info();
      check(create(instance_, &info, nullptr, &messenger_), "creating the validation messenger");
    }
    // The device and its queue family.
    const std::vector<VkPhysicalDevice> physical = physical_devices(instance_);
    std::vector<DeviceInfo> described;
    for (VkPhysicalDevice p : physical) described.push_back(describe(p, emulation));
    const std::size_t chosen = choose_device(described, wanted);
    info_ = described[chosen];
    physical_ = physical[chosen];
    queue_family_ = choose_family(physical_).index;
    vkGetPhysicalDeviceMemoryProperties(physical_, &memory_);
    unified_memory_ = info_.type == "cpu" || info_.type == "integrated";

    const float priority = 1.0f;
    // Features and extensions.
    VkDeviceQueueCreateInfo queue_info{VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO};
    queue_info.queueFamilyIndex = queue_family_;
    queue_info.queueCount = 1;
    queue_info.pQueuePriorities = &priority;
    VkPhysicalDeviceVulkan13Features core13{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES};
    core13.synchronization2 = VK_TRUE; // all mandatory in 1.3
    core13.maintenance4 = VK_TRUE;     // glslang writes workgroup sizes as LocalSizeId
    core13.dynamicRendering = VK_TRUE;
    VkPhysicalDevicePipelineExecutablePropertiesFeaturesKHR statistics{
        VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PIPELINE_EXECUTABLE_PROPERTIES_FEATURES_KHR};
    statistics.pipelineExecutableInfo = VK_TRUE;
    std::vector<const char*> extensions;
    if (!window_extensions.empty()) extensions.push_back(VK_KHR_SWAPCHAIN_EXTENSION_NAME);
    if (use == DeviceUse::compile) {
      const char* told = VK_KHR_PIPELINE_EXECUTABLE_PROPERTIES_EXTENSION_NAME;
      if (!extension_present(physical_, told))
        throw Error(info_.name, fmt::format("its driver does not tell what it compiles ({})", told),
                    "choose another device with --device");
      extensions.push_back(told);
      core13.pNext = &statistics;
    }
    RayQueryFeatures queries;
    if (info_.has_ray_queries) {
      queries.query.rayQuery = VK_TRUE;
      queries.structures.accelerationStructure = VK_TRUE;
      queries.core12.bufferDeviceAddress = VK_TRUE;
      queries.query.pNext = core13.pNext;
      core13.pNext = &queries.core12;
      extensions.insert(extensions.end(), std::begin(kRayQueryExtensions), std::end(kRayQueryExtensions));
    }
    VkPhysicalDeviceFeatures supported{}, core10{};
    vkGetPhysicalDeviceFeatures(physical_, &supported);
    core10.robustBufferAccess = validation && supported.robustBufferAccess; // a slip does not reach foreign memory
    // The logical device, its queue and its pipeline cache.
    VkDeviceCreateInfo info{VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO};
    info.pNext = &core13;
    info.pEnabledFeatures = &core10;
    info.queueCreateInfoCount = 1;
    info.pQueueCreateInfos = &queue_info;
    info.enabledExtensionCount = static_cast<std::uint32_t>(extensions.size());
    info.ppEnabledExtensionNames = extensions.data();
    {
      // llvmpipe starts its threads in vkCreateDevice(): one for each core unless it is told otherwise.
      std::optional<WorkerThreads::Making> making;
      if (info_.dispatches_at_once && !std::getenv("LP_NUM_THREADS")) making.emplace(workers_);
      check(vkCreateDevice(physical_, &info, nullptr, &device_), "opening the device");
    }
    vkGetDeviceQueue(device_, queue_family_, 0, &queue_);
    pipeline_cache_ = std::make_unique<PipelineCache>(physical_, device_);
  } catch (...) {
    release();
    throw;
  }
}

Context::~Context() { release(); }

void Context::release() {
  pipeline_cache_.reset();
  if (device_) vkDestroyDevice(device_, nullptr);
  if (messenger_) {
    const auto destroy = reinterpret_cast<PFN_vkDestroyDebugUtilsMessengerEXT>(
        vkGetInstanceProcAddr(instance_, "vkDestroyDebugUtilsMessengerEXT"));
    destroy(instance_, messenger_, nullptr);
  }
  if (instance_) vkDestroyInstance(instance_, nullptr);
}

std::uint32_t Context::memory_type(std::uint32_t type_bits, VkMemoryPropertyFlags flags) const {
  for (std::uint32_t i = 0; i < memory_.memoryTypeCount; ++i)
    if ((type_bits >> i & 1u) && (memory_.memoryTypes[i].propertyFlags & flags) == flags) return i;
  return gpu::kNone;
}

void Context::count_memory(std::int64_t bytes, bool displaced) {
  const std::lock_guard lock(memory_mutex_);
  if (displaced && bytes > 0) memory_displaced_ += static_cast<std::uint64_t>(bytes);
  memory_now_ += static_cast<std::uint64_t>(bytes);
  memory_peak_ = std::max(memory_peak_, memory_now_);
}

} // namespace wavepath
