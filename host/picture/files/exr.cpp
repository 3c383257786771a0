// EXR files by OpenEXR, streamed through AtomicFile: OpenImageIO would hold a file of exact sums in memory as a whole.
// What headers say of a render, its sums and its picture are read the same way; pictures of other programs by
// host/codecs.
#include "host/picture/files/exr.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <exception>
#include <new>
#include <span>
#include <string_view>
#include <thread>
#include <utility>

#include <Imath/half.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfFramesPerSecond.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfMatrixAttribute.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfThreading.h>
#include <OpenEXR/ImfVecAttribute.h>
#include <fmt/format.h>

#include "host/base/atomic_file.h"
#include "host/base/error.h"
#include "host/base/memory.h"
#include "host/base/read_file.h"
#include "host/codecs/primaries.h"
#include "host/film/film.h"
#include "host/picture/files/layers.h"
#include "host/picture/picture_format.h"
#include "kernels/base/frame_types.h"
#include "kernels/base/scene_types.h"
#include "kernels/film/film_types.h"

namespace wavepath {
namespace {

constexpr float kHalfMax = 65504.0f;
constexpr std::uint64_t kMostPixels = std::uint64_t{1} << 36; // so that byte counts cannot overflow

// Remembers the first failure, because OpenEXR's destructors discard exceptions.
class Stream : public Imf::OStream {
public:
  Stream(AtomicFile& file, const std::string& name) : Imf::OStream(name.c_str()), file_(file) {}
  void write(const char data[], int bytes) override {
    guarded([&] { file_.write(data, static_cast<std::size_t>(bytes)); });
  }
  std::uint64_t tellp() override { return file_.position(); }
  void seekp(std::uint64_t position) override {
    guarded([&] { file_.seek(position); });
  }
  void rethrow() const {
    if (failure_) std::rethrow_exception(failure_);
  }

private:
  template <class Action>
  void guarded(Action action) {
    try {
      action();
    } catch (...) {
      if (!failure_) failure_ = std::current_exception();
      throw;
    }
  }

  AtomicFile& file_;
  std::exception_ptr failure_;
};

// EXR's camera space is left-handed: x right, y up, z ahead. Imath multiplies row vectors from the left.
Imath::M44f world_to_camera(const View& view) {
  const glm::dvec3 axes[3] = {glm::normalize(view.right), glm::normalize(view.up), view.forward};
  Imath::M44f m;
  for (int column = 0; column < 3; ++column) {
    for (int row = 0; row < 3; ++row) m[row][column] = static_cast<float>(axes[column][row]);
    m[3][column] = static_cast<float>(-glm::dot(axes[column], view.position));
  }
  return m;
}

// NDC has (0,0) in the upper left and (1,1) in the lower right corner; its z is arbitrary, here increasing with
// distance.
Imath::M44f world_to_ndc(const View& view) {
  const float sx = static_cast<float>(0.5 / glm::length(view.right)),
              sy = static_cast<float>(-0.5 / glm::length(view.up));
  const float middle_x = static_cast<float>(0.5 - 0.5 * view.shift.x),
              middle_y = static_cast<float>(0.5 + 0.5 * view.shift.y);
  const Imath::M44f perspective(sx, 0, 0, 0, 0, sy, 0, 0, middle_x, middle_y, 1, 1, 0, 0, -1, 0);
  const Imath::M44f orthographic(sx, 0, 0, 0, 0, sy, 0, 0, 0, 0, 1, 0, 0.5f, 0.5f, 0, 1);
  return world_to_camera(view) * (view.orthographic ? orthographic : perspective);
}

// Channels that --half leaves at 32 bits: half holds all whole numbers only up to 2048, and ends at 65504, which
// distances and positions may exceed; the depth of a miss always does.
bool needs_float(const std::string& name) {
  return name == "samples" || name == "Z" || name == "Z0" || name == "Zmin" || name.starts_with("P.") ||
         name.starts_with("P0.") || name.starts_with("id.") || name.starts_with("Crypto");
}

Imath::M44f to_matrix(const std::array<float, 16>& values) {
  Imath::M44f m;
  std::copy(values.begin(), values.end(), m.getValue());
  return m;
}

// The words of a film, one channel each: kReplicates times FilmPixel, then FilmAovs and kReplicates times SplatPixel if
// there are any, then FilmAovs of error probes, then FilmPixel of groups of lights and of their error probes, then
// SplatPixel of groups, then FilmCover, and FilmCover of error probes. Probes are stored where the probed pixels are;
// other pixels have zeros in these channels, which take next to no space in a compressed file.
constexpr std::size_t kReplicateWords = sizeof(gpu::FilmPixel) / 4, kPixelWords = gpu::kReplicates * kReplicateWords,
                      kAovWords = sizeof(gpu::FilmAovs) / 4, kSplatWords = gpu::kReplicates * gpu::kSplatWords,
                      kCoverWords = sizeof(gpu::FilmCover) / 4;
constexpr const char* kWithProbes = "whole";                        // value of the attribute wavepath.nets
constexpr const char* kQuads = "quads";                             // of wavepath.shared: pixels that share samples
constexpr const char* kBesideAttribute = "wavepath.beside";         // of a part: probed pixels outside
constexpr const char* kLightPathsAttribute = "wavepath.lightpaths"; // of a part: light paths of the whole picture

std::string film_channel(std::size_t word) { return fmt::format("{}{:02}", kFilmPrefix, word); }
std::string splat_channel(std::size_t word) { return fmt::format("{}splat.{:02}", kFilmPrefix, word); }
std::string probe_channel(std::size_t word) { return fmt::format("{}second.{:02}", kFilmPrefix, word); }
std::string group_channel(std::size_t word) { return fmt::format("{}group.{:03}", kFilmPrefix, word); }
std::string group_probe_channel(std::size_t word) { return fmt::format("{}groupsecond.{:03}", kFilmPrefix, word); }
std::string group_splat_channel(std::size_t word) { return fmt::format("{}groupsplat.{:03}", kFilmPrefix, word); }
std::string cover_channel(std::size_t word) { return fmt::format("{}cover.{:02}", kFilmPrefix, word); }
std::string probe_cover_channel(std::size_t word) { return fmt::format("{}second_cover.{:02}", kFilmPrefix, word); }
std::vector<std::string> film_channels(const FilmShape& film) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < kPixelWords + (film.aovs ? kAovWords : 0); ++i) names.push_back(film_channel(i));
  for (std::size_t i = 0; i < (film.splats ? kSplatWords : 0); ++i) names.push_back(splat_channel(i));
  for (std::size_t i = 0; i < (film.aovs && film.has_probes ? kAovWords : 0); ++i) names.push_back(probe_channel(i));
  for (std::size_t i = 0; i < film.groups * kReplicateWords; ++i) {
    names.push_back(group_channel(i));
    if (film.has_probes) names.push_back(group_probe_channel(i));
  }
  for (std::size_t i = 0; i < (film.splats ? film.groups * gpu::kSplatWords : 0); ++i)
    names.push_back(group_splat_channel(i));
  for (std::size_t i = 0; i < (film.cover ? kCoverWords : 0); ++i) names.push_back(cover_channel(i));
  for (std::size_t i = 0; i < (film.cover && film.has_probes ? kCoverWords : 0); ++i)
    names.push_back(probe_cover_channel(i));
  return names;
}

// The sums of error probes, stored where the probed pixels are.
struct ProbeSums {
  explicit ProbeSums(const FilmShape& film)
      : pixels(film.has_probes ? film.pixels() : 0),
        groups(film.has_probes ? film.pixels() * film.groups : 0),
        aovs(film.has_probes && film.aovs ? film.pixels() : 0),
        cover(film.has_probes && film.cover ? film.pixels() : 0) {}
  std::vector<gpu::FilmPixel> pixels, groups;
  std::vector<gpu::FilmAovs> aovs;
  std::vector<gpu::FilmCover> cover;
};

// Calls body(entry of the film, pixel) for every error probe whose pixel the film has.
template <class Body>
void for_each_probe(const Film& film, Body body) {
  const FilmShape shape = film.shape();
  for (std::size_t block = 0; block < shape.probe_count(); ++block)
    if (probed_pixel(film, block) < shape.pixels()) body(shape.pixels() + block, probed_pixel(film, block));
}

// The sums of both replicates of probed pixels outside a part, in the order of blocks, in hexadecimal.
std::string beside_text(const Film& film) {
  std::string text;
  for (std::size_t block = 0; block < film.beside.size(); ++block) {
    if (probed_pixel(film, block) < film.shape().pixels()) continue;
    for (const gpu::FilmPixel* sums : {&film.beside[block], &film.pixels[film.shape().pixels() + block]}) {
      std::uint32_t words[kReplicateWords];
      std::memcpy(words, sums, sizeof(words));
      for (const std::uint32_t word : words) text += fmt::format("{:08x}", word);
    }
  }
  return text;
}

// Numbers of light paths, separated by a comma. Returns false if the text is something else.
bool read_counts(const std::string& text, std::array<std::uint64_t, gpu::kReplicates>& counts) {
  const char *at = text.data(), *const end = at + text.size();
  for (std::uint64_t& count : counts) {
    if (&count != &counts.front() && (at == end || *at++ != ',')) return false;
    const auto [next, error] = std::from_chars(at, end, count);
    if (error != std::errc()) return false;
    at = next;
  }
  return at == end;
}

// The reverse of beside_text(). Returns false if the text is not of that film.
bool read_beside(const std::string& text, Film& film) {
  std::size_t at = 0;
  for (std::size_t block = 0; block < film.beside.size(); ++block) {
    if (probed_pixel(film, block) < film.shape().pixels()) continue;
    for (gpu::FilmPixel* sums : {&film.beside[block], &film.pixels[film.shape().pixels() + block]}) {
      std::uint32_t words[kReplicateWords] = {};
      for (std::uint32_t& word : words) {
        if (at + 8 > text.size()) return false;
        const auto [end, error] = std::from_chars(text.data() + at, text.data() + at + 8, word, 16);
        if (error != std::errc() || end != text.data() + at + 8) return false;
        at += 8;
      }
      std::memcpy(sums, words, sizeof(words));
    }
  }
  return at == text.size();
}

// A slice whose first value is that of the window's left top corner.
Imf::Slice slice_at(Imf::PixelType type, const void* first, const Imath::Box2i& window, std::size_t x, std::size_t y) {
  // OpenEXR takes a pointer to non-const for reading and writing alike.
  return Imf::Slice::Make(type, const_cast<void*>(first), window, x, y);
}

// Points OpenEXR at the words where they lie, for reading and writing alike.
void insert_film(Imf::FrameBuffer& pixels, Film& film, ProbeSums& probes, const Imath::Box2i& window) {
  const auto insert = [&](const std::string& channel, void* first, std::size_t words) {
    const std::size_t stride = 4 * words;
    pixels.insert(channel, slice_at(Imf::UINT, first, window, stride, stride * film.width));
  };
  const auto words_of = [](auto& values) { return reinterpret_cast<std::uint32_t*>(values.data()); };
  if (film.has_probes) {
    for (std::size_t i = 0; i < kReplicateWords; ++i) {
      insert(film_channel(i), words_of(film.pixels) + i, kReplicateWords);
      insert(film_channel(kReplicateWords + i), words_of(probes.pixels) + i, kReplicateWords);
    }
  } else {
    for (std::size_t i = 0; i < kPixelWords; ++i) insert(film_channel(i), words_of(film.pixels) + i, kPixelWords);
  }
  for (std::size_t i = 0; i < (film.aovs.empty() ? 0 : kAovWords); ++i) {
    insert(film_channel(kPixelWords + i), words_of(film.aovs) + i, kAovWords);
    if (film.has_probes) insert(probe_channel(i), words_of(probes.aovs) + i, kAovWords);
  }
  for (std::size_t i = 0; i < (film.cover.empty() ? 0 : kCoverWords); ++i) {
    insert(cover_channel(i), words_of(film.cover) + i, kCoverWords);
    if (film.has_probes) insert(probe_cover_channel(i), words_of(probes.cover) + i, kCoverWords);
  }
  for (std::size_t i = 0; i < (film.splats.empty() ? 0 : kSplatWords); ++i)
    insert(splat_channel(i), words_of(film.splats) + i, kSplatWords);
  const std::size_t group_words = film.group_count * kReplicateWords;
  for (std::size_t i = 0; i < group_words; ++i) {
    insert(group_channel(i), words_of(film.groups) + i, group_words);
    if (film.has_probes) insert(group_probe_channel(i), words_of(probes.groups) + i, group_words);
  }
  const std::size_t splat_words = film.group_splats.empty() ? 0 : film.group_count * gpu::kSplatWords;
  for (std::size_t i = 0; i < splat_words; ++i)
    insert(group_splat_channel(i), words_of(film.group_splats) + i, splat_words);
}

// The sums of groups of the probe of a pixel, there and in the film.
auto probe_groups(ProbeSums& probes, Film& film, std::size_t entry, std::size_t pixel) {
  const std::size_t count = film.group_count;
  return std::pair(std::span(probes.groups).subspan(pixel * count, count),
                   std::span(film.groups).subspan(entry * count, count));
}

constexpr const char* kNamesAttribute = "wavepath.names"; // lines "ViewLayer.Combined.R=R", where they are not ours

constexpr Imf::Compression kCompressions[] = {Imf::ZIP_COMPRESSION, Imf::ZIPS_COMPRESSION, Imf::PIZ_COMPRESSION,
                                              Imf::DWAA_COMPRESSION, Imf::NO_COMPRESSION}; // by Compression

void add_text(Imf::Header& header, const char* name, const std::string& text) {
  header.insert(name, Imf::StringAttribute(text));
}

constexpr const char* kFrameAttribute = "imageCounter"; // OpenEXR's name for it since 3.2

// Number and rate, and where the rate is a whole number the time of a clock that stood at 0 at frame 0.
void add_frame(Imf::Header& header, const SequenceFrame& frame) {
  header.insert(kFrameAttribute, Imf::IntAttribute(frame.number));
  Imf::addFramesPerSecond(header, Imf::guessExactFps(frame.per_second));
  const int rate = static_cast<int>(std::lround(frame.per_second));
  const int seconds = rate > 0 ? frame.number / rate : 0;
  if (frame.number < 0 || rate < 1 || rate > 30 || std::abs(frame.per_second - rate) > 0.0 || seconds >= 24 * 3600)
    return; // what a time code cannot say
  Imf::addTimeCode(header, {seconds / 3600, seconds / 60 % 60, seconds % 60, frame.number % rate});
}

// Attributes that other programs know, which every part has.
void add_standard_attributes(Imf::Header& header, const PictureInfo& info) {
  const std::array<float, 8>& c = kRec709;
  Imf::addChromaticities(header, {{c[0], c[1]}, {c[2], c[3]}, {c[4], c[5]}, {c[6], c[7]}});
  header.insert("samplesPerPixel", Imf::IntAttribute(static_cast<int>(info.spp)));
  header.insert("renderTimeSeconds", Imf::FloatAttribute(static_cast<float>(info.seconds)));
  if (info.focus) Imf::addFocus(header, static_cast<float>(*info.focus));
  if (info.exposure_seconds) Imf::addExpTime(header, static_cast<float>(*info.exposure_seconds));
  if (info.frame) add_frame(header, *info.frame);
  if (info.view) {
    header.insert("worldToCamera", Imf::M44fAttribute(world_to_camera(*info.view)));
    // No matrix bends, and none serves two eyes.
    if (is_rasterizable(*info.view)) header.insert("worldToNDC", Imf::M44fAttribute(world_to_ndc(*info.view)));
  }
  if (info.world_to_camera) header.insert("worldToCamera", Imf::M44fAttribute(to_matrix(*info.world_to_camera)));
  if (info.world_to_ndc) header.insert("worldToNDC", Imf::M44fAttribute(to_matrix(*info.world_to_ndc)));
}

// What wavepath says of the render, in the first part alone.
void add_own_attributes(Imf::Header& header, const PictureInfo& info) {
  header.insert("wavepath.spp", Imf::IntAttribute(static_cast<int>(info.spp)));
  header.insert("wavepath.seconds", Imf::FloatAttribute(static_cast<float>(info.seconds)));
  if (info.error) header.insert("wavepath.error", Imf::FloatAttribute(static_cast<float>(*info.error)));
  header.insert("wavepath.seed", Imf::IntAttribute(static_cast<int>(info.seed)));
  add_text(header, "wavepath.samples", info.samples);
  add_text(header, "wavepath.scene", info.scene);
  add_text(header, "wavepath.command", info.command);
  add_text(header, "wavepath.filter", info.filter);
  add_text(header, "wavepath.bias", info.bias);
  if (!info.plan.empty()) add_text(header, "wavepath.plan", info.plan);
  if (!info.repeat.empty()) add_text(header, "wavepath.repeat", info.repeat);
  add_text(header, "wavepath.version", WAVEPATH_VERSION);
  if (!info.film) return;
  add_text(header, "wavepath.identity", info.identity);
  add_text(header, "wavepath.device", info.device);
  header.insert("wavepath.origin", Imf::V3dAttribute({info.origin.x, info.origin.y, info.origin.z}));
  if (info.film->has_probes) add_text(header, "wavepath.nets", kWithProbes);
  if (info.film->quads) add_text(header, "wavepath.shared", kQuads);
  if (!info.film->shape().is_part()) return;
  if (!info.film->beside.empty()) add_text(header, kBesideAttribute, beside_text(*info.film));
  if (!info.film->splats.empty())
    add_text(header, kLightPathsAttribute, fmt::format("{},{}", info.film->light_paths[0], info.film->light_paths[1]));
}

// The pixels of a picture, counted from the left top corner of the whole; and the whole.
Imath::Box2i window_of(const Picture& picture) {
  const Imath::V2i first(static_cast<int>(picture.place.left), static_cast<int>(picture.place.top));
  return {first, first + Imath::V2i(static_cast<int>(picture.width) - 1, static_cast<int>(picture.height) - 1)};
}
Imath::Box2i whole_window(const Picture& picture) {
  const PicturePlace& place = picture.place;
  if (place.whole_width == 0) return window_of(picture);
  return {Imath::V2i(0, 0),
          Imath::V2i(static_cast<int>(place.whole_width) - 1, static_cast<int>(place.whole_height) - 1)};
}

// The reverse; nothing where a file has windows that no picture of ours has.
std::optional<PicturePlace> place_of(const Imf::Header& header) {
  const Imath::Box2i data = header.dataWindow(), whole = header.displayWindow();
  if (whole.min != Imath::V2i(0, 0) || data.min.x < 0 || data.min.y < 0 || data.max.x > whole.max.x ||
      data.max.y > whole.max.y)
    return std::nullopt;
  if (data == whole) return PicturePlace{};
  return PicturePlace{static_cast<std::uint32_t>(data.min.x), static_cast<std::uint32_t>(data.min.y),
                      static_cast<std::uint32_t>(whole.max.x) + 1, static_cast<std::uint32_t>(whole.max.y) + 1};
}

// One for each part.
std::vector<Imf::Header> make_headers(const Picture& picture, const PictureInfo& info, const WriteOptions& options,
                                      const std::vector<PicturePart>& parts) {
  std::vector<Imf::Header> headers;
  for (const PicturePart& part : parts) {
    const Imath::Box2i window = window_of(picture);
    Imf::Header& header = headers.emplace_back(whole_window(picture), window);
    header.compression() = kCompressions[static_cast<std::size_t>(part.compression)];
    if (!part.name.empty()) {
      header.setName(part.name);
      header.setType(Imf::SCANLINEIMAGE);
    }
    add_standard_attributes(header, info);
    if (headers.size() == 1) add_own_attributes(header, info);
    for (const auto& [name, text] : picture.texts) add_text(header, name.c_str(), text);
    std::string names;
    for (const std::size_t i : part.channels) {
      const std::string& channel = picture.channels[i].name;
      const std::string written = written_name(options.layers, channel);
      header.channels().insert(written, Imf::Channel(options.half && !needs_float(channel) ? Imf::HALF : Imf::FLOAT));
      if (written != channel) names += fmt::format("{}={}\n", written, channel);
    }
    if (!names.empty()) add_text(header, kNamesAttribute, names);
    if (part.sums)
      for (const std::string& channel : film_channels(info.film->shape()))
        header.channels().insert(channel, Imf::Channel(Imf::UINT));
  }
  return headers;
}

// Our own name of a channel of that part.
std::string own_name(const Imf::Header& header, const std::string& written) {
  const auto* names = header.findTypedAttribute<Imf::StringAttribute>(kNamesAttribute);
  if (!names) return written;
  const std::string text = "\n" + names->value(), key = "\n" + written + "=";
  const std::size_t at = text.find(key);
  if (at == std::string::npos) return written;
  const std::size_t first = at + key.size();
  return text.substr(first, text.find('\n', first) - first);
}

std::uint32_t size_of(int first, int last) { return static_cast<std::uint32_t>(last - first) + 1; }

// Half copies of the channels that become half; `clamped` counts what did not fit.
std::vector<std::vector<Imath::half>> to_half(const Picture& picture, std::uint64_t& clamped) {
  std::vector<std::vector<Imath::half>> halves;
  for (const Channel& channel : picture.channels) {
    std::vector<Imath::half>& values = halves.emplace_back();
    values.reserve(channel.values.size());
    if (needs_float(channel.name)) continue;
    for (const float value : channel.values) {
      clamped += std::abs(value) > kHalfMax;
      values.emplace_back(std::abs(value) > kHalfMax ? std::copysign(kHalfMax, value) : value);
    }
  }
  return halves;
}

// A channel of a file of ours.
struct StoredChannel {
  std::string name, written; // ours, and that in the file
  int part = 0;
};

// Appends the channels of a part, but for sums. False where the part is not as write_exr() leaves it.
bool list_own_channels(const Imf::Header& header, int part, const Imath::Box2i& window,
                       std::vector<StoredChannel>& channels) {
  if (header.dataWindow() != window || !place_of(header)) return false;
  if (Imf::hasChromaticities(header)) {
    const Imf::Chromaticities c = Imf::chromaticities(header);
    if (!is_rec709({c.red.x, c.red.y, c.green.x, c.green.y, c.blue.x, c.blue.y, c.white.x, c.white.y})) return false;
  }
  for (auto channel = header.channels().begin(); channel != header.channels().end(); ++channel) {
    if (std::string_view(channel.name()).starts_with(kFilmPrefix)) continue;
    if (channel.channel().xSampling != 1 || channel.channel().ySampling != 1) return false;
    channels.push_back({own_name(header, channel.name()), channel.name(), part});
  }
  return true;
}

// What `read` finds in the header of an EXR; nothing if the file is none, because reading the picture itself says what
// is wrong.
template <class Read>
auto read_header(const std::string& path, Read read) -> decltype(read(std::declval<const Imf::Header&>())) {
  if (picture_format(path) != PictureFormat::exr) return {};
  try {
    return read(Imf::InputFile(path.c_str()).header());
  } catch (const std::exception&) {
    return {};
  }
}

// Turns an exception of OpenEXR, the one in flight, into an Error.
[[noreturn]] void explain_reading(const std::string& path) try { throw; } catch (const Error&) {
  throw;
} catch (const std::bad_alloc&) {
  throw;
} catch (const std::exception& error) {
  throw Error(path, fmt::format("OpenEXR cannot read it ({})", error.what()), "check that it is a complete EXR file");
}

} // namespace

std::uint64_t write_exr(const std::string& path, const Picture& picture, const PictureInfo& info,
                        const WriteOptions& options) {
  Imf::setGlobalThreadCount(static_cast<int>(std::thread::hardware_concurrency()));
  std::uint64_t clamped = 0;
  std::vector<std::vector<Imath::half>> halves;
  if (options.half) halves = to_half(picture, clamped);

  const std::vector<PicturePart> parts = parts_of(picture, info.film != nullptr, options);
  const std::vector<Imf::Header> headers = make_headers(picture, info, options, parts);
  ProbeSums probes(info.film ? info.film->shape() : FilmShape{});
  if (info.film)
    for_each_probe(*info.film, [&](std::size_t entry, std::size_t pixel) {
      probes.pixels[pixel] = info.film->pixels[entry];
      if (!probes.aovs.empty()) probes.aovs[pixel] = info.film->aovs[entry];
      const auto [there, in_film] = probe_groups(probes, const_cast<Film&>(*info.film), entry, pixel);
      std::ranges::copy(in_film, there.begin());
      if (!probes.cover.empty()) probes.cover[pixel] = info.film->cover[entry];
    });
  const Imath::Box2i window = window_of(picture);
  const auto pixels_of = [&](const PicturePart& part) {
    Imf::FrameBuffer pixels;
    for (const std::size_t i : part.channels) {
      const Channel& channel = picture.channels[i];
      const bool as_half = options.half && !needs_float(channel.name);
      const void* values = as_half ? static_cast<const void*>(halves[i].data()) : channel.values.data();
      const std::size_t size = as_half ? sizeof(Imath::half) : sizeof(float);
      pixels.insert(written_name(options.layers, channel.name),
                    slice_at(as_half ? Imf::HALF : Imf::FLOAT, values, window, size, size * picture.width));
    }
    if (part.sums) insert_film(pixels, const_cast<Film&>(*info.film), probes, window);
    return pixels;
  };

  AtomicFile file(path);
  Stream stream(file, path);
  const int height = static_cast<int>(picture.height);
  try {
    if (parts.size() == 1) {
      Imf::OutputFile output(stream, headers.front());
      output.setFrameBuffer(pixels_of(parts.front()));
      output.writePixels(height);
    } else {
      Imf::MultiPartOutputFile output(stream, headers.data(), static_cast<int>(headers.size()));
      for (std::size_t i = 0; i < parts.size(); ++i) {
        Imf::OutputPart part(output, static_cast<int>(i));
        part.setFrameBuffer(pixels_of(parts[i]));
        part.writePixels(height);
      }
    }
  } catch (const std::exception& error) {
    stream.rethrow();
    throw Error(path, fmt::format("OpenEXR cannot write it ({})", error.what()), "report this");
  }
  stream.rethrow();
  file.commit();
  return clamped;
}

std::optional<Picture> read_own_exr(const std::string& path) try {
  if (!regular_file_size(path)) return {};
  Imf::setGlobalThreadCount(static_cast<int>(std::thread::hardware_concurrency()));
  Imf::MultiPartInputFile input(path.c_str());
  if (!input.header(0).findTypedAttribute<Imf::StringAttribute>("wavepath.version")) return {};
  const Imath::Box2i window = input.header(0).dataWindow();
  std::vector<StoredChannel> channels;
  for (int part = 0; part < input.parts(); ++part)
    if (!list_own_channels(input.header(part), part, window, channels)) return {};
  const auto rank = [](const StoredChannel& channel) {
    const std::string& name = channel.name;
    return std::pair(name.size() == 1 ? std::string_view("RGBA").find(name) : std::string_view::npos, name);
  };
  std::ranges::sort(channels, {}, rank);
  if (channels.size() < 3 || channels[0].name != "R" || channels[1].name != "G" || channels[2].name != "B") return {};

  Picture picture{size_of(window.min.x, window.max.x), size_of(window.min.y, window.max.y), {}};
  picture.place = *place_of(input.header(0));
  const std::uint64_t pixel_count = std::uint64_t{picture.width} * picture.height;
  if (pixel_count > kMostPixels) return {};
  require_memory(path, "reading it", pixel_count * channels.size() * sizeof(float), "use a smaller picture");
  std::vector<Imf::FrameBuffer> pixels(static_cast<std::size_t>(input.parts()));
  for (const StoredChannel& channel : channels) {
    std::vector<float>& values =
        picture.channels.emplace_back(Channel{channel.name, std::vector<float>(pixel_count)}).values;
    pixels[static_cast<std::size_t>(channel.part)].insert(channel.written,
                                                          Imf::Slice::Make(Imf::FLOAT, values.data(), window));
  }
  for (int part = 0; part < input.parts(); ++part) {
    if (pixels[static_cast<std::size_t>(part)].begin() == pixels[static_cast<std::size_t>(part)].end())
      continue; // sums
    Imf::InputPart stored(input, part);
    stored.setFrameBuffer(pixels[static_cast<std::size_t>(part)]);
    stored.readPixels(window.min.y, window.max.y);
  }
  return picture;
} catch (const Error&) {
  throw;
} catch (const std::bad_alloc&) {
  throw;
} catch (const std::exception&) { // host/codecs says what is wrong
  return {};
}

std::optional<PartWindow> read_window(const std::string& path) {
  return read_header(path, [](const Imf::Header& header) -> std::optional<PartWindow> {
    const Imath::Box2i window = header.dataWindow();
    const std::optional<PicturePlace> place = place_of(header);
    if (!place) return std::nullopt;
    return PartWindow{*place, size_of(window.min.x, window.max.x), size_of(window.min.y, window.max.y)};
  });
}

std::optional<double> read_number(const std::string& path, const std::string& name) {
  return read_header(path, [&](const Imf::Header& header) -> std::optional<double> {
    if (const auto* real = header.findTypedAttribute<Imf::FloatAttribute>(name)) return real->value();
    if (const auto* whole = header.findTypedAttribute<Imf::IntAttribute>(name)) return whole->value();
    return std::nullopt;
  });
}

std::optional<std::array<float, 16>> read_matrix(const std::string& path, const std::string& name) {
  return read_header(path, [&](const Imf::Header& header) -> std::optional<std::array<float, 16>> {
    const auto* matrix = header.findTypedAttribute<Imf::M44fAttribute>(name);
    if (!matrix) return std::nullopt;
    std::array<float, 16> values;
    std::copy_n(matrix->value().getValue(), 16, values.begin());
    return values;
  });
}

std::optional<glm::dvec3> read_vector(const std::string& path, const std::string& name) {
  return read_header(path, [&](const Imf::Header& header) -> std::optional<glm::dvec3> {
    const auto* entry = header.findTypedAttribute<Imf::V3dAttribute>(name);
    return entry ? std::optional(glm::dvec3(entry->value().x, entry->value().y, entry->value().z)) : std::nullopt;
  });
}

std::optional<SequenceFrame> read_frame(const std::string& path) {
  return read_header(path, [](const Imf::Header& header) -> std::optional<SequenceFrame> {
    const auto* number = header.findTypedAttribute<Imf::IntAttribute>(kFrameAttribute);
    if (!number || !Imf::hasFramesPerSecond(header)) return std::nullopt;
    return SequenceFrame{number->value(), static_cast<double>(Imf::framesPerSecond(header))};
  });
}

bool is_lossy(const std::string& path) {
  return read_header(path, [](const Imf::Header& header) {
    const Imf::Compression by = header.compression();
    return by != Imf::NO_COMPRESSION && by != Imf::RLE_COMPRESSION && by != Imf::ZIPS_COMPRESSION &&
           by != Imf::ZIP_COMPRESSION && by != Imf::PIZ_COMPRESSION;
  });
}

std::shared_ptr<const Film> read_film(const std::string& path) try {
  if (!regular_file_size(path)) throw Error(path, "cannot be read", "check the name");
  Imf::MultiPartInputFile file(path.c_str());
  int part = 0;
  while (part < file.parts() && !file.header(part).channels().findChannel(film_channel(0))) ++part;
  if (part == file.parts()) return nullptr;
  const Imf::ChannelList& channels = file.header(part).channels();
  const Imath::Box2i window = file.header(part).dataWindow();
  FilmShape shape{size_of(window.min.x, window.max.x), size_of(window.min.y, window.max.y)};
  const std::optional<PicturePlace> place = place_of(file.header(part));
  if (!place || shape.pixels() > kMostPixels)
    throw Error(path, "holds no film that this version can read", "render it again");
  shape.place = *place;
  shape.aovs = channels.findChannel(film_channel(kPixelWords)) != nullptr;
  shape.splats = channels.findChannel(splat_channel(0)) != nullptr;
  while (shape.groups < gpu::kMostLightGroups &&
         channels.findChannel(group_channel(shape.groups * kReplicateWords)) != nullptr)
    ++shape.groups;
  shape.cover = channels.findChannel(cover_channel(0)) != nullptr;
  shape.has_probes = read_attribute(path, "wavepath.nets") == kWithProbes;
  shape.quads = read_attribute(path, "wavepath.shared") == kQuads;
  if (shape.has_probes) shape.seed = static_cast<std::uint32_t>(read_number(path, "wavepath.seed").value_or(0.0));
  const std::uint64_t spread = shape.has_probes ? sizeof(gpu::FilmPixel) + (shape.aovs ? sizeof(gpu::FilmAovs) : 0) +
                                                      shape.groups * sizeof(gpu::FilmPixel) +
                                                      (shape.cover ? sizeof(gpu::FilmCover) : 0)
                                                : 0;
  require_memory(path, "reading its sums", shape.bytes() + shape.pixels() * spread, "use a smaller picture");
  const auto film = std::make_shared<Film>(make_film(shape));
  for (const std::string& name : film_channels(shape)) {
    const Imf::Channel* channel = channels.findChannel(name);
    if (!channel || channel->type != Imf::UINT)
      throw Error(path, fmt::format("lacks channel {}", name), "render it again");
  }
  Imf::FrameBuffer pixels;
  ProbeSums probes(shape);
  insert_film(pixels, *film, probes, window);
  Imf::InputPart input(file, part);
  input.setFrameBuffer(pixels);
  input.readPixels(window.min.y, window.max.y);
  for_each_probe(*film, [&](std::size_t entry, std::size_t pixel) {
    film->pixels[entry] = probes.pixels[pixel];
    if (!probes.aovs.empty()) film->aovs[entry] = probes.aovs[pixel];
    const auto [there, in_film] = probe_groups(probes, *film, entry, pixel);
    std::ranges::copy(there, in_film.begin());
    if (!probes.cover.empty()) film->cover[entry] = probes.cover[pixel];
  });
  count_light_paths(*film);
  if (!shape.is_part()) return film;
  std::array<std::uint64_t, gpu::kReplicates>& paths = film->light_paths;
  const std::string counts = read_attribute(path, kLightPathsAttribute);
  const bool has_counts = film->splats.empty() || read_counts(counts, paths);
  if (!has_counts || !read_beside(read_attribute(path, kBesideAttribute), *film))
    throw Error(path, "lacks sums of a part of a picture", "render it again");
  return film;
} catch (...) {
  explain_reading(path);
}

std::string read_attribute(const std::string& path, const std::string& name) {
  return read_header(path, [&](const Imf::Header& header) {
    const auto* number = header.findTypedAttribute<Imf::FloatAttribute>(name);
    if (number) return fmt::format("{}", number->value());
    const auto* text = header.findTypedAttribute<Imf::StringAttribute>(name);
    return text ? text->value() : std::string();
  });
}

} // namespace wavepath
