#include "host/passes/cryptomatte.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host/picture/files/picture_io.h"

namespace wavepath {
namespace {

using Ranked = std::pair<float, double>; // id, coverage

std::string channel_name(const std::string& layer, std::size_t level, bool is_coverage) {
  constexpr const char* kLetters[] = {"R", "G", "B", "A"};
  return fmt::format("{}{:02}.{}", layer, level / 2, kLetters[2 * (level % 2) + (is_coverage ? 1 : 0)]);
}

// The greatest coverage first; equal ones by the bits of their id, so that the order is always the same.
void rank(std::vector<Ranked>& ids) {
  std::ranges::sort(ids, [](const Ranked& a, const Ranked& b) {
    return a.second != b.second ? a.second > b.second
                                : std::bit_cast<std::uint32_t>(a.first) < std::bit_cast<std::uint32_t>(b.first);
  });
}

// `ids_of(pixel)`: what covers it, in any order.
template <class IdsOf>
void add_layers(Picture& picture, const std::string& layer, IdsOf ids_of) {
  const std::size_t first = picture.channels.size(), pixels = std::size_t{picture.width} * picture.height;
  for (std::size_t level = 0; level < kCryptomatteLevels; ++level)
    for (const bool is_coverage : {false, true})
      picture.channels.push_back({channel_name(layer, level, is_coverage), std::vector<float>(pixels)});
  for (std::size_t i = 0; i < pixels; ++i) {
    std::vector<Ranked> ids = ids_of(i);
    rank(ids);
    for (std::size_t level = 0; level < std::min(ids.size(), kCryptomatteLevels); ++level) {
      picture.channels[first + 2 * level].values[i] = ids[level].first;
      picture.channels[first + 2 * level + 1].values[i] = static_cast<float>(ids[level].second);
    }
  }
}

std::string hex(std::uint32_t value) { return fmt::format("{:08x}", value); }

} // namespace

std::uint32_t murmur_hash(std::string_view name) {
  constexpr std::uint32_t kC1 = 0xcc9e2d51u, kC2 = 0x1b873593u;
  std::uint32_t hash = 0;
  const auto byte = [&](std::size_t i) { return std::uint32_t{static_cast<unsigned char>(name[i])}; };
  const auto mixed = [&](std::uint32_t k) { return std::rotl(k * kC1, 15) * kC2; };
  const std::size_t whole = name.size() / 4 * 4;
  for (std::size_t i = 0; i < whole; i += 4) {
    const std::uint32_t block = byte(i) | byte(i + 1) << 8 | byte(i + 2) << 16 | byte(i + 3) << 24;
    hash = std::rotl(hash ^ mixed(block), 13) * 5 + 0xe6546b64u;
  }
  std::uint32_t tail = 0;
  for (std::size_t i = name.size(); i > whole; --i) tail = tail << 8 | byte(i - 1);
  hash ^= mixed(tail);
  hash ^= static_cast<std::uint32_t>(name.size());
  hash = (hash ^ hash >> 16) * 0x85ebca6bu;
  hash = (hash ^ hash >> 13) * 0xc2b2ae35u;
  return hash ^ hash >> 16;
}

float cryptomatte_id(std::string_view name) {
  std::uint32_t bits = murmur_hash(name);
  const std::uint32_t exponent = bits >> 23 & 255u;
  if (exponent == 0 || exponent == 255) bits ^= 1u << 23;
  return std::bit_cast<float>(bits);
}

void add_cryptomatte(Picture& picture, const std::string& layer, const std::vector<SampleCounts>& coverage,
                     const std::vector<std::string>& names, std::uint32_t samples) {
  std::vector<float> ids;
  nlohmann::ordered_json manifest = nlohmann::ordered_json::object();
  for (const std::string& name : names) {
    ids.push_back(cryptomatte_id(name));
    manifest[name] = hex(std::bit_cast<std::uint32_t>(ids.back()));
  }
  add_layers(picture, layer, [&](std::size_t pixel) {
    std::map<float, std::uint32_t> counts; // of names that are equal
    for (const auto& [index, count] : coverage[pixel]) counts[ids[index]] += count;
    std::vector<Ranked> ranked;
    for (const auto& [id, count] : counts) ranked.emplace_back(id, static_cast<double>(count) / samples);
    return ranked;
  });
  const std::string manifest_text = manifest.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  const std::string values[] = {layer, "MurmurHash3_32", "uint32_to_float32", manifest_text};
  const std::vector<std::string> texts = cryptomatte_texts(layer);
  for (std::size_t i = 0; i < texts.size(); ++i) picture.texts.emplace_back(texts[i], values[i]);
}

bool has_cryptomatte(const Picture& picture, const std::string& layer) {
  return find_channel(picture, channel_name(layer, 0, false)) != nullptr;
}

std::vector<std::string> cryptomatte_texts(const std::string& layer) {
  const std::string key = fmt::format("cryptomatte/{}/", hex(murmur_hash(layer)).substr(0, 7));
  return {key + "name", key + "hash", key + "conversion", key + "manifest"};
}

void join_cryptomatte(JoinedCryptomatte& joined, const std::string& layer, const Picture& part, std::uint32_t samples) {
  joined.sums.resize(std::size_t{part.width} * part.height);
  joined.samples += samples;
  for (std::size_t level = 0; level < kCryptomatteLevels; ++level) {
    const std::vector<float>& ids = find_channel(part, channel_name(layer, level, false))->values;
    const std::vector<float>& coverages = find_channel(part, channel_name(layer, level, true))->values;
    for (std::size_t pixel = 0; pixel < joined.sums.size(); ++pixel)
      if (const float coverage = coverages[pixel]; coverage > 0.0f)
        // A whole number of samples, which the float next to its fraction tells.
        joined.sums[pixel][ids[pixel]] += std::round(double{coverage} * samples);
  }
}

void add_cryptomatte(Picture& picture, const std::string& layer, const JoinedCryptomatte& joined) {
  add_layers(picture, layer, [&](std::size_t pixel) {
    std::vector<Ranked> ranked;
    for (const auto& [id, sum] : joined.sums[pixel]) ranked.emplace_back(id, sum / static_cast<double>(joined.samples));
    return ranked;
  });
}

} // namespace wavepath
