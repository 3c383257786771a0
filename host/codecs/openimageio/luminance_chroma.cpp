#include "host/codecs/openimageio/luminance_chroma.h"

#include <algorithm>
#include <exception>

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfRgbaFile.h>
#include <OpenEXR/ImfStandardAttributes.h>

#include "host/codecs/image.h"

namespace wavepath {
namespace {

std::uint32_t length_of(int first, int last) { return static_cast<std::uint32_t>(std::int64_t{last} - first + 1); }

void refuse_other_subsampling(const Imf::ChannelList& channels) {
  const bool chroma = channels.findChannel("Y") && channels.findChannel("RY") && channels.findChannel("BY");
  for (auto channel = channels.begin(); channel != channels.end(); ++channel) {
    const std::string name = channel.name();
    const bool full = channel.channel().xSampling == 1 && channel.channel().ySampling == 1;
    if (!full && !(chroma && (name == "RY" || name == "BY")))
      throw ImageError("holds channel " + name + " at less than full resolution");
  }
}

StoredPart describe(const Imf::RgbaInputFile& input) {
  const Imath::Box2i data = input.dataWindow(), display = input.displayWindow();
  StoredPart part;
  part.width = length_of(data.min.x, data.max.x);
  part.height = length_of(data.min.y, data.max.y);
  part.x = std::int64_t{data.min.x} - display.min.x;
  part.y = std::int64_t{data.min.y} - display.min.y;
  part.full_width = length_of(display.min.x, display.max.x);
  part.full_height = length_of(display.min.y, display.max.y);
  part.channels = {"R", "G", "B"};
  if (input.channels() & Imf::WRITE_A) part.channels.emplace_back("A");
  if (Imf::hasChromaticities(input.header())) {
    const Imf::Chromaticities& c = Imf::chromaticities(input.header());
    part.chromaticities = {c.red.x, c.red.y, c.green.x, c.green.y, c.blue.x, c.blue.y, c.white.x, c.white.y};
  }
  return part;
}

std::vector<std::vector<float>> read_rgba(Imf::RgbaInputFile& input, const StoredPart& part,
                                          const StoredChoice& choice) {
  const Imath::Box2i data = input.dataWindow();
  std::vector<std::vector<float>> planes(choice.channels.size(),
                                         std::vector<float>(std::size_t{part.width} * part.height));
  std::vector<Imf::Rgba> row(part.width);
  for (std::size_t y = 0; y < part.height; ++y) {
    const int line = data.min.y + static_cast<int>(y);
    Imf::Rgba* first = row.data() - data.min.x; // where column 0 would be
    input.setFrameBuffer(first, 1, 0);
    input.readPixels(line);
    for (std::size_t c = 0; c < planes.size(); ++c)
      for (std::size_t x = 0; x < row.size(); ++x) {
        const float channels[] = {row[x].r, row[x].g, row[x].b, row[x].a};
        planes[c][y * part.width + x] = channels[choice.channels[c]];
      }
  }
  return planes;
}

} // namespace

std::vector<std::vector<float>> read_luminance_chroma(const std::string& path, const ChooseStored& choose) {
  const auto with_openexr = [](const auto& step) {
    try {
      return step();
    } catch (const ImageError&) {
      throw;
    } catch (const std::exception& error) {
      throw ImageError("is damaged or cut short (" + std::string(error.what()) + ")");
    }
  };
  std::optional<Imf::RgbaInputFile> input;
  with_openexr([&] {
    input.emplace(path.c_str());
    refuse_other_subsampling(input->header().channels());
  });
  const StoredPart part = describe(*input);
  const StoredChoice choice = choose({part});
  return with_openexr([&] { return read_rgba(*input, part, choice); });
}

} // namespace wavepath
