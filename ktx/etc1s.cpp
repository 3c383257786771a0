#include "ktx/etc1s.h"

#include <algorithm>
#include <string>

#include "ktx/block_bits.h"
#include "ktx/error.h"
#include "ktx/etc1.h"
#include "ktx/huffman.h"

namespace wavepath::ktx {
namespace {

using Bytes = std::span<const std::uint8_t>;

struct Endpoint {
  std::uint8_t table = 0;
  std::array<std::uint8_t, 3> color{}; // 5 bits each
};

// 16 values of 2 bits: row y from byte y, column x from its bits 2 x.
using Selector = std::array<std::uint8_t, 4>;

struct Codebooks {
  std::vector<Endpoint> endpoints;
  std::vector<Selector> selectors;
  HuffmanCode endpoint_prediction, endpoint_delta, selector, selector_run;
  std::uint32_t history_size = 0;
};

struct Slice {
  Bytes data;
  bool present = false;
};

struct GlobalData {
  std::uint32_t endpoint_count = 0, selector_count = 0;
  Bytes endpoints, selectors, tables;
  Slice color, alpha; // of level 0
};

GlobalData read_global_data(const Container& container) {
  constexpr std::size_t kFixedLength = 20, kImageLength = 20;
  constexpr std::uint32_t kPredicted = 2;
  const Bytes data = container.global;
  const std::size_t images = std::max(container.level_count, 1u);
  if (data.size() < kFixedLength + images * kImageLength) fail_damaged("the global data of BasisLZ are too short");
  const std::uint64_t lengths[3] = {u32_at(&data[4]), u32_at(&data[8]), u32_at(&data[12])};
  const std::uint64_t first = kFixedLength + images * kImageLength;
  if (first + lengths[0] + lengths[1] + lengths[2] + u32_at(&data[16]) != data.size())
    fail_damaged("the global data of BasisLZ have another length than their parts");
  GlobalData global;
  global.endpoint_count = u16_at(&data[0]);
  global.selector_count = u16_at(&data[2]);
  Bytes rest = data.subspan(static_cast<std::size_t>(first));
  for (Bytes* part : {&global.endpoints, &global.selectors, &global.tables}) {
    *part = rest.first(static_cast<std::size_t>(lengths[part == &global.endpoints   ? 0
                                                        : part == &global.selectors ? 1
                                                                                    : 2]));
    rest = rest.subspan(part->size());
  }
  const std::uint8_t* image = &data[kFixedLength]; // level 0 is the first one
  if (u32_at(image) & kPredicted) throw FileError("is a frame of an animation that needs the frame before it");
  const auto slice = [&](std::size_t at, const char* name) {
    const std::uint64_t offset = u32_at(image + at), length = u32_at(image + at + 4);
    if (offset + length > container.level.size())
      fail_damaged(std::string("the ") + name + " slice lies beyond its level");
    return Slice{container.level.subspan(static_cast<std::size_t>(offset), static_cast<std::size_t>(length)),
                 length > 0};
  };
  global.color = slice(4, "colour");
  global.alpha = slice(12, "second");
  if (!global.color.present) fail_damaged("the colour slice is empty");
  return global;
}

std::vector<Endpoint> read_endpoints(const GlobalData& global) {
  BitStream stream(global.endpoints, "the endpoints of BasisLZ");
  const HuffmanCode delta[3] = {read_huffman_code(stream), read_huffman_code(stream), read_huffman_code(stream)};
  const HuffmanCode table_delta = read_huffman_code(stream);
  const bool grey = stream.take(1) != 0;
  std::vector<Endpoint> endpoints(global.endpoint_count);
  Endpoint last{0, {16, 16, 16}};
  for (Endpoint& endpoint : endpoints) {
    last.table = static_cast<std::uint8_t>((last.table + table_delta.decode(stream)) & 7);
    for (std::size_t c = 0; c < (grey ? 1u : 3u); ++c) {
      const std::uint8_t before = last.color[c];
      const HuffmanCode& code = delta[before <= 9 ? 0 : before <= 21 ? 1 : 2];
      last.color[c] = static_cast<std::uint8_t>((before + code.decode(stream)) & 31);
    }
    if (grey) last.color[1] = last.color[2] = last.color[0];
    endpoint = last;
  }
  return endpoints;
}

std::vector<Selector> read_selectors(const GlobalData& global) {
  BitStream stream(global.selectors, "the selectors of BasisLZ");
  if (stream.take(2) != 0) fail_damaged("the selectors of BasisLZ begin with reserved bits");
  const bool raw = stream.take(1) != 0;
  HuffmanCode delta;
  if (!raw) delta = read_huffman_code(stream);
  std::vector<Selector> selectors(global.selector_count);
  for (std::size_t i = 0; i < selectors.size(); ++i)
    for (std::size_t row = 0; row < 4; ++row)
      selectors[i][row] =
          static_cast<std::uint8_t>(raw || i == 0 ? stream.take(8) : delta.decode(stream) ^ selectors[i - 1][row]);
  return selectors;
}

Codebooks read_codebooks(const GlobalData& global) {
  Codebooks books;
  books.endpoints = read_endpoints(global);
  books.selectors = read_selectors(global);
  BitStream stream(global.tables, "the tables of BasisLZ");
  books.endpoint_prediction = read_huffman_code(stream);
  books.endpoint_delta = read_huffman_code(stream);
  books.selector = read_huffman_code(stream);
  books.selector_run = read_huffman_code(stream);
  books.history_size = stream.take(13);
  return books;
}

// The selectors used last, roughly in the order of use: a use moves one halfway to the front.
class SelectorHistory {
public:
  explicit SelectorHistory(std::size_t size) : values_(size), next_(size / 2) {}

  void add(std::uint32_t value) {
    if (values_.empty()) return;
    values_[next_] = value;
    if (++next_ == values_.size()) next_ = values_.size() / 2;
  }

  std::uint32_t use(std::size_t index) {
    if (index >= values_.size()) fail_damaged("a slice refers to a selector that its history does not have");
    const std::uint32_t value = values_[index];
    std::swap(values_[index], values_[index / 2]);
    return value;
  }

private:
  std::vector<std::uint32_t> values_;
  std::size_t next_;
};

// Chunks of bits, the highest of which says that another one follows.
std::uint32_t take_variable(BitStream& stream, unsigned chunk) {
  std::uint32_t value = 0;
  for (unsigned shift = 0; shift < 32; shift += chunk) {
    const std::uint32_t bits = stream.take(chunk + 1);
    value |= (bits & ((1u << chunk) - 1)) << shift;
    if (bits >> chunk == 0) return value;
  }
  fail_damaged("a slice has a run whose length has no end");
}

// The index of the endpoint of each block is that of a neighbour, or a difference to the last one. Two bits say which;
// those of 2 x 2 blocks are one symbol, which is read with the upper left block.
class EndpointIndices {
public:
  EndpointIndices(const Codebooks& books, std::uint32_t blocks_x)
      : books_(books), above_(blocks_x), row_(blocks_x), lower_((blocks_x + 1) / 2) {}

  void begin_row(std::uint32_t y) {
    y_ = y;
    std::swap(above_, row_);
  }

  std::uint32_t next(BitStream& stream, std::uint32_t x) {
    if (x % 2 == 0) {
      if (y_ % 2 == 0) {
        bits_ = next_symbol(stream);
        lower_[x / 2] = static_cast<std::uint8_t>(bits_ >> 4);
      } else {
        bits_ = lower_[x / 2];
      }
    }
    const std::uint32_t from = bits_ & 3;
    bits_ >>= 2;
    if ((from == 0 && x == 0) || (from == 1 && y_ == 0) || (from == 2 && (x == 0 || y_ == 0)))
      fail_damaged("a slice refers to a block outside the picture");
    if (from == 1) last_ = above_[x];
    if (from == 2) last_ = above_[x - 1];
    if (from == 3) {
      last_ += books_.endpoint_delta.decode(stream);
      if (last_ >= books_.endpoints.size()) last_ -= static_cast<std::uint32_t>(books_.endpoints.size());
    }
    if (last_ >= books_.endpoints.size()) fail_damaged("a slice refers to an endpoint that is not there");
    return row_[x] = last_;
  }

private:
  std::uint32_t next_symbol(BitStream& stream) {
    constexpr std::uint32_t kRepeat = 256, kShortestRepeat = 3;
    if (repeats_ > 0) {
      --repeats_;
      return symbol_;
    }
    const std::uint32_t symbol = books_.endpoint_prediction.decode(stream);
    if (symbol > kRepeat) fail_damaged("a slice has an unknown prediction");
    if (symbol == kRepeat)
      repeats_ = std::uint64_t{take_variable(stream, 4)} + kShortestRepeat - 1;
    else
      symbol_ = symbol;
    return symbol_;
  }

  const Codebooks& books_;
  std::vector<std::uint32_t> above_, row_;
  std::vector<std::uint8_t> lower_; // symbols of the row below, by pairs of blocks
  std::uint32_t y_ = 0, bits_ = 0, symbol_ = 0, last_ = 0;
  std::uint64_t repeats_ = 0;
};

class SelectorIndices {
public:
  explicit SelectorIndices(const Codebooks& books) : books_(books), history_(books.history_size) {}

  std::uint32_t next(BitStream& stream) {
    constexpr std::uint32_t kLongRun = 63, kShortestRun = 3;
    const auto count = static_cast<std::uint32_t>(books_.selectors.size());
    std::uint32_t symbol = count; // the first of the history
    if (run_ > 0) {
      --run_;
    } else {
      symbol = books_.selector.decode(stream);
      if (symbol == count + books_.history_size) {
        const std::uint32_t run = books_.selector_run.decode(stream);
        run_ = std::uint64_t{run == kLongRun ? take_variable(stream, 7) : run} + kShortestRun - 1;
        symbol = count;
      }
    }
    if (symbol >= count) return history_.use(symbol - count);
    history_.add(symbol);
    return symbol;
  }

private:
  const Codebooks& books_;
  SelectorHistory history_;
  std::uint64_t run_ = 0;
};

// Where a slice writes its block of colours.
enum class Target : std::uint8_t { color, red, green, alpha };

struct Canvas {
  std::uint32_t width, height;
  std::uint8_t* rgba;
};

void write_block(const Canvas& canvas, std::uint32_t bx, std::uint32_t by, const Endpoint& endpoint,
                 const Selector& selector, Target target) {
  std::array<std::array<std::uint8_t, 3>, 4> colors{};
  for (std::size_t s = 0; s < 4; ++s)
    for (std::size_t c = 0; c < 3; ++c)
      colors[s][c] = clamp_to_byte(widen5(endpoint.color[c]) + kEtc1Modifiers[endpoint.table][s]);
  const std::uint32_t rows = std::min(4u, canvas.height - 4 * by), columns = std::min(4u, canvas.width - 4 * bx);
  for (std::uint32_t y = 0; y < rows; ++y) {
    std::uint8_t* out = canvas.rgba + (std::size_t{4 * by + y} * canvas.width + std::size_t{4 * bx}) * 4;
    for (std::uint32_t x = 0; x < columns; ++x, out += 4) {
      const std::array<std::uint8_t, 3>& color = colors[selector[y] >> (2 * x) & 3];
      switch (target) {
        case Target::color:
          std::copy(color.begin(), color.end(), out);
          out[3] = 255;
          break;
        case Target::red:
          out[0] = color[0];
          out[1] = out[2] = 0;
          out[3] = 255;
          break;
        case Target::green:
          out[1] = color[1];
          break;
        case Target::alpha:
          out[3] = color[1];
          break;
      }
    }
  }
}

void decode_slice(const Canvas& canvas, Bytes data, const Codebooks& books, Target target) {
  BitStream stream(data, "the slices of BasisLZ");
  const std::uint32_t blocks_x = (canvas.width + 3) / 4, blocks_y = (canvas.height + 3) / 4;
  EndpointIndices endpoints(books, blocks_x);
  SelectorIndices selectors(books);
  for (std::uint32_t y = 0; y < blocks_y; ++y) {
    endpoints.begin_row(y);
    for (std::uint32_t x = 0; x < blocks_x; ++x) {
      const std::uint32_t endpoint = endpoints.next(stream, x);
      const std::uint32_t selector = selectors.next(stream);
      if (selector >= books.selectors.size()) fail_damaged("a slice refers to a selector that is not there");
      write_block(canvas, x, y, books.endpoints[endpoint], books.selectors[selector], target);
    }
  }
}

} // namespace

void decode_etc1s(const Container& container, std::uint8_t* rgba) {
  constexpr std::uint8_t kRed = 3, kGreen = 4;
  const GlobalData global = read_global_data(container);
  const Codebooks books = read_codebooks(global);
  const Canvas canvas{container.width, container.height, rgba};
  const std::vector<std::uint8_t>& channels = container.channels;
  const bool red = !channels.empty() && channels[0] == kRed, two = channels.size() > 1;
  decode_slice(canvas, global.color.data, books, red && two ? Target::red : Target::color);
  if (!two) return;
  if (!global.alpha.present) fail_damaged("the second slice is empty");
  decode_slice(canvas, global.alpha.data, books, channels[1] == kGreen ? Target::green : Target::alpha);
}

} // namespace wavepath::ktx
