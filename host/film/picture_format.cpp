#include "host/film/picture_format.h"

#include <algorithm>
#include <cctype>
#include <filesystem>

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

} // namespace wavepath
