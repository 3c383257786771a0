// Loads the module by the dynamic linker; it stays loaded.
#include "host/codecs/picture_module.h"

#include <cstring>
#include <filesystem>
#include <future>
#include <system_error>

#include <dlfcn.h>

#include "host/base/error.h"

namespace wavepath {
namespace {

struct LoadedModule {
  const PictureModule* module = nullptr;
  std::string problem;
};

// Where the module lies, from the folder of this program or library: beside it; as installed (the library, the
// program); from the tests of a build folder. A
// run path would not do: AddressSanitizer opens libraries in the place of the program, and has none.
constexpr const char* kModuleFolders[] = {"", "wavepath", "../" WAVEPATH_LIBRARY_FOLDER "/wavepath", "../host"};

void* open_module() {
  // Path of the program or library that contains this code. A program found by PATH is named without its folder; the
  // name alone would be looked up in the current folder, where a stranger's module may be.
  Dl_info self{};
  const bool known = dladdr(reinterpret_cast<const void*>(&open_module), &self) != 0 && self.dli_fname &&
                     std::strchr(self.dli_fname, '/');
  for (const char* name : {known ? self.dli_fname : "", "/proc/self/exe"})
    for (const char* folder : kModuleFolders) {
      std::error_code error;
      const std::filesystem::path here = std::filesystem::canonical(name, error).parent_path();
      const std::filesystem::path file = here / folder / kPictureModuleFile;
      if (!here.empty() && std::filesystem::exists(file, error)) return dlopen(file.c_str(), RTLD_LAZY | RTLD_LOCAL);
    }
  return dlopen(kPictureModuleFile, RTLD_LAZY | RTLD_LOCAL); // as the user has set LD_LIBRARY_PATH
}

LoadedModule load_module() {
  void* library = open_module();
  void* entry = library ? dlsym(library, kPictureModuleEntry) : nullptr;
  if (!entry) {
    const char* words = dlerror();
    return {nullptr, words ? words : "it has no entry"};
  }
  return {reinterpret_cast<const PictureModule* (*)()>(entry)(), ""};
}

const std::shared_future<LoadedModule>& loading() {
  static const std::shared_future<LoadedModule> module = std::async(std::launch::async, load_module).share();
  return module;
}

} // namespace

void begin_loading_pictures() { loading(); }

const PictureModule& picture_module(const std::string& path) {
  const LoadedModule& loaded = loading().get();
  if (!loaded.module)
    throw Error(path, "needs the module for pictures, which cannot be loaded (" + loaded.problem + ")",
                std::string("put ") + kPictureModuleFile + " beside wavepath and install OpenImageIO");
  return *loaded.module;
}

} // namespace wavepath
