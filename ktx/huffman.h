// Canonical Huffman codes as Deflate has them (RFC 1951, 3.2.2), and the bit stream that carries them in BasisLZ.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace wavepath::ktx {

// Bits of a stream, from the least significant bit of its first byte on. `name` is for messages.
class BitStream {
public:
  BitStream(std::span<const std::uint8_t> data, const char* name) : data_(data), name_(name) {}

  // The next bits, at most 25; those behind the end are 0.
  std::uint32_t peek(unsigned count) const;
  // Passes over bits. Throws FileError behind the end.
  void skip(unsigned count);
  std::uint32_t take(unsigned count);
  const char* name() const { return name_; }

private:
  std::span<const std::uint8_t> data_;
  const char* name_;
  std::uint64_t next_ = 0;
};

// A code, decoded by one look-up of as many bits as its longest word has.
class HuffmanCode {
public:
  HuffmanCode() = default;
  // A length of 0 means that the symbol is not used. Throws FileError if the lengths contradict each other.
  HuffmanCode(std::span<const std::uint8_t> lengths, const char* name);

  // Throws FileError if the next bits are no word of the code.
  std::uint32_t decode(BitStream& stream) const;

private:
  struct Word {
    std::uint16_t symbol = 0;
    std::uint16_t length = 0; // 0: no word of the code
  };
  std::vector<Word> words_; // by the next longest_ bits
  unsigned longest_ = 0;
};

// A code as BasisLZ stores it. Throws FileError.
HuffmanCode read_huffman_code(BitStream& stream);

} // namespace wavepath::ktx
