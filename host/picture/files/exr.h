// OpenEXR files: scanline images, float or half, of one part or several; attributes about the render; exact sums.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "host/film/film.h"
#include "host/picture/files/write_options.h"
#include "host/picture/picture.h"
#include "host/scene/staging/view.h"

namespace wavepath {

// The part of a picture that a file holds.
struct PartWindow {
  PicturePlace place;
  std::uint32_t width = 0, height = 0;
  bool operator==(const PartWindow&) const = default;
};

// Of a picture that is one of a sequence.
struct SequenceFrame {
  int number = 0;
  double per_second = 0.0;
};

// Facts about the render that the header attributes of an EXR record.
struct PictureInfo {
  std::uint32_t spp = 0;
  double seconds = 0.0;        // seconds of rendering alone
  std::optional<double> error; // estimated relative RMS error
  std::uint32_t seed = 0;      // at most 2^31 - 1, since EXR integers are signed
  std::string samples;         // "A:B"
  std::string scene, command, filter;
  std::string bias;   // entries separated by "; "
  std::string plan;   // decisions of the plan, as JSON (host/plan/record.h)
  std::string repeat; // command that renders the same bits; empty if there is none
  std::optional<View> view;
  std::optional<std::array<float, 16>> world_to_camera,
      world_to_ndc;                       // where there is no view, as read_matrix gives them
  std::optional<double> focus;            // metres, of a camera with a depth of field
  std::optional<double> exposure_seconds; // while the shutter is open
  std::optional<SequenceFrame> frame;
  // Only for a picture that can be merged: its identity (identity.h), the device that rendered it, and its exact sums
  // in channels film.NN. `origin`: world position of the origin of the film's positions.
  std::string identity, device;
  glm::dvec3 origin{0.0};
  std::shared_ptr<const Film> film;
};

// Writes a picture as write_picture() in picture_io.h does, which calls it.
std::uint64_t write_exr(const std::string& path, const Picture& picture, const PictureInfo& info,
                        const WriteOptions& options);

// Reads a picture that write_exr() has written: all parts, with our own names of channels, without its exact sums.
// Empty if another program may have changed the file or it cannot be read. It saves `compare` of two renders the 0.25 s
// of loading OpenImageIO.
std::optional<Picture> read_own_exr(const std::string& path);

// Prefix of the channels that hold exact sums.
inline constexpr const char* kFilmPrefix = "film.";

// A text or float attribute of an EXR header, as text; empty if the file is no EXR or has none of that name.
std::string read_attribute(const std::string& path, const std::string& name);

// The windows of an EXR. Nothing if the file is none, or its windows are not as write_exr() leaves them.
std::optional<PartWindow> read_window(const std::string& path);

// A number from an EXR header; empty if the file is no EXR or has none of that name.
std::optional<double> read_number(const std::string& path, const std::string& name);

std::optional<std::array<float, 16>> read_matrix(const std::string& path, const std::string& name);
std::optional<glm::dvec3> read_vector(const std::string& path, const std::string& name);

std::optional<SequenceFrame> read_frame(const std::string& path);

// True if the colours of an EXR were compressed with a loss.
bool is_lossy(const std::string& path);

// The exact sums of an EXR; null if it has none. Throws Error.
std::shared_ptr<const Film> read_film(const std::string& path);

} // namespace wavepath
