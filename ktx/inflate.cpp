// Undoes Zstandard (RFC 8478) by libzstd, and zlib (RFC 1950) by zlib.
#include "ktx/inflate.h"

#include <string>

#include <zlib.h>
#include <zstd.h>

#include "ktx/error.h"

namespace wavepath::ktx {

std::vector<std::uint8_t> inflate_zstd(std::span<const std::uint8_t> data, std::size_t length) {
  std::vector<std::uint8_t> out(length);
  const std::size_t count = ZSTD_decompress(out.data(), out.size(), data.data(), data.size());
  if (ZSTD_isError(count)) fail_damaged(std::string("Zstandard: ") + ZSTD_getErrorName(count));
  if (count != length) fail_damaged("Zstandard: too few bytes");
  return out;
}

std::vector<std::uint8_t> inflate_zlib(std::span<const std::uint8_t> data, std::size_t length) {
  std::vector<std::uint8_t> out(length);
  auto count = static_cast<uLongf>(length);
  const int result = uncompress(out.data(), &count, data.data(), static_cast<uLong>(data.size()));
  if (result != Z_OK) fail_damaged(std::string("zlib: ") + zError(result));
  if (count != length) fail_damaged("zlib: too few bytes");
  return out;
}

} // namespace wavepath::ktx
