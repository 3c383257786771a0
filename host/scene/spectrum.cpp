#include "host/scene/spectrum.h"

#include <cmath>

namespace wavepath {
namespace {

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

// The luminance of a spectrum of 1 everywhere.
double unit_sum() {
  Spectrum one;
  one.fill(1.0);
  return xyz_of(one).y;
}

} // namespace

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

glm::dvec3 light_color(const Spectrum& light) { return rgb_from_xyz(xyz_of(light) / unit_sum()); }

double planck(double wavelength, double kelvin) {
  constexpr double kPlanck = 6.62607015e-34, kLight = 299792458.0, kBoltzmann = 1.380649e-23;
  if (!(kelvin > 0.0)) return 0.0;
  const double metres = 1e-9 * wavelength;
  const double exponent = kPlanck * kLight / (metres * kBoltzmann * kelvin);
  return 1e-9 * 2.0 * kPlanck * kLight * kLight / (std::pow(metres, 5.0) * std::expm1(exponent));
}

Spectrum black_body(double kelvin) {
  Spectrum spectrum{};
  for (std::size_t i = 0; i < kWavelengths; ++i) spectrum[i] = planck(nanometres(i), kelvin);
  return spectrum;
}

} // namespace wavepath
