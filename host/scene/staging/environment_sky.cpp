// Computes the sky's radiance by the formula of Perez with Preetham's coefficients, and the sun's through the air.
#include "host/scene/staging/environment_sky.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <tbb/parallel_for.h>

#include "host/scene/lat_long.h"

namespace wavepath {
namespace {

using std::numbers::pi;
// 0.18 degrees a texel, so that the sun is three texels wide: interpolation blurs its rim by a third of its width.
constexpr std::uint32_t kSkyWidth = 2048, kSkyHeight = 1024;
constexpr double kTurbidity = 3.0; // clear, with a little haze
constexpr double kGroundAlbedo = 0.2;
constexpr double kSunZenith = 0.5 * pi - kSunElevation;

// Perez' five coefficients, each linear in turbidity: slope and constant.
struct Perez {
  double a, b, c, d, e;

  double operator()(double cos_zenith, double angle_to_sun, double cos_to_sun) const {
    return (1.0 + a * std::exp(b / cos_zenith)) * (1.0 + c * std::exp(d * angle_to_sun) + e * cos_to_sun * cos_to_sun);
  }
};

// Coefficients of luminance and of the chromaticities x and y (Preetham et al., A.2).
constexpr double kT = kTurbidity;
constexpr Perez kLuminance{0.1787 * kT - 1.4630, -0.3554 * kT + 0.4275, -0.0227 * kT + 5.3251, 0.1206 * kT - 2.5771,
                           -0.0670 * kT + 0.3703};
constexpr Perez kChromaX{-0.0193 * kT - 0.2592, -0.0665 * kT + 0.0008, -0.0004 * kT + 0.2125, -0.0641 * kT - 0.8989,
                         -0.0033 * kT + 0.0452};
constexpr Perez kChromaY{-0.0167 * kT - 0.2608, -0.0950 * kT + 0.0092, -0.0079 * kT + 0.2102, -0.0441 * kT - 1.6537,
                         -0.0109 * kT + 0.0529};

// At the zenith: luminance in kcd/m^2, chromaticities.
double zenith_luminance() {
  const double chi = (4.0 / 9.0 - kT / 120.0) * (pi - 2.0 * kSunZenith);
  return (4.0453 * kT - 4.9710) * std::tan(chi) - 0.2155 * kT + 2.4192;
}

double zenith_chroma(const double (&rows)[3][4]) { // rows: of T^2, T and 1; columns: of the sun's angle cubed and so on
  const double s = kSunZenith;
  const auto polynomial = [&](const double(&r)[4]) { return ((r[0] * s + r[1]) * s + r[2]) * s + r[3]; };
  return kT * kT * polynomial(rows[0]) + kT * polynomial(rows[1]) + polynomial(rows[2]);
}

constexpr double kZenithX[3][4] = {
    {0.00166, -0.00375, 0.00209, 0.0}, {-0.02903, 0.06377, -0.03202, 0.00394}, {0.11693, -0.21196, 0.06052, 0.25886}};
constexpr double kZenithY[3][4] = {
    {0.00275, -0.00610, 0.00317, 0.0}, {-0.04214, 0.08970, -0.04153, 0.00516}, {0.15346, -0.26756, 0.06670, 0.26688}};

// CIE xyY to linear sRGB; what lies outside of its gamut is cut.
glm::dvec3 rgb_of(double x, double y, double luminance) {
  const double X = x / y * luminance, Y = luminance, Z = (1.0 - x - y) / y * luminance;
  return glm::max(
      glm::dvec3(3.2404542 * X - 1.5371385 * Y - 0.4985314 * Z, //
                 -0.9692660 * X + 1.8760108 * Y + 0.0415560 * Z, 0.0556434 * X - 0.2040259 * Y + 1.0572252 * Z),
      0.0);
}

glm::dvec3 sun_direction() {
  return {-std::sin(kSunAzimuth) * std::cos(kSunElevation), std::sin(kSunElevation),
          std::cos(kSunAzimuth) * std::cos(kSunElevation)};
}

// kcd/m^2 of a direction above the horizon.
class Sky {
public:
  Sky() {
    const double s = kSunZenith, c = std::cos(s);
    luminance_ = zenith_luminance() / kLuminance(1.0, s, c);
    x_ = zenith_chroma(kZenithX) / kChromaX(1.0, s, c);
    y_ = zenith_chroma(kZenithY) / kChromaY(1.0, s, c);
  }
  glm::dvec3 radiance(const glm::dvec3& d) const {
    const double cos_zenith = std::max(d.y, 0.01), cos_to_sun = std::clamp(glm::dot(d, sun_), -1.0, 1.0);
    const double to_sun = std::atan2(glm::length(glm::cross(d, sun_)), cos_to_sun);
    return rgb_of(x_ * kChromaX(cos_zenith, to_sun, cos_to_sun), y_ * kChromaY(cos_zenith, to_sun, cos_to_sun),
                  luminance_ * kLuminance(cos_zenith, to_sun, cos_to_sun));
  }

private:
  glm::dvec3 sun_ = sun_direction();
  double luminance_, x_, y_;
};

// Illuminance on a surface that faces the sun, klx by channel: 133 klx above the air, weakened by Rayleigh scattering,
// aerosol (Angstrom) and ozone at 0.61, 0.55 and 0.465 micrometres, where the primaries of sRGB have their weight.
glm::dvec3 sun_illuminance() {
  constexpr double kAboveAir = 133.0;
  constexpr double kMicrometres[3] = {0.61, 0.55, 0.465}, kOzonePerCm[3] = {0.12, 0.085, 0.009};
  constexpr double kOzoneCm = 0.35, kAerosol = 0.04608 * kTurbidity - 0.04586;
  const double zenith_degrees = glm::degrees(kSunZenith);
  const double air = 1.0 / (std::cos(kSunZenith) + 0.15 * std::pow(93.885 - zenith_degrees, -1.253)); // Kasten 1965
  glm::dvec3 illuminance;
  for (int c = 0; c < 3; ++c) {
    const double depth = 0.008735 * std::pow(kMicrometres[c], -4.08) + kAerosol * std::pow(kMicrometres[c], -1.3) +
                         kOzonePerCm[c] * kOzoneCm;
    illuminance[c] = kAboveAir * std::exp(-depth * air);
  }
  return illuminance;
}

// Adds the disc to the texels that it covers, in proportion, such that it brings exactly `illuminance`.
void add_sun(Environment& map, const glm::dvec3& illuminance) {
  constexpr int kPieces = 16; // a side of a texel
  const glm::dvec3 sun = sun_direction();
  const glm::dvec2 middle = environment_uv(sun, 0.0) * glm::dvec2(kSkyWidth, kSkyHeight);
  const int reach_y = static_cast<int>(kSunRadius / pi * kSkyHeight) + 2,
            reach_x = static_cast<int>(reach_y / std::cos(kSunElevation)) + 1;
  struct Covered {
    std::size_t texel;
    double solid_angle;
  };
  std::vector<Covered> covered;
  double total = 0.0;
  for (int y = static_cast<int>(middle.y) - reach_y; y <= static_cast<int>(middle.y) + reach_y; ++y)
    for (int x = static_cast<int>(middle.x) - reach_x; x <= static_cast<int>(middle.x) + reach_x; ++x) {
      int inside = 0;
      for (int piece = 0; piece < kPieces * kPieces; ++piece) {
        const glm::dvec2 at(x + (piece % kPieces + 0.5) / kPieces, y + (piece / kPieces + 0.5) / kPieces);
        const glm::dvec3 d = environment_direction(at / glm::dvec2(kSkyWidth, kSkyHeight), 0.0);
        inside += glm::length(glm::cross(d, sun)) < std::sin(kSunRadius);
      }
      if (inside == 0) continue;
      const auto row = static_cast<std::size_t>(y);
      const double fraction = static_cast<double>(inside) / (kPieces * kPieces);
      covered.push_back(
          {row * kSkyWidth + static_cast<std::size_t>(x), fraction * texel_solid_angle(row, kSkyWidth, kSkyHeight)});
      total += covered.back().solid_angle;
    }
  for (const Covered& part : covered) {
    const std::size_t row = part.texel / kSkyWidth;
    const double fraction = part.solid_angle / total / texel_solid_angle(row, kSkyWidth, kSkyHeight);
    map.map[part.texel] += glm::vec3(illuminance * fraction);
  }
}

} // namespace

Environment sky_environment() {
  Environment map;
  map.radiance = glm::vec3(1.0f);
  map.width = kSkyWidth, map.height = kSkyHeight;
  map.map.resize(std::size_t{kSkyWidth} * kSkyHeight);
  const Sky sky;
  tbb::parallel_for(0u, kSkyHeight / 2, [&](std::uint32_t y) {
    for (std::uint32_t x = 0; x < kSkyWidth; ++x)
      map.map[std::size_t{y} * kSkyWidth + x] =
          glm::vec3(sky.radiance(environment_direction({(x + 0.5) / kSkyWidth, (y + 0.5) / kSkyHeight}, 0.0)));
  });
  add_sun(map, sun_illuminance());
  const glm::vec3 ground(kGroundAlbedo / pi * floor_irradiance(map));
  std::fill(map.map.begin() + map.map.size() / 2, map.map.end(), ground);
  expose_for_white_floor(map);
  return map;
}

} // namespace wavepath
