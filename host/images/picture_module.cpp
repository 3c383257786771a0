// Loads the module by the dynamic linker; it stays loaded.
#include "host/images/picture_module.h"

#include <future>

#include <dlfcn.h>

#include "host/base/error.h"

namespace wavepath {
namespace {

struct LoadedModule {
  const PictureModule* module = nullptr;
  std::string problem;
};

// The linker looks beside the program, by its run path.
LoadedModule load_module() {
  void* library = dlopen(kPictureModuleFile, RTLD_LAZY | RTLD_LOCAL);
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
