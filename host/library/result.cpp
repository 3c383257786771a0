// Results of the interface.
#include "host/library/result_state.h"

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>

#include <fmt/format.h>
#include <stdlib.h>
#include <wavepath/result.h>

#include "host/base/error.h"
#include "host/library/guard.h"
#include "host/library/request.h"
#include "host/picture/files/picture_io.h"
#include "host/render/settings/flag_value.h"

namespace wavepath_v0 {
namespace {

// Channels of each AOV, as they are named in an EXR. "denoised" is what --denoise adds.
struct AovChannels {
  const char* aov;
  std::vector<std::string> channels;
};
const std::vector<AovChannels>& aov_channels() {
  static const std::vector<AovChannels> table = {{"albedo", {"albedo.R", "albedo.G", "albedo.B"}},
                                                 {"normal", {"N.X", "N.Y", "N.Z"}},
                                                 {"depth", {"Z"}},
                                                 {"position", {"P.X", "P.Y", "P.Z"}},
                                                 {"variance", {"variance.R", "variance.G", "variance.B"}},
                                                 {"samples", {"samples"}},
                                                 {"direct", {"direct.R", "direct.G", "direct.B"}},
                                                 {"indirect", {"indirect.R", "indirect.G", "indirect.B"}},
                                                 {"emission", {"emission.R", "emission.G", "emission.B"}},
                                                 {"roughness", {"roughness"}},
                                                 {"metallic", {"metallic"}},
                                                 {"ids", {"id.triangle", "id.instance", "id.material"}},
                                                 {"node", {"id.node"}},
                                                 {"material", {"id.material"}},
                                                 {"depth0", {"Z0"}},
                                                 {"normal0", {"N0.X", "N0.Y", "N0.Z"}},
                                                 {"position0", {"P0.X", "P0.Y", "P0.Z"}},
                                                 {"geometric", {"Ng.X", "Ng.Y", "Ng.Z"}},
                                                 {"uv", {"uv.X", "uv.Y"}},
                                                 {"depth_min", {"Zmin"}},
                                                 {"motion", {"motion.X", "motion.Y"}},
                                                 {"motion_back", {"motionBack.X", "motionBack.Y"}},
                                                 {"shadow", {"shadow"}},
                                                 {"environment", {"environment.R", "environment.G", "environment.B"}},
                                                 {"ao", {"ao"}},
                                                 {"denoised", {"denoised.R", "denoised.G", "denoised.B"}}};
  return table;
}

const wavepath::Channel& channel_of(const wavepath::Picture& picture, const std::string& name) {
  if (const wavepath::Channel* channel = wavepath::find_channel(picture, name)) return *channel;
  std::vector<std::string> names;
  for (const wavepath::Channel& channel : picture.channels) names.push_back(channel.name);
  throw wavepath::UsageError(name, "is no channel of this picture", wavepath::suggestion(name, names));
}

template <class Convert, class Number>
void copy_channels(const wavepath::Picture& picture, const std::vector<std::string>& names, Number* out,
                   const Convert& convert) {
  const std::size_t pixels = std::size_t{picture.width} * picture.height, count = names.size();
  for (std::size_t c = 0; c < count; ++c) {
    const std::vector<float>& values = channel_of(picture, names[c]).values;
    for (std::size_t i = 0; i < pixels; ++i) out[i * count + c] = convert(values[i]);
  }
}

// A folder for one file, removed with it.
class OwnFolder {
public:
  OwnFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "wavepath-XXXXXX").string();
    if (!mkdtemp(name.data()))
      throw wavepath::Error(name, "cannot be made", "set TMPDIR to a folder that can be written");
    path = name;
  }
  ~OwnFolder() {
    std::error_code error;
    std::filesystem::remove_all(path, error);
  }
  OwnFolder(OwnFolder&&) = delete;

  std::filesystem::path path;
};

} // namespace

std::uint32_t Result::width() const { return state_->picture.width; }
std::uint32_t Result::height() const { return state_->picture.height; }
Result::Place Result::place() const {
  const wavepath::PicturePlace& place = state_->picture.place;
  if (place.whole_width == 0) return {0, 0, width(), height()};
  return {place.left, place.top, place.whole_width, place.whole_height};
}

std::uint32_t Result::spp() const { return state_->spp; }
double Result::seconds() const { return state_->seconds; }
double Result::error() const { return state_->error.value_or(std::numeric_limits<double>::quiet_NaN()); }
Stop Result::stop() const { return state_->stop; }

std::vector<std::string> Result::channels() const {
  std::vector<std::string> names;
  for (const wavepath::Channel& channel : state_->picture.channels) names.push_back(channel.name);
  return names;
}

bool Result::has_channel(const std::string& name) const { return wavepath::find_channel(state_->picture, name); }

std::vector<std::string> Result::channels_of(const std::string& aov) const {
  for (const AovChannels& row : aov_channels())
    if (row.aov == aov && has_channel(row.channels.front())) return row.channels;
  return {};
}

void Result::copy(const std::vector<std::string>& channels, float* out) const {
  wavepath::guarded([&] { copy_channels(state_->picture, channels, out, [](float value) { return value; }); });
}

void Result::copy(const std::vector<std::string>& channels, std::int32_t* out) const {
  wavepath::guarded([&] {
    copy_channels(state_->picture, channels, out,
                  [](float value) { return static_cast<std::int32_t>(std::lround(value)); });
  });
}

const std::string& Result::stats() const { return state_->stats; }
const std::vector<std::string>& Result::warnings() const { return state_->warnings; }
const std::string& Result::repeat() const { return state_->repeat; }

std::string Result::text(const std::string& name) const {
  for (const auto& [own, text] : state_->picture.texts)
    if (own == name) return text;
  return {};
}

void Result::save(const std::string& file, const Settings& settings) const {
  wavepath::guarded([&] {
    wavepath::require_format(file, width(), height());
    wavepath::write_picture(file, state_->picture, state_->info, wavepath::read_write_options(file, settings));
  });
}

std::vector<std::uint8_t> Result::encode(const std::string& format, const Settings& settings) const {
  return wavepath::guarded([&] {
    const OwnFolder folder;
    const std::string file = folder.path / ("picture." + format);
    wavepath::require_format(file, width(), height());
    wavepath::write_picture(file, state_->picture, state_->info, wavepath::read_write_options(file, settings));
    std::ifstream stream(file, std::ios::binary);
    return std::vector<std::uint8_t>(std::istreambuf_iterator<char>(stream), {});
  });
}

Result read(const std::string& file) {
  return wavepath::guarded([&] {
    auto state = std::make_shared<ResultState>();
    state->picture = wavepath::read_picture(file);
    return Result(std::move(state));
  });
}

} // namespace wavepath_v0
