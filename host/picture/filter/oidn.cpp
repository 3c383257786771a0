#include "host/picture/filter/oidn.h"

#include <cstddef>
#include <memory>
#include <type_traits>

#include <dlfcn.h>
#include <fmt/format.h>

#include "host/base/error.h"

namespace wavepath {
namespace {

constexpr const char* kWhere = "--denoise oidn";
constexpr const char* kNames[] = {"libOpenImageDenoise.so.2", "libOpenImageDenoise.so.1", "libOpenImageDenoise.so"};

// The part of the C interface that is used, the same in versions 1 and 2 but for the name of SetFilterBool. Handles are
// opaque.
using Handle = void*;
constexpr int kCpu = 1;    // OIDN_DEVICE_TYPE_CPU: it reads the pictures where they lie
constexpr int kFloat3 = 3; // OIDN_FORMAT_FLOAT3
struct Oidn {
  Handle (*new_device)(int type);
  void (*commit_device)(Handle device);
  int (*get_device_error)(Handle device, const char** message);
  void (*release_device)(Handle device);
  Handle (*new_filter)(Handle device, const char* type);
  void (*set_shared_filter_image)(Handle filter, const char* name, void* pixels, int format, std::size_t width,
                                  std::size_t height, std::size_t offset, std::size_t pixel_stride,
                                  std::size_t row_stride);
  void (*set_filter_bool)(Handle filter, const char* name, bool value);
  void (*commit_filter)(Handle filter);
  void (*execute_filter)(Handle filter);
  void (*release_filter)(Handle filter);
};

template <class Function>
void find(void* library, Function& function, const char* name, const char* old_name = nullptr) {
  void* symbol = dlsym(library, name);
  if (!symbol && old_name) symbol = dlsym(library, old_name);
  if (!symbol)
    throw Error(kWhere, fmt::format("the library of Open Image Denoise lacks the function {}", name),
                "install version 1 or 2 of it");
  function = reinterpret_cast<Function>(symbol);
}

// It stays open: what it holds for all its filters is not made to be unloaded.
Oidn open_oidn() {
  void* library = nullptr;
  for (const char* name : kNames)
    if (!library) library = dlopen(name, RTLD_NOW | RTLD_LOCAL);
  if (!library)
    throw Error(kWhere, fmt::format("Open Image Denoise is not installed ({} is not found)", kNames[0]),
                "install it from openimagedenoise.org and name its folder in LD_LIBRARY_PATH, or use --denoise alone");
  Oidn oidn{};
  find(library, oidn.new_device, "oidnNewDevice");
  find(library, oidn.commit_device, "oidnCommitDevice");
  find(library, oidn.get_device_error, "oidnGetDeviceError");
  find(library, oidn.release_device, "oidnReleaseDevice");
  find(library, oidn.new_filter, "oidnNewFilter");
  find(library, oidn.set_shared_filter_image, "oidnSetSharedFilterImage");
  find(library, oidn.set_filter_bool, "oidnSetFilterBool", "oidnSetFilter1b");
  find(library, oidn.commit_filter, "oidnCommitFilter");
  find(library, oidn.execute_filter, "oidnExecuteFilter");
  find(library, oidn.release_filter, "oidnReleaseFilter");
  return oidn;
}

const Oidn& oidn() {
  static const Oidn library = open_oidn();
  return library;
}

} // namespace

void require_oidn() { oidn(); }

std::vector<glm::vec3> denoise_by_oidn(const NoisyPicture& picture) {
  static_assert(sizeof(glm::vec3) == 3 * sizeof(float));
  const Oidn& library = oidn();
  const std::unique_ptr<void, void (*)(Handle)> device(library.new_device(kCpu), library.release_device);
  library.commit_device(device.get());
  const std::unique_ptr<void, void (*)(Handle)> filter(library.new_filter(device.get(), "RT"), library.release_filter);
  std::vector<glm::vec3> out(picture.pixels());
  const auto set = [&](const char* name, const std::vector<glm::vec3>& values) { // it writes to none but the output
    library.set_shared_filter_image(filter.get(), name, const_cast<glm::vec3*>(values.data()), kFloat3, picture.width,
                                    picture.height, 0, 0, 0);
  };
  set("color", picture.color);
  set("albedo", picture.albedo);
  set("normal", picture.normal);
  set("output", out);
  library.set_filter_bool(filter.get(), "hdr", true);
  library.commit_filter(filter.get());
  library.execute_filter(filter.get());
  const char* message = nullptr;
  if (library.get_device_error(device.get(), &message) != 0)
    throw Error(kWhere, fmt::format("Open Image Denoise failed ({})", message ? message : "it does not say why"),
                "use --denoise alone");
  return out;
}

} // namespace wavepath
