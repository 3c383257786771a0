#include "host/picture/picture_format.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <limits>

#include <fmt/format.h>

#include "host/base/error.h"

namespace wavepath {

std::optional<PictureFormat> picture_format(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  if (extension == ".exr") return PictureFormat::exr;
  if (extension == ".hdr") return PictureFormat::hdr;
  if (extension == ".png") return PictureFormat::png;
  if (extension == ".jpg" || extension == ".jpeg") return PictureFormat::jpg;
  return std::nullopt;
}

void require_format(const std::string& path, std::uint32_t width, std::uint32_t height) {
  const std::optional<PictureFormat> format = picture_format(path);
  if (!format)
    throw UsageError(path, "has no extension that names a picture format", "end it in .exr, .hdr, .png or .jpg");
  // Limits of libjpeg and of libpng; .exr and .hdr hold every size that --size allows.
  const std::uint32_t longest = *format == PictureFormat::jpg   ? 65'500
                                : *format == PictureFormat::png ? 1'000'000
                                                                : std::numeric_limits<std::int32_t>::max();
  if (std::max(width, height) > longest)
    throw UsageError(path, fmt::format("cannot hold {}x{} pixels: a side has {} at most", width, height, longest),
                     *format == PictureFormat::jpg ? "choose .png or .exr, or a smaller picture"
                                                   : "choose .exr, or a smaller picture");
}

} // namespace wavepath
