// Fuzz target of NanoVDB files: any bytes are grids or are refused. tests/CMakeLists.txt says how it is built and run.
//
// A file of one voxel has 300 kB, most of them tables of offsets that are never looked at. So an input that does not
// begin as a file is a recipe: its first byte chooses a sound file, and every 12 bytes that follow overwrite 8 bytes of
// it, at the place that the first 4 name. Places are folded into the parts of the file that the reader looks at.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "host/base/error.h"
#include "host/scene/nanovdb/nanovdb.h"
#include "tests/volume_files.h"

namespace {

using nanovdb::io::Codec;

struct Base {
  std::vector<std::uint8_t> bytes;
  std::vector<std::size_t> places; // of words that may matter, 8 bytes each
};

template <class Build>
Base make_base(Codec codec, int first) {
  const auto field = [](const nanovdb::Coord& p) {
    return p[0] < 8 ? 0.5f : 0.1f * static_cast<float>((p[0] * 7 + p[1] * 3 + p[2]) % 9);
  };
  wavepath::test::GridSpec spec;
  spec.name = "density";
  const auto handle = wavepath::test::build_grid<Build>(field, {nanovdb::Coord(first), nanovdb::Coord(12)}, spec);
  Base base;
  base.bytes = wavepath::test::file_bytes(handle, codec);
  std::uint64_t before = ~std::uint64_t{0};
  for (std::size_t i = 0; i + 8 <= base.bytes.size(); i += 8) { // zeros and repetitions are tables
    std::uint64_t word = 0;
    std::memcpy(&word, base.bytes.data() + i, sizeof(word));
    if (word != before || i < 1024) base.places.push_back(i);
    before = word;
  }
  return base;
}

const std::vector<Base>& bases() {
  static const std::vector<Base> all = [] {
    std::vector<Base> made;
    for (const Codec codec : {Codec::NONE, Codec::ZIP, Codec::BLOSC}) {
      made.push_back(make_base<float>(codec, codec == Codec::ZIP ? -3 : 0)); // on both sides of 0: eight upper nodes
      made.push_back(make_base<nanovdb::FpN>(codec, 0));
      made.push_back(make_base<nanovdb::Fp4>(codec, 0));
    }
    return made;
  }();
  return all;
}

std::vector<std::uint8_t> file_of(const std::uint8_t* data, std::size_t size) {
  if (size < 1 || data[0] == 'N') return {data, data + size};
  const Base& base = bases()[data[0] % bases().size()];
  std::vector<std::uint8_t> bytes = base.bytes;
  for (std::size_t i = 1; i + 12 <= size; i += 12) {
    std::uint32_t place = 0;
    std::memcpy(&place, data + i, sizeof(place));
    const std::size_t at =
        place & 1 ? (place >> 1) % (bytes.size() - 8) : base.places[(place >> 1) % base.places.size()];
    std::copy_n(data + i + 4, 8, bytes.begin() + static_cast<std::ptrdiff_t>(at));
  }
  if (data[0] & 0x80 && size > 2) bytes.resize(bytes.size() * data[1] / 256);
  return bytes;
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  wavepath::Warnings warnings;
  try {
    wavepath::read_nanovdb("file", file_of(data, size), warnings);
  } catch (const wavepath::Error&) {
  }
  return 0;
}
