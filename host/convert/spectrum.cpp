#include "host/convert/spectrum.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace wavepath::convert {
namespace {

// CIE standard illuminant D65.
constexpr double kDaylight[kWavelengths] = {
    49.98,  54.65,  82.75,  91.49,  93.43, 86.68, 104.86, 117.01, 117.81, 114.86, 115.92, 108.81, 109.35, 107.8,
    104.79, 107.69, 104.41, 104.05, 100.0, 96.33, 95.79,  88.69,  90.01,  89.6,   87.7,   83.29,  83.7,   80.03,
    80.21,  82.28,  78.28,  69.72,  71.61, 74.35, 61.6,   69.89,  75.09,  63.59,  46.42,  66.81,  63.38};

struct Named {
  std::string_view name;
  double color[3];
};

// Reflectance at normal incidence, computed from measured indices of refraction (Palik and others) under D65, cut to 1.
constexpr Named kMetals[] = {
    {"Ag", {0.971, 0.960, 0.915}},   {"Al", {0.913, 0.922, 0.924}},   {"AlAs", {0.280, 0.266, 0.432}},
    {"AlSb", {0.350, 0.385, 0.477}}, {"Au", {1.000, 0.783, 0.343}},   {"Be", {0.539, 0.538, 0.537}},
    {"Cr", {0.634, 0.662, 0.704}},   {"CsI", {0.078, 0.081, 0.086}},  {"Cu", {0.955, 0.638, 0.538}},
    {"Cu2O", {0.243, 0.265, 0.273}}, {"CuO", {0.221, 0.217, 0.215}},  {"CuZn", {0.887, 0.778, 0.434}},
    {"Hg", {0.781, 0.780, 0.778}},   {"HgTe", {0.405, 0.384, 0.385}}, {"Ir", {0.700, 0.693, 0.656}},
    {"K", {0.949, 0.938, 0.920}},    {"Li", {0.915, 0.889, 0.807}},   {"MgO", {0.072, 0.073, 0.075}},
    {"Mo", {0.558, 0.579, 0.570}},   {"Na", {0.976, 0.961, 0.935}},   {"Nb", {0.503, 0.507, 0.504}},
    {"Ni", {0.659, 0.609, 0.525}},   {"Rh", {0.797, 0.765, 0.742}},   {"Se", {0.316, 0.270, 0.275}},
    {"SiC", {0.201, 0.206, 0.214}},  {"SnTe", {0.365, 0.122, 0.031}}, {"Ta", {0.389, 0.360, 0.412}},
    {"Te", {0.572, 0.593, 0.584}},   {"ThF4", {0.042, 0.043, 0.043}}, {"TiC", {0.489, 0.458, 0.445}},
    {"TiN", {0.614, 0.462, 0.233}},  {"TiO2", {0.232, 0.245, 0.272}}, {"V", {0.511, 0.528, 0.565}},
    {"VC", {0.469, 0.436, 0.414}},   {"VN", {0.469, 0.410, 0.345}},   {"W", {0.515, 0.496, 0.467}},
    {"a-C", {0.212, 0.212, 0.200}},  {"d-C", {0.171, 0.173, 0.176}},  {"none", {1.0, 1.0, 1.0}},
};

struct Refraction {
  std::string_view name;
  double ior;
};

constexpr Refraction kIors[] = {
    {"vacuum", 1.0},
    {"air", 1.000277},
    {"helium", 1.000036},
    {"hydrogen", 1.000132},
    {"carbon dioxide", 1.00045},
    {"water", 1.333},
    {"water ice", 1.31},
    {"acetone", 1.36},
    {"ethanol", 1.361},
    {"carbon tetrachloride", 1.461},
    {"glycerol", 1.4729},
    {"benzene", 1.501},
    {"silicone oil", 1.52045},
    {"bromine", 1.661},
    {"fused quartz", 1.458},
    {"pyrex", 1.47},
    {"acrylic glass", 1.49},
    {"polypropylene", 1.49},
    {"bk7", 1.5046},
    {"sodium chloride", 1.544},
    {"amber", 1.55},
    {"pet", 1.575},
    {"diamond", 2.419},
    {"glass-BK7", 1.5168},
    {"glass-BAF10", 1.67},
    {"glass-FK51A", 1.4866},
    {"glass-LASF9", 1.8503},
    {"glass-F5", 1.6034},
    {"glass-F10", 1.6232},
    {"glass-F11", 1.6207},
    {"glass-SF5", 1.6727},
    {"glass-SF10", 1.7283},
    {"glass-SF11", 1.7847},
};

glm::dvec3 daylight(double kelvin) { // CIE 15: the locus of daylight, as a colour of luminance 1
  const double t = 1000.0 / kelvin;
  const double x = kelvin < 7000.0 ? 0.244063 + t * (0.09911 + t * (2.9678 - t * 4.6070))
                                   : 0.237040 + t * (0.24748 + t * (1.9018 - t * 2.0064));
  const double y = -3.0 * x * x + 2.87 * x - 0.275;
  return rgb_from_xyz({x / y, 1.0, (1.0 - x - y) / y});
}

} // namespace

Spectrum resample(const SpectrumTable& table) {
  Spectrum spectrum{};
  if (table.empty()) return spectrum;
  std::size_t after = 0;
  for (std::size_t i = 0; i < kWavelengths; ++i) {
    const double wavelength = nanometres(i);
    while (after < table.size() && table[after].first < wavelength) ++after;
    if (after == 0 || after == table.size()) {
      const bool is_end = after == 0 ? table.front().first == wavelength : table.back().first == wavelength;
      spectrum[i] = !is_end ? 0.0 : after == 0 ? table.front().second : table.back().second;
      continue;
    }
    const auto& [low, value] = table[after - 1];
    const auto& [high, next] = table[after];
    spectrum[i] = high > low ? value + (next - value) * (wavelength - low) / (high - low) : next;
  }
  return spectrum;
}

glm::dvec3 reflected_color(const Spectrum& reflectance) {
  Spectrum light;
  for (std::size_t i = 0; i < kWavelengths; ++i) light[i] = kDaylight[i];
  // Divided by white of the same sums, so that what the table rounds does not tint.
  const glm::dvec3 white = rgb_from_xyz(xyz_of(light));
  for (std::size_t i = 0; i < kWavelengths; ++i) light[i] *= reflectance[i];
  return rgb_from_xyz(xyz_of(light)) / white;
}

double luminance(const glm::dvec3& color) { return glm::dot(color, glm::dvec3(0.2126729, 0.7151522, 0.0721750)); }

glm::dvec3 unit_luminance(const glm::dvec3& color) {
  const double y = luminance(color);
  return y > 0.0 ? color / y : glm::dvec3(0.0);
}

std::optional<glm::dvec3> named_illuminant(std::string_view name) {
  if (name == "stdillum-A") return unit_luminance(light_color(black_body(2855.5)));
  if (name == "stdillum-D50") return daylight(5003.0);
  if (name == "stdillum-D55") return daylight(5503.0);
  if (name == "illum-acesD60") return daylight(6000.0);
  if (name == "stdillum-D65") return glm::dvec3(1.0);
  if (name == "stdillum-D75") return daylight(7504.0);
  return std::nullopt;
}

std::optional<glm::dvec3> named_metal(std::string_view name) {
  name = name.substr(0, name.find('_')); // Cu_palik
  if (name.ends_with("-e")) name.remove_suffix(2);
  for (const Named& metal : kMetals)
    if (metal.name == name) return glm::dvec3(metal.color[0], metal.color[1], metal.color[2]);
  return std::nullopt;
}

double conductor_reflectance(double eta, double k) {
  return ((eta - 1.0) * (eta - 1.0) + k * k) / ((eta + 1.0) * (eta + 1.0) + k * k);
}

std::optional<double> named_ior(std::string_view name) {
  for (const Refraction& row : kIors)
    if (row.name == name) return row.ior;
  return std::nullopt;
}

double internal_diffuse_reflectance(double eta) {
  if (eta <= 1.0) return 0.0;
  // What enters from outside, by quadrature over the cosine; what leaves from inside is smaller by eta^2.
  constexpr int kSteps = 2000;
  double entering = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    const double c = (i + 0.5) / kSteps, t = std::sqrt(1.0 - (1.0 - c * c) / (eta * eta));
    const double s = (c - eta * t) / (c + eta * t), p = (eta * c - t) / (eta * c + t);
    entering += (1.0 - 0.5 * (s * s + p * p)) * 2.0 * c / kSteps;
  }
  return 1.0 - entering / (eta * eta);
}

} // namespace wavepath::convert
