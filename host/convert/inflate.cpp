#include "host/convert/inflate.h"

#include <algorithm>
#include <limits>

#include <zlib.h>

#include "host/base/error.h"
#include "host/base/memory.h"

namespace wavepath::convert {
namespace {

constexpr std::uint64_t kMostInflated = std::uint64_t{1} << 34;

struct Stream {
  z_stream state{};
  ~Stream() { inflateEnd(&state); }
};

} // namespace

std::vector<std::uint8_t> inflated(const std::string& path, std::span<const std::uint8_t> packed) {
  const std::uint64_t most = std::min(kMostInflated, available_memory() / 2);
  Stream stream;
  if (inflateInit2(&stream.state, 15 + 32) != Z_OK) throw Error(path, "cannot be decompressed", "free some memory");
  std::vector<std::uint8_t> out(std::max<std::size_t>(packed.size() * 3, 4096));
  std::size_t done = 0, taken = 0;
  for (;;) {
    constexpr std::size_t kMost = std::numeric_limits<uInt>::max();
    stream.state.next_in = const_cast<Bytef*>(packed.data() + taken);
    const std::size_t in = std::min(packed.size() - taken, kMost), room = std::min(out.size() - done, kMost);
    stream.state.avail_in = static_cast<uInt>(in);
    stream.state.next_out = out.data() + done;
    stream.state.avail_out = static_cast<uInt>(room);
    const int code = inflate(&stream.state, Z_NO_FLUSH);
    taken += in - stream.state.avail_in;
    done += room - stream.state.avail_out;
    if (code == Z_STREAM_END) break;
    if ((code != Z_OK && code != Z_BUF_ERROR) || (taken == packed.size() && stream.state.avail_out > 0))
      throw Error(path, "its compressed data are damaged or cut short", "copy or download it again");
    if (done < out.size()) continue;
    if (out.size() > most / 2)
      throw Error(path, "decompresses to more than fits into memory", "check that it is intact");
    out.resize(out.size() * 2);
  }
  out.resize(done);
  return out;
}

} // namespace wavepath::convert
