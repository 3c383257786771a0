// Stands for Intel's Open Image Denoise in tests: the functions that wavepath calls, and a filter whose result tells
// that every picture reached it.
#include <cstddef>
#include <cstdlib>
#include <map>
#include <string>

namespace {

struct Filter {
  std::map<std::string, float*> images;
  std::size_t values = 0;
  bool hdr = false, committed = false;
};
int created_on = 0;

} // namespace

extern "C" {

void* oidnNewDevice(int type) {
  created_on = type;
  return &created_on;
}
void oidnCommitDevice(void*) {}
void oidnReleaseDevice(void*) {}
int oidnGetDeviceError(void*, const char** message) {
  *message = "as the test wants it";
  return std::getenv("OIDN_STUB_FAILS") ? 1 : 0;
}
void* oidnNewFilter(void*, const char* type) { return type == std::string("RT") ? new Filter : nullptr; }
void oidnReleaseFilter(void* filter) { delete static_cast<Filter*>(filter); }
void oidnSetSharedFilterImage(void* filter, const char* name, void* pixels, int format, std::size_t width,
                              std::size_t height, std::size_t, std::size_t, std::size_t) {
  static_cast<Filter*>(filter)->images[name] = static_cast<float*>(pixels);
  static_cast<Filter*>(filter)->values = static_cast<std::size_t>(format) * width * height;
}
void oidnSetFilter1b(void* filter, const char* name, bool value) {
  if (name == std::string("hdr")) static_cast<Filter*>(filter)->hdr = value;
}
void oidnCommitFilter(void* filter) { static_cast<Filter*>(filter)->committed = true; }
void oidnExecuteFilter(void* filter) {
  Filter& f = *static_cast<Filter*>(filter);
  if (!f.hdr || !f.committed) return;
  for (std::size_t i = 0; i < f.values; ++i)
    f.images["output"][i] = f.images["albedo"][i] + f.images["normal"][i] + f.images["color"][i];
}
}
