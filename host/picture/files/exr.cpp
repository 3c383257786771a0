// EXR files by OpenEXR, streamed through AtomicFile: OpenImageIO would hold a file of exact sums in memory as a whole.
// What headers say of a render, its sums and its picture are read the same way; pictures of other programs by
// host/codecs.
#include "host/picture/files/exr.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <new>
#include <string_view>
#include <thread>
#include <utility>

#include <Imath/half.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfMatrixAttribute.h>
#include <OpenEXR/ImfOutputFile.h>
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
#include "host/picture/picture_format.h"
#include "kernels/base/frame_types.h"
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
  const Imath::M44f perspective(sx, 0, 0, 0, 0, sy, 0, 0, 0.5f, 0.5f, 1, 1, 0, 0, -1, 0);
  const Imath::M44f orthographic(sx, 0, 0, 0, 0, sy, 0, 0, 0, 0, 1, 0, 0.5f, 0.5f, 0, 1);
  return world_to_camera(view) * (view.orthographic ? orthographic : perspective);
}

// Channels that --half leaves at 32 bits: half holds all whole numbers only up to 2048, and ends at 65504, which
// distances and positions may exceed; the depth of a miss always does.
bool needs_float(const std::string& name) {
  return name == "samples" || name == "Z" || name == "Z0" || name.starts_with("P.") || name.starts_with("P0.") ||
         name.starts_with("id.") || name.starts_with("Crypto");
}

Imath::M44f to_matrix(const std::array<float, 16>& values) {
  Imath::M44f m;
  std::copy(values.begin(), values.end(), m.getValue());
  return m;
}

// The words of a film, one channel each: kReplicates times FilmPixel, then FilmAovs and kReplicates times SplatPixel if
// there are any, then FilmAovs of error probes. Probes are stored where the probed pixels are; other pixels have zeros
// in these channels, which take next to no space in a compressed file.
constexpr std::size_t kReplicateWords = sizeof(gpu::FilmPixel) / 4, kPixelWords = gpu::kReplicates * kReplicateWords,
                      kAovWords = sizeof(gpu::FilmAovs) / 4, kSplatWords = gpu::kReplicates * gpu::kSplatWords;
constexpr const char* kWithProbes = "whole"; // value of the attribute wavepath.nets
constexpr const char* kQuads = "quads";      // of wavepath.shared: pixels that share samples

std::string film_channel(std::size_t word) { return fmt::format("{}{:02}", kFilmPrefix, word); }
std::string splat_channel(std::size_t word) { return fmt::format("{}splat.{:02}", kFilmPrefix, word); }
std::string probe_channel(std::size_t word) { return fmt::format("{}second.{:02}", kFilmPrefix, word); }
std::vector<std::string> film_channels(const FilmShape& film) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < kPixelWords + (film.aovs ? kAovWords : 0); ++i) names.push_back(film_channel(i));
  for (std::size_t i = 0; i < (film.splats ? kSplatWords : 0); ++i) names.push_back(splat_channel(i));
  for (std::size_t i = 0; i < (film.aovs && film.has_probes ? kAovWords : 0); ++i) names.push_back(probe_channel(i));
  return names;
}

// The sums of error probes, stored where the probed pixels are.
struct ProbeSums {
  explicit ProbeSums(const FilmShape& film)
      : pixels(film.has_probes ? film.pixels() : 0), aovs(film.has_probes && film.aovs ? film.pixels() : 0) {}
  std::vector<gpu::FilmPixel> pixels;
  std::vector<gpu::FilmAovs> aovs;
};

// Calls body(entry of the film, pixel) for every error probe.
template <class Body>
void for_each_probe(const Film& film, Body body) {
  const FilmShape shape = film.shape();
  for (std::size_t block = 0; block < shape.probe_count(); ++block)
    body(shape.pixels() + block, probed_pixel(film, block));
}

// Points OpenEXR at the words where they lie, for reading and writing alike.
void insert_film(Imf::FrameBuffer& pixels, Film& film, ProbeSums& probes) {
  const auto insert = [&](const std::string& channel, void* first, std::size_t words) {
    const std::size_t stride = 4 * words;
    pixels.insert(channel, Imf::Slice(Imf::UINT, static_cast<char*>(first), stride, stride * film.width));
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
  for (std::size_t i = 0; i < (film.splats.empty() ? 0 : kSplatWords); ++i)
    insert(splat_channel(i), words_of(film.splats) + i, kSplatWords);
}

Imf::Header make_header(const Picture& picture, const PictureInfo& info, bool half) {
  Imf::Header header(static_cast<int>(picture.width), static_cast<int>(picture.height));
  header.compression() = Imf::ZIP_COMPRESSION;
  const std::array<float, 8>& c = kRec709;
  Imf::addChromaticities(header, {{c[0], c[1]}, {c[2], c[3]}, {c[4], c[5]}, {c[6], c[7]}});
  for (const Channel& channel : picture.channels)
    header.channels().insert(channel.name, Imf::Channel(half && !needs_float(channel.name) ? Imf::HALF : Imf::FLOAT));

  const auto add_text = [&](const char* name, const std::string& text) {
    header.insert(name, Imf::StringAttribute(text));
  };
  header.insert("wavepath.spp", Imf::IntAttribute(static_cast<int>(info.spp)));
  header.insert("wavepath.seconds", Imf::FloatAttribute(static_cast<float>(info.seconds)));
  if (info.error) header.insert("wavepath.error", Imf::FloatAttribute(static_cast<float>(*info.error)));
  header.insert("wavepath.seed", Imf::IntAttribute(static_cast<int>(info.seed)));
  add_text("wavepath.samples", info.samples);
  add_text("wavepath.scene", info.scene);
  add_text("wavepath.command", info.command);
  add_text("wavepath.filter", info.filter);
  add_text("wavepath.bias", info.bias);
  if (!info.plan.empty()) add_text("wavepath.plan", info.plan);
  if (!info.repeat.empty()) add_text("wavepath.repeat", info.repeat);
  add_text("wavepath.version", WAVEPATH_VERSION);
  if (info.film) {
    add_text("wavepath.identity", info.identity);
    add_text("wavepath.device", info.device);
    header.insert("wavepath.origin", Imf::V3dAttribute({info.origin.x, info.origin.y, info.origin.z}));
    if (info.film->has_probes) add_text("wavepath.nets", kWithProbes);
    if (info.film->quads) add_text("wavepath.shared", kQuads);
    for (const std::string& channel : film_channels(info.film->shape()))
      header.channels().insert(channel, Imf::Channel(Imf::UINT));
  }
  for (const auto& [name, text] : picture.texts) add_text(name.c_str(), text);
  header.insert("samplesPerPixel", Imf::IntAttribute(static_cast<int>(info.spp)));
  header.insert("renderTimeSeconds", Imf::FloatAttribute(static_cast<float>(info.seconds)));
  if (info.view) {
    header.insert("worldToCamera", Imf::M44fAttribute(world_to_camera(*info.view)));
    header.insert("worldToNDC", Imf::M44fAttribute(world_to_ndc(*info.view)));
  }
  if (info.world_to_camera) header.insert("worldToCamera", Imf::M44fAttribute(to_matrix(*info.world_to_camera)));
  if (info.world_to_ndc) header.insert("worldToNDC", Imf::M44fAttribute(to_matrix(*info.world_to_ndc)));
  return header;
}

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

// Result of `read` on the header of an EXR; empty if the file is none, because reading the picture itself reports that.
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

std::uint64_t write_exr(const std::string& path, const Picture& picture, const PictureInfo& info, bool half) {
  Imf::setGlobalThreadCount(static_cast<int>(std::thread::hardware_concurrency()));
  std::uint64_t clamped = 0;
  std::vector<std::vector<Imath::half>> halves;
  if (half) halves = to_half(picture, clamped);

  const Imf::Header header = make_header(picture, info, half);
  Imf::FrameBuffer pixels;
  for (std::size_t i = 0; i < picture.channels.size(); ++i) {
    const Channel& channel = picture.channels[i];
    const bool as_half = header.channels()[channel.name].type == Imf::HALF;
    const void* values = as_half ? static_cast<const void*>(halves[i].data()) : channel.values.data();
    const std::size_t size = as_half ? sizeof(Imath::half) : sizeof(float);
    // OpenEXR takes a pointer to non-const for reading and writing alike.
    pixels.insert(channel.name, Imf::Slice(as_half ? Imf::HALF : Imf::FLOAT,
                                           static_cast<char*>(const_cast<void*>(values)), size, size * picture.width));
  }
  ProbeSums probes(info.film ? info.film->shape() : FilmShape{});
  if (info.film) {
    for_each_probe(*info.film, [&](std::size_t entry, std::size_t pixel) {
      probes.pixels[pixel] = info.film->pixels[entry];
      if (!probes.aovs.empty()) probes.aovs[pixel] = info.film->aovs[entry];
    });
    insert_film(pixels, const_cast<Film&>(*info.film), probes);
  }

  AtomicFile file(path);
  Stream stream(file, path);
  try {
    Imf::OutputFile output(stream, header);
    output.setFrameBuffer(pixels);
    output.writePixels(static_cast<int>(picture.height));
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
  Imf::InputFile input(path.c_str());
  const Imf::Header& header = input.header();
  const Imath::Box2i window = header.dataWindow();
  // Only parts of a file with several parts have names.
  const bool whole = window == header.displayWindow() && window.min == Imath::V2i(0, 0) && !header.hasName();
  if (!whole || !header.findTypedAttribute<Imf::StringAttribute>("wavepath.version")) return {};
  if (Imf::hasChromaticities(header)) {
    const Imf::Chromaticities c = Imf::chromaticities(header);
    if (!is_rec709({c.red.x, c.red.y, c.green.x, c.green.y, c.blue.x, c.blue.y, c.white.x, c.white.y})) return {};
  }

  std::vector<std::string> names;
  for (auto channel = header.channels().begin(); channel != header.channels().end(); ++channel) {
    if (std::string_view(channel.name()).starts_with(kFilmPrefix)) continue;
    if (channel.channel().xSampling != 1 || channel.channel().ySampling != 1) return {};
    names.emplace_back(channel.name());
  }
  const auto rank = [](const std::string& name) {
    return std::pair(name.size() == 1 ? std::string_view("RGBA").find(name) : std::string_view::npos, name);
  };
  std::ranges::sort(names, {}, rank);
  if (names.size() < 3 || names[0] != "R" || names[1] != "G" || names[2] != "B") return {};

  Picture picture{static_cast<std::uint32_t>(window.max.x) + 1, static_cast<std::uint32_t>(window.max.y) + 1, {}};
  const std::uint64_t pixel_count = std::uint64_t{picture.width} * picture.height;
  if (pixel_count > kMostPixels) return {};
  require_memory(path, "reading it", pixel_count * names.size() * sizeof(float), "use a smaller picture");
  Imf::FrameBuffer pixels;
  for (const std::string& name : names) {
    std::vector<float>& values = picture.channels.emplace_back(Channel{name, std::vector<float>(pixel_count)}).values;
    pixels.insert(name, Imf::Slice::Make(Imf::FLOAT, values.data(), window));
  }
  input.setFrameBuffer(pixels);
  input.readPixels(window.min.y, window.max.y);
  return picture;
} catch (const Error&) {
  throw;
} catch (const std::bad_alloc&) {
  throw;
} catch (const std::exception&) { // host/codecs says what is wrong
  return {};
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

std::shared_ptr<const Film> read_film(const std::string& path) try {
  if (!regular_file_size(path)) throw Error(path, "cannot be read", "check the name");
  Imf::InputFile input(path.c_str());
  const Imf::ChannelList& channels = input.header().channels();
  if (!channels.findChannel(film_channel(0))) return nullptr;
  const Imath::Box2i window = input.header().dataWindow();
  FilmShape shape{static_cast<std::uint32_t>(window.max.x + 1), static_cast<std::uint32_t>(window.max.y + 1)};
  if (window.min.x != 0 || window.min.y != 0 || shape.pixels() > kMostPixels)
    throw Error(path, "holds no film that this version can read", "render it again");
  shape.aovs = channels.findChannel(film_channel(kPixelWords)) != nullptr;
  shape.splats = channels.findChannel(splat_channel(0)) != nullptr;
  shape.has_probes = read_attribute(path, "wavepath.nets") == kWithProbes;
  shape.quads = read_attribute(path, "wavepath.shared") == kQuads;
  if (shape.has_probes) shape.seed = static_cast<std::uint32_t>(read_number(path, "wavepath.seed").value_or(0.0));
  const std::uint64_t spread = shape.has_probes ? sizeof(gpu::FilmPixel) + (shape.aovs ? sizeof(gpu::FilmAovs) : 0) : 0;
  require_memory(path, "reading its sums", shape.bytes() + shape.pixels() * spread, "use a smaller picture");
  const auto film = std::make_shared<Film>(make_film(shape));
  for (const std::string& name : film_channels(shape)) {
    const Imf::Channel* channel = channels.findChannel(name);
    if (!channel || channel->type != Imf::UINT)
      throw Error(path, fmt::format("lacks channel {}", name), "render it again");
  }
  Imf::FrameBuffer pixels;
  ProbeSums probes(shape);
  insert_film(pixels, *film, probes);
  input.setFrameBuffer(pixels);
  input.readPixels(window.min.y, window.max.y);
  for_each_probe(*film, [&](std::size_t entry, std::size_t pixel) {
    film->pixels[entry] = probes.pixels[pixel];
    if (!probes.aovs.empty()) film->aovs[entry] = probes.aovs[pixel];
  });
  count_light_paths(*film);
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
