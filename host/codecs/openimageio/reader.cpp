#include "host/codecs/openimageio/reader.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>
#include <exception>

#include <OpenImageIO/imageio.h>

#include "host/codecs/image.h"
#include "host/codecs/openimageio/header_checks.h"
#include "host/codecs/openimageio/luminance_chroma.h"

namespace wavepath {
namespace {

using OIIO::ImageInput;
using OIIO::ImageSpec;
using OIIO::TypeDesc;

constexpr int kMostParts = 256, kMostChannels = 4096;
constexpr int kChunkRows = 64; // of scanlines that are read at a time

// OpenImageIO's words, on one line.
std::string words_of(std::string text) {
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back()))) text.pop_back();
  for (char& letter : text)
    if (std::iscntrl(static_cast<unsigned char>(letter))) letter = ' ';
  return text.empty() ? "it does not say why" : text;
}

// Calls into OpenImageIO, whose readers throw what their containers do where a file claims sizes that cannot be.
template <class Step>
void guarded(const Step& step) {
  try {
    step();
  } catch (const ImageError&) {
    throw;
  } catch (const std::exception& error) {
    throw ImageError("is damaged, or too large for the memory that is left (" + words_of(error.what()) + ")");
  }
}

[[noreturn]] void damaged(ImageInput& input) {
  throw ImageError("is damaged or cut short (" + words_of(input.geterror()) + ")");
}

std::string text_of(const ImageSpec& spec, const char* name) {
  const OIIO::string_view text = spec.get_string_attribute(name);
  return {text.data(), text.size()};
}

bool is_whole(const TypeDesc& type) { return !type.is_floating_point(); }

// Whole numbers are for displays, and by custom in sRGB, unless the file says otherwise; floats are linear.
void set_encoding(const ImageSpec& spec, bool display, StoredPart& part) {
  if (!display) return;
  part.encoding = Encoding::srgb;
  std::string space = text_of(spec, "oiio:ColorSpace");
  std::transform(space.begin(), space.end(), space.begin(), [](unsigned char c) { return std::tolower(c); });
  const float gamma = spec.get_float_attribute("oiio:Gamma", 0.0f);
  if (space.starts_with("lin")) part.encoding = Encoding::linear;
  if (!space.starts_with("gamma") || !(gamma >= 0.1f && gamma <= 10.0f)) return;
  part.encoding = Encoding::gamma;
  part.gamma = static_cast<double>(gamma);
}

std::optional<std::array<float, 8>> chromaticities_of(const ImageSpec& spec) {
  std::array<float, 8> values{};
  if (!spec.getattribute("chromaticities", TypeDesc(TypeDesc::FLOAT, 8), values.data())) return std::nullopt;
  return values;
}

StoredPart part_of(const ImageSpec& spec, bool exr) {
  StoredPart part;
  part.width = static_cast<std::uint32_t>(std::max(spec.width, 0));
  part.height = static_cast<std::uint32_t>(std::max(spec.height, 0));
  part.x = std::int64_t{spec.x} - spec.full_x;
  part.y = std::int64_t{spec.y} - spec.full_y;
  part.full_width = static_cast<std::uint32_t>(std::max(spec.full_width, 0));
  part.full_height = static_cast<std::uint32_t>(std::max(spec.full_height, 0));
  part.channels.assign(spec.channelnames.begin(), spec.channelnames.end());
  part.display = !exr && is_whole(spec.format);
  set_encoding(spec, part.display, part);
  if (spec.alpha_channel >= 0 && spec.get_int_attribute("oiio:UnassociatedAlpha") != 0)
    part.unassociated_alpha = static_cast<std::size_t>(spec.alpha_channel);
  part.chromaticities = chromaticities_of(spec);
  part.orientation = spec.get_int_attribute("Orientation", 1);
  part.deep = spec.deep;
  part.cube = text_of(spec, "textureformat") == "CubeFace Environment";
  if (part.width == 0 || part.height == 0 || spec.depth > 1) throw ImageError("is no flat picture of pixels");
  if (spec.nchannels > kMostChannels || static_cast<int>(part.channels.size()) != spec.nchannels)
    throw ImageError("has channels that cannot be told apart");
  return part;
}

std::vector<StoredPart> parts_of(ImageInput& input, bool exr) {
  std::vector<StoredPart> parts;
  for (int index = 0; index < kMostParts && input.seek_subimage(index, 0); ++index)
    parts.push_back(part_of(input.spec(), exr));
  input.geterror(); // that there is no further part is no error
  return parts;
}

// Rows `begin` to `end` of channels `first` to `last`, as `type`.
bool read_rows(ImageInput& input, int part, const ImageSpec& spec, int begin, int end, int first, int last,
               TypeDesc type, void* out) {
  if (spec.tile_width == 0)
    return input.read_scanlines(part, 0, spec.y + begin, spec.y + end, 0, first, last, type, out);
  return input.read_tiles(part, 0, spec.x, spec.x + spec.width, spec.y + begin, spec.y + end, 0, 1, first, last, type,
                          out);
}

// Channels that follow each other in the file, and have one type: `planes[i]` is that of channel first + i.
void read_run(ImageInput& input, int part, const ImageSpec& spec, int first, bool keep_whole,
              const std::vector<float*>& planes) {
  const int last = first + static_cast<int>(planes.size());
  const std::size_t width = static_cast<std::size_t>(spec.width), count = planes.size();
  const int rows = spec.tile_width == 0 ? kChunkRows : std::max(spec.tile_height, 1);
  std::vector<float> chunk(width * static_cast<std::size_t>(std::min(rows, spec.height)) * count);
  for (int begin = 0; begin < spec.height; begin += rows) {
    const int end = std::min(begin + rows, spec.height);
    const std::size_t pixels = width * static_cast<std::size_t>(end - begin);
    if (!read_rows(input, part, spec, begin, end, first, last, keep_whole ? TypeDesc::UINT : TypeDesc::FLOAT,
                   chunk.data()))
      damaged(input);
    for (std::size_t c = 0; c < count; ++c) {
      float* out = planes[c] + width * static_cast<std::size_t>(begin);
      for (std::size_t i = 0; i < pixels; ++i) {
        std::uint32_t whole = 0;
        if (keep_whole) std::memcpy(&whole, &chunk[i * count + c], sizeof whole);
        out[i] = keep_whole ? static_cast<float>(whole) : chunk[i * count + c];
      }
    }
  }
}

std::vector<std::vector<float>> read_planes(ImageInput& input, const StoredChoice& choice, bool exr) {
  const int part = static_cast<int>(choice.part);
  if (!input.seek_subimage(part, 0)) damaged(input);
  const ImageSpec spec = input.spec();
  const std::size_t pixels = static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.height);
  std::vector<std::vector<float>> planes(choice.channels.size(), std::vector<float>(pixels));
  const auto keeps_whole = [&](std::size_t channel) {
    return exr && is_whole(spec.channelformat(static_cast<int>(channel)));
  };
  for (std::size_t i = 0; i < planes.size();) {
    const std::size_t first = choice.channels[i];
    std::vector<float*> run;
    for (; i < planes.size() && choice.channels[i] == first + run.size() &&
           keeps_whole(choice.channels[i]) == keeps_whole(first);
         ++i)
      run.push_back(planes[i].data());
    read_run(input, part, spec, static_cast<int>(first), keeps_whole(first), run);
  }
  return planes;
}

} // namespace

std::vector<std::vector<float>> read_by_openimageio(const std::string& path, const char* format,
                                                    std::uint64_t most_bytes, const ChooseStored& choose) {
  const bool exr = std::strcmp(format, "openexr") == 0;
  if (std::strcmp(format, "psd") == 0) check_photoshop(path);
  if (std::strcmp(format, "dds") == 0) check_dds(path);
  if (std::strcmp(format, "bmp") == 0) check_bitmap(path);
  OIIO::attribute("limits:imagesize_MB", static_cast<int>(std::clamp<std::uint64_t>(most_bytes >> 20, 1, 1u << 30)));
  OIIO::attribute("limits:channels", kMostChannels);
  OIIO::attribute("oiio:print_uncaught_errors", 0); // what is wrong is in what is thrown
  const auto input = ImageInput::create(format);
  OIIO::geterror();
  if (!input) throw ImageError(std::string("is of a format (") + format + ") that this OpenImageIO does not read");
  ImageSpec configuration, spec;
  configuration.attribute("oiio:UnassociatedAlpha", 1); // multiplied here, in linear light
  std::vector<StoredPart> parts;
  guarded([&] {
    if (input->open(path, spec, configuration)) parts = parts_of(*input, exr);
  });
  if (parts.empty()) {
    const std::string words = words_of(input->geterror());
    if (exr && words.find("ubsampled") != std::string::npos) return read_luminance_chroma(path, choose);
    throw ImageError("is damaged or cut short (" + words + ")");
  }
  const StoredChoice choice = choose(parts);
  std::vector<std::vector<float>> planes;
  guarded([&] { planes = read_planes(*input, choice, exr); });
  return planes;
}

} // namespace wavepath
