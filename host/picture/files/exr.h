// OpenEXR files: scanline images, ZIP compressed, float or half; attributes about the render; exact sums.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "host/film/film.h"
#include "host/picture/picture.h"
#include "host/scene/staging/view.h"

namespace wavepath {

// Facts about the render that the header attributes of an EXR record.
struct PictureInfo {
  std::uint32_t spp = 0;
  double seconds = 0.0;        // rendering alone
  std::optional<double> error; // estimated relative RMS error
  std::uint32_t seed = 0;      // at most 2^31 - 1, as EXR integers are signed
  std::string samples;         // "A:B"
  std::string scene, command, filter;
  std::string bias;   // entries separated by "; "
  std::string plan;   // the decisions that were made, as JSON
  std::string repeat; // a command that renders the same bits; empty where there is none
  std::optional<View> view;
  std::optional<std::array<float, 16>> world_to_camera,
      world_to_ndc; // where there is no view, as read_matrix gives them
  // For a picture that can be merged: the text that decides its bits (identity.h), the device that rendered it, and its
  // exact sums, in channels film.NN, with the point that their positions are relative to.
  std::string identity, device;
  glm::dvec3 origin{0.0};
  std::shared_ptr<const Film> film;
};

// As write_picture of picture_io.h, which calls it.
std::uint64_t write_exr(const std::string& path, const Picture& picture, const PictureInfo& info, bool half);

// A picture as write_exr() left it, without its exact sums; nothing where another program may have had a hand in it, or
// it cannot be read. Saves `compare` of two renders the quarter of a second that it takes to load OpenImageIO.
std::optional<Picture> read_own_exr(const std::string& path);

// Prefix of the names of channels of exact sums.
inline constexpr const char* kFilmPrefix = "film.";

// A text or float attribute of an EXR header, as text; empty if the file is no EXR or has none of that name.
std::string read_attribute(const std::string& path, const std::string& name);

// A number from an EXR header; nothing if the file is no EXR or has none of that name.
std::optional<double> read_number(const std::string& path, const std::string& name);

std::optional<std::array<float, 16>> read_matrix(const std::string& path, const std::string& name);
std::optional<glm::dvec3> read_vector(const std::string& path, const std::string& name);

// The exact sums that an EXR holds; null if it has none. Throws Error.
std::shared_ptr<const Film> read_film(const std::string& path);

} // namespace wavepath
