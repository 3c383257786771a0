// Fuzz target of KTX2 files: any bytes are a picture or are refused. tests/CMakeLists.txt says how it is built and run.
#include <cstddef>
#include <cstdint>

#include "ktx/error.h"
#include "ktx/read.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace wavepath::ktx;
  constexpr std::uint64_t kMostTexels = 1 << 16; // so that a run decodes many files, not one large picture
  try {
    read({data, size}, [](std::uint32_t width, std::uint32_t height) {
      if (std::uint64_t{width} * height > kMostTexels) throw FileError("is too large");
    });
  } catch (const FileError&) {
  }
  return 0;
}
