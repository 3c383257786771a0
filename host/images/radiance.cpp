#include "host/images/radiance.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>

namespace wavepath {
namespace {

using Pixel = std::array<std::uint8_t, 4>; // mantissas of R, G, B; exponent + 128, or 0 if all are 0

constexpr std::string_view kFormat = "FORMAT=32-bit_rle_rgbe";
constexpr std::uint32_t kLeastEncoded = 8, kMostEncoded = 32767; // widths of scanlines in the new encoding
constexpr std::size_t kShortestRun = 4; // shorter ones would cost more than they save, as each ends the literals

[[noreturn]] void fail(const char* words) { throw ImageError(std::string("is damaged or cut short (") + words + ")"); }

// The bytes yet to be read.
class Input {
public:
  explicit Input(std::span<const std::uint8_t> file) : rest_(file) {}

  std::span<const std::uint8_t> take(std::size_t bytes) {
    if (bytes > rest_.size()) fail("the file ends early");
    const std::span<const std::uint8_t> taken = rest_.first(bytes);
    rest_ = rest_.subspan(bytes);
    return taken;
  }
  std::uint8_t byte() { return take(1)[0]; }
  Pixel pixel() {
    const std::span<const std::uint8_t> bytes = take(4);
    return {bytes[0], bytes[1], bytes[2], bytes[3]};
  }
  std::string_view line() {
    const auto end = std::find(rest_.begin(), rest_.end(), '\n');
    const std::span<const std::uint8_t> text = take(static_cast<std::size_t>(end - rest_.begin()));
    take(1);
    const std::string_view line(reinterpret_cast<const char*>(text.data()), text.size());
    return line.ends_with('\r') ? line.substr(0, line.size() - 1) : line;
  }
  // Whether the next scanline, of that width, is in the new encoding.
  bool at_encoded(std::uint32_t width) const {
    return width >= kLeastEncoded && width <= kMostEncoded && rest_.size() >= 4 && rest_[0] == 2 && rest_[1] == 2 &&
           rest_[2] < 128;
  }

private:
  std::span<const std::uint8_t> rest_;
};

// A size from the front of `text`, which then starts behind it; nothing if there is none from 1 to 2^31 - 1.
std::optional<std::uint32_t> take_size(std::string_view& text, std::string_view before) {
  if (!text.starts_with(before)) return std::nullopt;
  text.remove_prefix(before.size());
  std::int32_t size = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), size);
  if (error != std::errc() || size < 1) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return static_cast<std::uint32_t>(size);
}

ImageShape read_header(Input& input) {
  if (!input.line().starts_with("#?")) fail("no Radiance header");
  for (std::string_view line = input.line(); !line.empty(); line = input.line())
    if (line.starts_with("FORMAT=") && line != kFormat)
      throw ImageError("stores other colours than red, green and blue");
  std::string_view line = input.line();
  if (line.starts_with("+Y") || line.starts_with("+X") || line.starts_with("-X") ||
      (line.starts_with("-Y") && line.find("-X") != std::string_view::npos))
    throw ImageError("is stored turned or mirrored, not from the top left corner row by row");
  const std::optional<std::uint32_t> height = take_size(line, "-Y "), width = take_size(line, " +X ");
  if (!height || !width || !line.empty()) fail("no sound size in the header");
  return {*width, *height, 3};
}

// New encoding: the bytes of each channel, in runs and literals.
void read_encoded(Input& input, std::span<Pixel> row) {
  const Pixel start = input.pixel();
  if ((std::size_t{start[2]} << 8 | start[3]) != row.size()) fail("a scanline of another length");
  for (std::size_t c = 0; c < 4; ++c) {
    for (std::size_t x = 0; x < row.size();) {
      const std::uint8_t code = input.byte();
      const bool run = code > 128;
      const std::size_t count = run ? code - 128u : code;
      if (count == 0 || count > row.size() - x) fail("a run beyond the end of its scanline");
      const std::span<const std::uint8_t> values = input.take(run ? 1 : count);
      for (std::size_t i = 0; i < count; ++i) row[x + i][c] = values[run ? 0 : i];
      x += count;
    }
  }
}

// Flat, or the old encoding: a pixel of mantissas 1, which is never normal, repeats the one before it as often as its
// exponent says; several in a row are the digits of the count, the lowest first.
void read_flat(Input& input, std::span<Pixel> row) {
  unsigned shift = 0;
  for (std::size_t x = 0; x < row.size();) {
    const Pixel pixel = input.pixel();
    if (pixel[0] != 1 || pixel[1] != 1 || pixel[2] != 1) {
      row[x++] = pixel;
      shift = 0;
      continue;
    }
    const std::uint64_t count = std::uint64_t{pixel[3]} << shift;
    if (x == 0 || shift > 24 || count > row.size() - x) fail("a run beyond its scanline");
    std::fill_n(row.begin() + static_cast<std::ptrdiff_t>(x), count, row[x - 1]);
    x += count;
    shift += 8;
  }
}

void to_floats(std::span<const Pixel> row, float* rgb) {
  static const std::array<float, 256> kScale = [] {
    std::array<float, 256> scale{}; // exponent 0: black
    for (int e = 1; e < 256; ++e) scale[static_cast<std::size_t>(e)] = std::ldexp(1.0f, e - (128 + 8));
    return scale;
  }();
  for (std::size_t x = 0; x < row.size(); ++x)
    for (std::size_t c = 0; c < 3; ++c) rgb[3 * x + c] = static_cast<float>(row[x][c]) * kScale[row[x][3]];
}

// To nearest: truncation, as in the reference code, would darken pictures by a fifth of a percent on average.
Pixel to_pixel(const float* rgb) {
  int exponent = 0;
  const float mantissa = std::frexp(std::max({rgb[0], rgb[1], rgb[2]}), &exponent);
  if (std::round(256.0f * mantissa) == 256.0f) ++exponent; // rounds up to the next power of two
  if (mantissa <= 0.0f || exponent < -127) return {};
  Pixel pixel{};
  for (std::size_t c = 0; c < 3; ++c)
    pixel[c] = static_cast<std::uint8_t>(std::round(std::ldexp(rgb[c], 8 - exponent)));
  pixel[3] = static_cast<std::uint8_t>(exponent + 128);
  return pixel;
}

void write_encoded(std::span<const Pixel> row, std::vector<std::uint8_t>& out) {
  out.insert(out.end(),
             {2, 2, static_cast<std::uint8_t>(row.size() >> 8), static_cast<std::uint8_t>(row.size() & 255)});
  for (std::size_t c = 0; c < 4; ++c) {
    const auto run_at = [&](std::size_t x) {
      std::size_t end = x + 1;
      while (end < row.size() && end - x < 127 && row[end][c] == row[x][c]) ++end;
      return end - x;
    };
    for (std::size_t x = 0; x < row.size();) {
      std::size_t begin = x, run = 0; // of the next run that is worth it
      while (begin < row.size() && (run = run_at(begin)) < kShortestRun) begin += run;
      while (x < begin) {
        const std::size_t count = std::min<std::size_t>(128, begin - x);
        out.push_back(static_cast<std::uint8_t>(count));
        for (const std::size_t end = x + count; x < end; ++x) out.push_back(row[x][c]);
      }
      if (x == row.size()) break;
      out.insert(out.end(), {static_cast<std::uint8_t>(128 + run), row[x][c]});
      x += run;
    }
  }
}

} // namespace

DecodedImage decode_radiance(std::span<const std::uint8_t> file, const CheckShape& check) {
  Input input(file);
  DecodedImage image;
  image.shape = read_header(input);
  check(image.shape);
  float* out = make_room(image.floats, image.shape);
  std::vector<Pixel> row(image.shape.width);
  for (std::uint32_t y = 0; y < image.shape.height; ++y, out += row.size() * 3) {
    input.at_encoded(image.shape.width) ? read_encoded(input, row) : read_flat(input, row);
    to_floats(row, out);
  }
  return image;
}

std::vector<std::uint8_t> encode_radiance(const DecodedImage& image) {
  const ImageShape& shape = image.shape;
  const std::string header = "#?RADIANCE\nSOFTWARE=wavepath " WAVEPATH_VERSION "\n" + std::string(kFormat) + "\n\n-Y " +
                             std::to_string(shape.height) + " +X " + std::to_string(shape.width) + "\n";
  std::vector<std::uint8_t> out(header.begin(), header.end());
  std::vector<Pixel> row(shape.width);
  const float* rgb = image.floats.data();
  for (std::uint32_t y = 0; y < shape.height; ++y) {
    for (Pixel& pixel : row) pixel = to_pixel(rgb), rgb += 3;
    if (shape.width >= kLeastEncoded && shape.width <= kMostEncoded)
      write_encoded(row, out);
    else
      for (const Pixel& pixel : row) out.insert(out.end(), pixel.begin(), pixel.end());
  }
  return out;
}

} // namespace wavepath
