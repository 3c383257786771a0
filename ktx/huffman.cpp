#include "ktx/huffman.h"

#include <algorithm>
#include <array>
#include <string>

#include "ktx/bytes.h"
#include "ktx/error.h"

namespace wavepath::ktx {
namespace {

constexpr unsigned kLongestWord = 16;

std::uint32_t reversed(std::uint32_t word, unsigned length) {
  std::uint32_t result = 0;
  for (unsigned i = 0; i < length; ++i) result |= (word >> i & 1) << (length - 1 - i);
  return result;
}

} // namespace

std::uint32_t BitStream::peek(unsigned count) const {
  const auto first = static_cast<std::size_t>(next_ / 8);
  std::uint32_t bits = 0;
  if (first + 4 <= data_.size()) {
    bits = u32_at(&data_[first]);
  } else {
    for (std::size_t i = 0; first + i < data_.size(); ++i) bits |= std::uint32_t{data_[first + i]} << (8 * i);
  }
  return bits >> (next_ % 8) & ((1u << count) - 1);
}

void BitStream::skip(unsigned count) {
  next_ += count;
  if (next_ > std::uint64_t{data_.size()} * 8) fail_damaged(std::string(name_) + " end too soon");
}

std::uint32_t BitStream::take(unsigned count) {
  const std::uint32_t bits = peek(count);
  skip(count);
  return bits;
}

HuffmanCode::HuffmanCode(std::span<const std::uint8_t> lengths, const char* name) {
  std::array<std::uint32_t, kLongestWord + 1> counts{};
  for (const std::uint8_t length : lengths) {
    ++counts[length];
    if (length > 0) longest_ = std::max<unsigned>(longest_, length);
  }
  counts[0] = 0;
  // The first word of each length; more words than a length has room for are no code. Fewer are one: a lone symbol has
  // a word of one bit.
  std::array<std::uint32_t, kLongestWord + 1> next{};
  std::uint32_t word = 0;
  for (unsigned length = 1; length <= longest_; ++length) {
    word = (word + counts[length - 1]) << 1;
    next[length] = word;
    if (word + counts[length] > 1u << length)
      fail_damaged(std::string(name) + " have a Huffman code of too many words of " + std::to_string(length) + " bits");
  }
  words_.resize(longest_ > 0 ? std::size_t{1} << longest_ : 0);
  for (std::size_t symbol = 0; symbol < lengths.size(); ++symbol) {
    const unsigned length = lengths[symbol];
    if (length == 0) continue;
    const Word entry{static_cast<std::uint16_t>(symbol), static_cast<std::uint16_t>(length)};
    for (std::size_t at = reversed(next[length]++, length); at < words_.size(); at += std::size_t{1} << length)
      words_[at] = entry;
  }
}

std::uint32_t HuffmanCode::decode(BitStream& stream) const {
  const Word word = words_.empty() ? Word{} : words_[stream.peek(longest_)];
  if (word.length == 0) fail_damaged(std::string(stream.name()) + " have bits that are no word of their Huffman code");
  stream.skip(word.length);
  return word.symbol;
}

HuffmanCode read_huffman_code(BitStream& stream) {
  constexpr std::array<std::uint8_t, 21> kOrder = {17, 18, 19, 20, 0,  8, 7,  9, 6,  10, 5,
                                                   11, 4,  12, 3,  13, 2, 14, 1, 15, 16};
  constexpr std::uint32_t kShortZeros = 17, kLongZeros = 18, kShortRepeat = 19;
  const std::uint32_t symbols = stream.take(14);
  if (symbols == 0) return {}; // no word is decoded by it
  const std::uint32_t count = stream.take(5);
  if (count < 1 || count > kOrder.size())
    fail_damaged(std::string(stream.name()) + " have a Huffman code of " + std::to_string(count) + " code lengths");
  std::array<std::uint8_t, kOrder.size()> sizes{};
  for (std::uint32_t i = 0; i < count; ++i) sizes[kOrder[i]] = static_cast<std::uint8_t>(stream.take(3));
  const HuffmanCode code(sizes, stream.name());

  std::vector<std::uint8_t> lengths;
  lengths.reserve(symbols);
  while (lengths.size() < symbols) {
    const std::uint32_t symbol = code.decode(stream);
    if (symbol < kShortZeros) {
      lengths.push_back(static_cast<std::uint8_t>(symbol));
      continue;
    }
    std::uint32_t run = 0;
    std::uint8_t length = 0;
    if (symbol == kShortZeros) {
      run = 3 + stream.take(3);
    } else if (symbol == kLongZeros) {
      run = 11 + stream.take(7);
    } else {
      run = symbol == kShortRepeat ? 3 + stream.take(2) : 7 + stream.take(7);
      if (lengths.empty() || lengths.back() == 0)
        fail_damaged(std::string(stream.name()) + " repeat a code length that is not there");
      length = lengths.back();
    }
    if (run > symbols - lengths.size())
      fail_damaged(std::string(stream.name()) + " have a Huffman code of more lengths than symbols");
    lengths.insert(lengths.end(), run, length);
  }
  return {lengths, stream.name()};
}

} // namespace wavepath::ktx
