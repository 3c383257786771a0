#include "host/codecs/decode.h"

#include <algorithm>
#include <string_view>

#include "host/codecs/jpeg.h"
#include "host/codecs/png.h"
#include "host/codecs/webp.h"

namespace wavepath {

std::optional<FileFormat> file_format(std::span<const std::uint8_t> file) {
  const std::string_view head(reinterpret_cast<const char*>(file.data()), std::min<std::size_t>(file.size(), 12));
  if (head.starts_with("\x89PNG\r\n\x1a\n")) return FileFormat::png;
  if (head.starts_with("\xff\xd8\xff")) return FileFormat::jpeg;
  if (head.starts_with("RIFF") && head.ends_with("WEBP")) return FileFormat::webp;
  return std::nullopt;
}

DecodedImage decode(FileFormat format, std::span<const std::uint8_t> file, const CheckShape& check) {
  switch (format) {
    case FileFormat::png:
      return decode_png(file, check);
    case FileFormat::jpeg:
      return decode_jpeg(file, check);
    case FileFormat::webp:
      break;
  }
  return decode_webp(file, check);
}

} // namespace wavepath
