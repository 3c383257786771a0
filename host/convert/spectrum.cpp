#include "host/convert/spectrum.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace wavepath::convert {
namespace {

constexpr double kFirstNanometre = 380.0, kStepNanometres = 10.0;

// CIE 1931 colour matching functions, 2 degrees.
constexpr double kMatching[kWavelengths][3] = {
    {0.001368, 0.000039, 0.006450}, {0.004243, 0.000120, 0.020050}, {0.014310, 0.000396, 0.067850},
    {0.043510, 0.001210, 0.207400}, {0.134380, 0.004000, 0.645600}, {0.283900, 0.011600, 1.385600},
    {0.348280, 0.023000, 1.747060}, {0.336200, 0.038000, 1.772110}, {0.290800, 0.060000, 1.669200},
    {0.195360, 0.090980, 1.287640}, {0.095640, 0.139020, 0.812950}, {0.032010, 0.208020, 0.465180},
    {0.004900, 0.323000, 0.272000}, {0.009300, 0.503000, 0.158200}, {0.063270, 0.710000, 0.078250},
    {0.165500, 0.862000, 0.042160}, {0.290400, 0.954000, 0.020300}, {0.433450, 0.994950, 0.008750},
    {0.594500, 0.995000, 0.003900}, {0.762100, 0.952000, 0.002100}, {0.916300, 0.870000, 0.001650},
    {1.026300, 0.757000, 0.001100}, {1.062200, 0.631000, 0.000800}, {1.002600, 0.503000, 0.000340},
    {0.854450, 0.381000, 0.000190}, {0.642400, 0.265000, 0.000050}, {0.447900, 0.175000, 0.000020},
    {0.283500, 0.107000, 0.0},      {0.164900, 0.061000, 0.0},      {0.087400, 0.032000, 0.0},
    {0.046770, 0.017000, 0.0},      {0.022700, 0.008210, 0.0},      {0.011359, 0.004102, 0.0},
    {0.005790, 0.002091, 0.0},      {0.002899, 0.001047, 0.0},      {0.001440, 0.000520, 0.0},
    {0.000690, 0.000249, 0.0},      {0.000332, 0.000120, 0.0},      {0.000166, 0.000060, 0.0},
    {0.000083, 0.000030, 0.0},      {0.000042, 0.000015, 0.0},
};

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

glm::dvec3 rgb_from_xyz(const glm::dvec3& xyz) { // IEC 61966-2-1
  return {3.2404542 * xyz.x - 1.5371385 * xyz.y - 0.4985314 * xyz.z,
          -0.9692660 * xyz.x + 1.8760108 * xyz.y + 0.0415560 * xyz.z,
          0.0556434 * xyz.x - 0.2040259 * xyz.y + 1.0572252 * xyz.z};
}

glm::dvec3 xyz_of(const Spectrum& spectrum) {
  glm::dvec3 xyz(0.0);
  for (std::size_t i = 0; i < kWavelengths; ++i)
    xyz += spectrum[i] * glm::dvec3(kMatching[i][0], kMatching[i][1], kMatching[i][2]);
  return xyz;
}

// The luminance of a spectrum of 1 everywhere.
double unit_sum() {
  Spectrum one;
  one.fill(1.0);
  return xyz_of(one).y;
}

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
    const double wavelength = kFirstNanometre + kStepNanometres * static_cast<double>(i);
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

glm::dvec3 light_color(const Spectrum& light) { return rgb_from_xyz(xyz_of(light) / unit_sum()); }

double luminance(const glm::dvec3& color) { return glm::dot(color, glm::dvec3(0.2126729, 0.7151522, 0.0721750)); }

glm::dvec3 unit_luminance(const glm::dvec3& color) {
  const double y = luminance(color);
  return y > 0.0 ? color / y : glm::dvec3(0.0);
}

Spectrum black_body(double kelvin) {
  constexpr double kPlanck = 6.62607015e-34, kLight = 299792458.0, kBoltzmann = 1.380649e-23;
  Spectrum spectrum{};
  for (std::size_t i = 0; i < kWavelengths && kelvin > 0.0; ++i) {
    const double metres = 1e-9 * (kFirstNanometre + kStepNanometres * static_cast<double>(i));
    const double exponent = kPlanck * kLight / (metres * kBoltzmann * kelvin);
    spectrum[i] = 1e-9 * 2.0 * kPlanck * kLight * kLight / (std::pow(metres, 5.0) * std::expm1(exponent));
  }
  return spectrum;
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
