// Builds small KTX2 files and blocks for tests, field by field as the specifications list them.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <span>
#include <string>
#include <vector>

#include "ktx/error.h"
#include "ktx/read.h"

namespace wavepath::test {

using Bytes = std::vector<std::uint8_t>;

inline void put(Bytes& bytes, std::uint64_t value, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) bytes.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
}

// Bits from the least significant of the first byte on.
struct BitWriter {
  Bytes bytes;
  std::size_t next = 0;

  void set(std::size_t first, std::size_t count, std::uint64_t value) {
    for (std::size_t i = 0; i < count; ++i) {
      if ((first + i) / 8 >= bytes.size()) bytes.resize((first + i) / 8 + 1);
      if (i < 64 && (value >> i & 1)) bytes[(first + i) / 8] |= static_cast<std::uint8_t>(1u << ((first + i) % 8));
    }
  }
  void add(std::uint64_t value, std::size_t count) {
    set(next, count, value);
    next += count;
  }
};

// A block of 16 bytes. Fields: first bit, number of bits, value.
struct Field {
  std::size_t first, count;
  std::uint64_t value;
};

inline Bytes block_of(std::initializer_list<Field> fields) {
  BitWriter writer;
  writer.bytes.resize(16);
  for (const Field& field : fields) writer.set(field.first, field.count, field.value);
  return writer.bytes;
}

struct KtxFile {
  std::uint32_t vk_format = 37, width = 1, height = 1, depth = 0, layers = 0, faces = 1, levels = 1, scheme = 0;
  std::uint8_t model = 1, transfer = 1, flags = 0;
  std::vector<std::uint8_t> channels = {0};
  Bytes level = {1, 2, 3, 4};
  std::uint64_t uncompressed = ~std::uint64_t{0}; // as many bytes as the level has
  Bytes global, metadata;

  Bytes bytes() const {
    Bytes file = {0xab, 'K', 'T', 'X', ' ', '2', '0', 0xbb, '\r', '\n', 0x1a, '\n'};
    for (const std::uint32_t word : {vk_format, 1u, width, height, depth, layers, faces, levels, scheme})
      put(file, word, 4);
    const std::uint32_t index_length = 24 * std::max(levels, 1u);
    const auto descriptor_length = static_cast<std::uint32_t>(28 + 16 * channels.size());
    const std::uint32_t descriptor = 80 + index_length, data = descriptor + descriptor_length;
    const auto metadata_length = static_cast<std::uint32_t>(metadata.size());
    put(file, descriptor, 4);
    put(file, descriptor_length, 4);
    put(file, metadata.empty() ? 0 : data, 4);
    put(file, metadata_length, 4);
    put(file, global.empty() ? 0 : data + metadata_length, 8);
    put(file, global.size(), 8);
    for (std::uint32_t i = 0; i < std::max(levels, 1u); ++i) {
      put(file, data + metadata_length + global.size(), 8);
      put(file, level.size(), 8);
      put(file, uncompressed == ~std::uint64_t{0} ? level.size() : uncompressed, 8);
    }
    put(file, descriptor_length, 4);
    put(file, 0, 4);
    put(file, 2, 2);
    put(file, descriptor_length - 4, 2);
    for (const std::uint8_t byte : {model, std::uint8_t{1}, transfer, flags}) file.push_back(byte);
    file.resize(file.size() + 12);
    for (const std::uint8_t channel : channels) {
      put(file, 0, 3);
      file.push_back(channel);
      file.resize(file.size() + 12);
    }
    for (const Bytes* part : {&metadata, &global, &level}) file.insert(file.end(), part->begin(), part->end());
    return file;
  }
};

inline ktx::Picture read_ktx(const Bytes& file) {
  return ktx::read(file, [](std::uint32_t, std::uint32_t) {});
}

// Why a file is refused, or "was accepted".
inline std::string ktx_refusal(const Bytes& file) {
  try {
    read_ktx(file);
  } catch (const ktx::FileError& error) {
    return error.what();
  }
  return "was accepted";
}

// Huffman codes as BasisLZ stores them: every symbol of the code of lengths has a word of 5 bits.
inline void add_code(BitWriter& writer, const Bytes& lengths) {
  writer.add(lengths.size(), 14);
  writer.add(21, 5);
  for (int i = 0; i < 21; ++i) writer.add(5, 3);
  for (const std::uint8_t length : lengths)
    for (int bit = 4; bit >= 0; --bit) writer.add(length >> bit & 1, 1);
}

// A symbol of a code: its word with the most significant bit first.
inline void add_word(BitWriter& writer, const Bytes& lengths, std::size_t symbol) {
  std::uint32_t word = 0;
  for (unsigned length = 1; length <= 16; ++length, word <<= 1) {
    for (std::size_t s = 0; s < lengths.size(); ++s) {
      if (lengths[s] != length) continue;
      if (s == symbol) {
        for (int bit = static_cast<int>(length) - 1; bit >= 0; --bit) writer.add(word >> bit & 1, 1);
        return;
      }
      ++word;
    }
  }
}

// A picture of 4 x 4 blocks of ETC1S: two endpoints, two selectors. The first block is stored; the others are given as
// their prediction (0 left, 1 above, 2 above left, 3 a difference to the last endpoint).
struct Etc1sFile {
  std::uint32_t width = 8, height = 8;
  std::uint32_t first_prediction = 3;   // of the four blocks, 2 bits each
  std::vector<std::uint32_t> deltas;    // of blocks of prediction 3
  std::vector<std::uint32_t> selectors; // symbols: 0, 1; 2 and 3 are the history's; 4 is a run
  std::uint32_t run = 0;                // symbol of its length
  bool has_alpha = false;
  std::uint16_t endpoint_count = 2, selector_count = 2;

  KtxFile file() const {
    const Bytes two = {1, 1}, many(257, 9), few(5, 3), runs(64, 6);
    BitWriter endpoints;
    Bytes deltas5(32, 5), tables(8, 3);
    for (int i = 0; i < 3; ++i) add_code(endpoints, deltas5);
    add_code(endpoints, tables);
    endpoints.add(0, 1);
    add_word(endpoints, tables, 1);                                                     // 0 + 1: table 1
    for (const std::size_t delta : {15u, 16u, 0u}) add_word(endpoints, deltas5, delta); // 16 + delta: 31, 0, 16
    add_word(endpoints, tables, 7);                                                     // 1 + 7: table 0
    for (const std::size_t delta : {0u, 1u, 31u}) add_word(endpoints, deltas5, delta);  // 31, 1, 15

    BitWriter selectors_data;
    selectors_data.add(0, 2);
    selectors_data.add(1, 1); // raw
    for (const std::uint32_t row : {0xe4, 0xe4, 0xe4, 0xe4, 0xff, 0xaa, 0x55, 0x00}) selectors_data.add(row, 8);

    BitWriter codes;
    add_code(codes, many);
    add_code(codes, two);
    add_code(codes, few);
    add_code(codes, runs);
    codes.add(2, 13);

    BitWriter slice;
    add_word(slice, many, first_prediction);
    std::size_t next_delta = 0, next_selector = 0;
    for (unsigned block = 0; block < 4; ++block) {
      if ((first_prediction >> (2 * block) & 3) == 3 && next_delta < deltas.size())
        add_word(slice, two, deltas[next_delta++]);
      if (next_selector >= selectors.size()) continue;
      const std::uint32_t symbol = selectors[next_selector++];
      add_word(slice, few, symbol);
      if (symbol == 4) add_word(slice, runs, run);
    }

    KtxFile ktx;
    ktx.vk_format = 0;
    ktx.width = width;
    ktx.height = height;
    ktx.scheme = 1;
    ktx.model = 163;
    ktx.uncompressed = 0;
    ktx.level = slice.bytes;
    if (has_alpha) ktx.channels = {0, 15};
    put(ktx.global, endpoint_count, 2);
    put(ktx.global, selector_count, 2);
    for (const Bytes* part : {&endpoints.bytes, &selectors_data.bytes, &codes.bytes}) put(ktx.global, part->size(), 4);
    put(ktx.global, 0, 4);
    put(ktx.global, 0, 4); // image flags
    put(ktx.global, 0, 4);
    put(ktx.global, slice.bytes.size(), 4);
    put(ktx.global, 0, 4);
    put(ktx.global, has_alpha ? slice.bytes.size() : 0, 4);
    for (const Bytes* part : {&endpoints.bytes, &selectors_data.bytes, &codes.bytes})
      ktx.global.insert(ktx.global.end(), part->begin(), part->end());
    return ktx;
  }
};

} // namespace wavepath::test
