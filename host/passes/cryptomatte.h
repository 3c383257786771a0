// Cryptomatte, after its specification (Friedman and Jones, "Fully automatic ID mattes with support for motion blur and
// transparency", SIGGRAPH 2015; version 1.2.0 of the specification by Psyop): for every pixel the ids of what its
// samples see, with the fraction of the samples that see each.
//
//     channels CryptoObject00.R G B A    id, coverage, id, coverage: the two that cover most of the pixel
//              CryptoObject01.R G B A    the next two, ... up to kCryptomatteLevels in all
//
// An id is the hash of a name, as a float of the same bits. What no sample hits has none: coverages sum to 1 less the
// fraction of samples that left the scene.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "host/picture/picture.h"

namespace wavepath {

inline constexpr std::size_t kCryptomatteLevels = 6; // ids a pixel

// MurmurHash3_x86_32 with seed 0 (Austin Appleby, public domain algorithm) of the bytes of a name.
std::uint32_t murmur_hash(std::string_view name);

// The hash as a float that is finite and no denormal: where the exponent would be all zeros or all ones, its lowest bit
// is inverted.
float cryptomatte_id(std::string_view name);

// Of a pixel: samples by name, as an index of a list of names.
using SampleCounts = std::map<std::uint32_t, std::uint32_t>;

// Appends the channels of `layer` ("CryptoObject") and the texts that describe them. `coverage` by pixel; `names` by
// its keys, several of which may be equal and then count as one; `samples`: of every pixel.
void add_cryptomatte(Picture& picture, const std::string& layer, const std::vector<SampleCounts>& coverage,
                     const std::vector<std::string>& names, std::uint32_t samples);

bool has_cryptomatte(const Picture& picture, const std::string& layer);

// Names of the header attributes of a layer.
std::vector<std::string> cryptomatte_texts(const std::string& layer);

// A layer of pictures of the same size, joined one after the other: coverages add up by samples. What a part has left
// out, being less than its last level, is missing from the sum as well.
struct JoinedCryptomatte {
  std::vector<std::map<float, double>> sums; // by pixel: samples by id
  std::uint64_t samples = 0;                 // of every pixel
};
// `part`: has the layer, from so many `samples`.
void join_cryptomatte(JoinedCryptomatte& joined, const std::string& layer, const Picture& part, std::uint32_t samples);
void add_cryptomatte(Picture& picture, const std::string& layer, const JoinedCryptomatte& joined);

} // namespace wavepath
