// OpenImageIO would try its readers in turn, those for films and X-rays too; here one is chosen.
#include "host/codecs/stored_format.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <filesystem>
#include <string_view>

#include "host/base/error.h"
#include "host/base/read_file.h"

namespace wavepath {
namespace {

using namespace std::string_view_literals;

struct Signature {
  std::size_t offset;
  std::string_view bytes;
  const char* format;
};

constexpr Signature kSignatures[] = {
    {0, "\x76\x2f\x31\x01"sv, "openexr"},
    {0, "#?"sv, "hdr"},
    {0, "\x89PNG\r\n\x1a\n"sv, "png"},
    {0, "\xff\xd8\xff"sv, "jpeg"},
    {8, "WEBP"sv, "webp"},
    {0, "II*\0"sv, "tiff"},
    {0, "MM\0*"sv, "tiff"},
    {0, "II+\0"sv, "tiff"},
    {0, "MM\0+"sv, "tiff"},
    {0, "BM"sv, "bmp"},
    {0, "DDS "sv, "dds"},
    {0, "8BPS"sv, "psd"},
    {0, "\0\0\0\x0cjP  \r\n\x87\n"sv, "jpeg2000"},
    {0, "\xff\x4f\xff\x51"sv, "jpeg2000"},
};

constexpr std::string_view kHeifBrands[] = {"heic"sv, "heix"sv, "heim"sv, "heis"sv, "hevc"sv,
                                            "hevx"sv, "mif1"sv, "msf1"sv, "avif"sv, "avis"sv};

bool is_pnm(std::string_view head) {
  return head.size() > 2 && head[0] == 'P' && "123456fF"sv.find(head[1]) != std::string_view::npos &&
         std::isspace(static_cast<unsigned char>(head[2]));
}

// TGA begins with no signature: the map's kind is 0 or 1, and the kind of the picture one of six.
bool is_targa(const std::string& path, std::string_view head) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return (extension == ".tga" || extension == ".tpic") && head.size() >= 18 &&
         static_cast<unsigned char>(head[1]) <= 1 && "\1\2\3\11\12\13"sv.find(head[2]) != std::string_view::npos;
}

} // namespace

const char* stored_format(const std::string& path) {
  const std::optional<std::uint64_t> size = regular_file_size(path);
  std::array<std::uint8_t, 32> bytes{};
  const std::size_t count = std::min<std::size_t>(bytes.size(), size.value_or(0));
  if (!size || !read_file(path, 0, std::span(bytes).first(count)))
    throw Error(path, "cannot be read", "check the name and its permissions");
  const std::string_view head(reinterpret_cast<const char*>(bytes.data()), count);
  for (const Signature& signature : kSignatures)
    if (head.size() >= signature.offset && head.substr(signature.offset).starts_with(signature.bytes))
      return signature.format;
  if (head.size() >= 12 && head.substr(4, 4) == "ftyp" && std::ranges::count(kHeifBrands, head.substr(8, 4)) > 0)
    return "heif";
  if (is_pnm(head)) return "pnm";
  return is_targa(path, head) ? "targa" : nullptr;
}

} // namespace wavepath
