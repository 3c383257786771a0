#include "host/images/exr_planes.h"

#include <algorithm>
#include <exception>
#include <new>
#include <optional>
#include <thread>
#include <utility>

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfThreading.h>

namespace wavepath {
namespace {

// R G B A come first, then what is left by name, which is OpenEXR's own order.
std::pair<std::size_t, std::string> rank(const std::string& channel) {
  const std::size_t place = channel.size() == 1 ? std::string("RGBA").find(channel) : std::string::npos;
  return {place, channel};
}

// Calls into OpenEXR, whose exceptions become ImageError.
template <class Step>
void with_openexr(Step step) {
  try {
    step();
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    throw ImageError("OpenEXR cannot read it (" + std::string(error.what()) + ")");
  }
}

} // namespace

std::vector<std::vector<float>> read_exr_planes(const std::string& path, const ChooseChannels& choose) {
  Imf::setGlobalThreadCount(static_cast<int>(std::thread::hardware_concurrency()));
  std::optional<Imf::InputFile> input;
  with_openexr([&] { input.emplace(path.c_str()); });
  const Imf::Header& header = input->header();
  const Imath::Box2i window = header.dataWindow();
  const auto length = [](int first, int last) { return static_cast<std::uint32_t>(std::int64_t{last} - first + 1); };
  ExrShape shape{.width = length(window.min.x, window.max.x),
                 .height = length(window.min.y, window.max.y),
                 .cropped = window != header.displayWindow(),
                 .channels = {}};
  for (auto channel = header.channels().begin(); channel != header.channels().end(); ++channel)
    shape.channels.emplace_back(channel.name());
  std::ranges::sort(shape.channels, {}, rank);
  const std::vector<std::string> names = choose(shape);

  std::vector<std::vector<float>> planes(names.size());
  Imf::FrameBuffer pixels;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const Imf::Channel* channel = header.channels().findChannel(names[i]);
    if (!channel) throw ImageError("has no channel " + names[i]);
    if (channel->xSampling != 1 || channel->ySampling != 1)
      throw ImageError("holds channel " + names[i] + " at less than full resolution");
    planes[i].resize(std::size_t{shape.width} * shape.height);
    pixels.insert(names[i], Imf::Slice::Make(Imf::FLOAT, planes[i].data(), window));
  }
  with_openexr([&] {
    input->setFrameBuffer(pixels);
    input->readPixels(window.min.y, window.max.y);
  });
  return planes;
}

} // namespace wavepath
