#include "host/scene/pack/albedo_tables.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include <tbb/parallel_for.h>

namespace wavepath {
namespace {

constexpr std::size_t kNodes = gpu::kTableCells + 1;
constexpr int kCapRings = 48, kCapSpokes = 24;               // strata of microfacets a direction
using Grid = std::array<std::array<double, kNodes>, kNodes>; // [roughness][root of cosine]

double alpha_at(std::size_t row) {
  const double roughness = static_cast<double>(row) / gpu::kTableCells;
  return roughness * roughness;
}

// The first column stands for grazing directions, where a cosine of zero has no microfacets to see.
double cosine_at(std::size_t column) {
  const double x = std::max(static_cast<double>(column) / gpu::kTableCells, 0.25 / gpu::kTableCells);
  return x * x;
}

template <class Albedo>
Grid fill(Albedo albedo) {
  Grid grid;
  tbb::parallel_for(std::size_t{0}, kNodes, [&](std::size_t row) {
    for (std::size_t column = 0; column < kNodes; ++column)
      grid[row][column] = std::clamp(albedo(alpha_at(row), cosine_at(column)), 0.0, 1.0);
  });
  return grid;
}

double smith_root(const glm::dvec3& w, double alpha) {
  return std::sqrt(w.z * w.z + alpha * alpha * (w.x * w.x + w.y * w.y));
}

// Shadowing that is left once wo sees a microfacet: G2 / G1.
double remaining_shadowing(const glm::dvec3& wo, const glm::dvec3& wi, double alpha) {
  const double o = std::abs(wo.z), i = std::abs(wi.z);
  const double root_o = smith_root(wo, alpha), root_i = smith_root(wi, alpha);
  return i * (o + root_o) / (i * root_o + o * root_i);
}

// Mean over microfacets visible from a direction with this cosine (ggx_sample_visible_normal() of
// kernels/surface/microfacet.glsl). Strata grow narrow towards the rim of the cap, where steep facets are: with equal
// ones the error was 1e-2 at alpha 0.1. Spokes are those of one half; the other is its mirror image.
template <class Weight>
double mean_of_visible(double alpha, double cosine, Weight weight) {
  const glm::dvec3 wo(std::sqrt(1.0 - cosine * cosine), 0.0, cosine);
  const glm::dvec3 o = glm::normalize(glm::dvec3(alpha * wo.x, alpha * wo.y, wo.z));
  double sum = 0.0;
  for (int i = 0; i < kCapSpokes; ++i)
    for (int j = 0; j < kCapRings; ++j) {
      const double turn = std::numbers::pi * (i + 0.5) / kCapSpokes, q = 1.0 - (j + 0.5) / kCapRings;
      const double z = 1.0 - (1.0 - q * q * q) * (1.0 + o.z), sine = std::sqrt(std::max(1.0 - z * z, 0.0));
      const glm::dvec3 cap = glm::dvec3(sine * std::cos(turn), sine * std::sin(turn), z) + o;
      sum += 3.0 * q * q * weight(wo, glm::normalize(glm::dvec3(alpha * cap.x, alpha * cap.y, std::max(cap.z, 0.0))));
    }
  return sum / (kCapRings * kCapSpokes);
}

// fresnel_exact() of kernels/surface/fresnel.glsl.
double fresnel(double c, double eta) {
  const double g2 = c * c + eta * eta - 1.0;
  if (g2 <= 0.0) return 1.0;
  const double g = std::sqrt(g2), s = (c - g) / (c + g), p = (eta * eta * c - g) / (eta * eta * c + g);
  return 0.5 * (s * s + p * p);
}

double ggx_albedo(double alpha, double cosine) {
  if (alpha < gpu::kMinAlpha) return 1.0;
  return mean_of_visible(alpha, cosine, [&](const glm::dvec3& wo, const glm::dvec3& h) {
    const glm::dvec3 wi = 2.0 * glm::dot(wo, h) * h - wo;
    return wi.z > 0.0 ? remaining_shadowing(wo, wi, alpha) : 0.0;
  });
}

double glass_albedo(double alpha, double cosine, double eta) {
  if (alpha < gpu::kMinAlpha) return 1.0;
  return mean_of_visible(alpha, cosine, [&](const glm::dvec3& wo, const glm::dvec3& h) {
    const double c = glm::dot(wo, h), reflected = fresnel(c, eta);
    const glm::dvec3 mirrored = 2.0 * c * h - wo;
    double sum = mirrored.z > 0.0 ? reflected * remaining_shadowing(wo, mirrored, alpha) : 0.0;
    if (reflected < 1.0) {
      const glm::dvec3 bent = (h * (c - std::sqrt(c * c + eta * eta - 1.0)) - wo) / eta;
      if (bent.z < 0.0) sum += (1.0 - reflected) * remaining_shadowing(wo, bent, alpha);
    }
    return sum;
  });
}

// sheen_curve() and eval_sheen() of kernels/surface/sheen.glsl.
double sheen_lambda(double cosine, double alpha) {
  const auto curve = [&](double x) {
    const double t = (1.0 - alpha) * (1.0 - alpha);
    const auto fit = [&](double rough, double fine) { return rough + (fine - rough) * t; };
    return fit(21.5473, 25.3245) / (1.0 + fit(3.82987, 3.32435) * std::pow(x, fit(0.19823, 0.16801))) +
           fit(-1.97760, -1.27393) * x + fit(-4.32054, -4.85967);
  };
  return std::exp(cosine < 0.5 ? curve(cosine) : 2.0 * curve(0.5) - curve(1.0 - cosine));
}

// The half vector's z, squared, is (wo.z + wi.z)^2 / (2 + 2 wo.wi): what remains for each direction is one power.
double sheen_albedo(double alpha, double cosine) {
  alpha = std::max(alpha, double{gpu::kMinSheenAlpha});
  constexpr int kRings = 256, kSpokes = 64; // of half of the azimuths; the other half is the same
  static const auto turns = [] {
    std::array<double, kSpokes> cosines;
    for (int j = 0; j < kSpokes; ++j) cosines[j] = std::cos(std::numbers::pi * (j + 0.5) / kSpokes);
    return cosines;
  }();
  const double wo_sine = std::sqrt(1.0 - cosine * cosine), wo_lambda = sheen_lambda(cosine, alpha);
  double sum = 0.0;
  for (int i = 0; i < kRings; ++i) {
    const double theta = 0.5 * std::numbers::pi * (i + 0.5) / kRings, wi_sine = std::sin(theta), wi_z = std::cos(theta);
    double powers = 0.0;
    for (const double turn : turns) {
      const double h2 = (cosine + wi_z) * (cosine + wi_z) / (2.0 + 2.0 * (cosine * wi_z + wo_sine * wi_sine * turn));
      powers += std::pow(std::max(1.0 - h2, 0.0), 0.5 / alpha);
    }
    const double distribution = (2.0 + 1.0 / alpha) / (2.0 * std::numbers::pi);
    const double shadowing = 1.0 + wo_lambda + sheen_lambda(wi_z, alpha);
    sum += powers * distribution * std::min(1.0 / (4.0 * cosine * shadowing), wi_z) * wi_sine;
  }
  return sum * (0.5 * std::numbers::pi / kRings) * (2.0 * std::numbers::pi / kSpokes);
}

// Twice the integral of a row times the cosine, as the kernels interpolate it: linear in x, the root of the cosine, so
// that the weight is 4 x^3.
double mean_of_row(const std::array<double, kNodes>& row) {
  double sum = 0.0;
  for (std::size_t i = 0; i < gpu::kTableCells; ++i) {
    const double a = static_cast<double>(i) / gpu::kTableCells, b = static_cast<double>(i + 1) / gpu::kTableCells;
    const double slope = (row[i + 1] - row[i]) / (b - a), start = row[i] - slope * a;
    sum += start * (std::pow(b, 4) - std::pow(a, 4)) + slope * 0.8 * (std::pow(b, 5) - std::pow(a, 5));
  }
  return sum;
}

// `average`: by row.
template <class Average>
void append(const Grid& grid, Average average, std::vector<glm::vec4>& table) {
  for (std::size_t row = 0; row < gpu::kTableCells; ++row)
    for (std::size_t column = 0; column < gpu::kTableCells; ++column)
      table.emplace_back(grid[row][column], grid[row][column + 1], grid[row + 1][column], grid[row + 1][column + 1]);
  for (std::size_t row = 0; row < kNodes; ++row) table.push_back(average(row));
}

} // namespace

std::vector<glm::vec4> ggx_albedo_table() {
  const Grid grid = fill(ggx_albedo);
  std::vector<glm::vec4> table;
  append(
      grid, [&](std::size_t row) { return glm::vec4(1.0 - mean_of_row(grid[row]), 0.0, 0.0, 0.0); }, table);
  return table;
}

std::vector<glm::vec4> sheen_albedo_table() {
  std::vector<glm::vec4> table;
  append(
      fill(sheen_albedo), [](std::size_t) { return glm::vec4(0.0f); }, table);
  return table;
}

std::vector<glm::vec4> glass_albedo_tables(double ior) {
  const Grid outside = fill([&](double alpha, double cosine) { return glass_albedo(alpha, cosine, ior); });
  const Grid inside = fill([&](double alpha, double cosine) { return glass_albedo(alpha, cosine, 1.0 / ior); });
  double passes = 0.0;
  constexpr int kSteps = 4096;
  for (int i = 0; i < kSteps; ++i) {
    const double mu = (i + 0.5) / kSteps;
    passes += (1.0 - fresnel(mu, ior)) * 2.0 * mu / kSteps;
  }
  std::vector<glm::vec4> tables;
  const auto missing = [](const Grid& grid, std::size_t row) { return 1.0 - mean_of_row(grid[row]); };
  append(
      outside, [&](std::size_t r) { return glm::vec4(missing(outside, r), missing(inside, r), passes, 0.0); }, tables);
  append(
      inside, [&](std::size_t r) { return glm::vec4(missing(inside, r), missing(outside, r), passes, 0.0); }, tables);
  return tables;
}

std::vector<glm::vec4> make_albedo_tables(std::span<const gpu::Material> materials,
                                          std::span<gpu::MaterialLayers> layers, gpu::Feature lobes,
                                          std::uint32_t first_texel) {
  std::vector<glm::vec4> tables;
  const auto add = [&](const std::vector<glm::vec4>& table) {
    const auto first = first_texel + static_cast<std::uint32_t>(tables.size());
    tables.insert(tables.end(), table.begin(), table.end());
    return first;
  };
  if (lobes & gpu::kLobeMultiple) {
    const std::uint32_t ggx = add(ggx_albedo_table());
    std::map<float, std::uint32_t> glass; // by ior
    for (std::size_t m = 0; m < materials.size(); ++m) {
      layers[m].ggx_table = ggx;
      const bool body = materials[m].transmission > 0.0f && (materials[m].flags & gpu::kMaterialVolume);
      const bool rough = materials[m].roughness * materials[m].roughness >= gpu::kMinAlpha;
      if (!body || !rough) continue;
      if (materials[m].ior == 1.0f &&
          materials[m].metallic == 0.0f) { // facets that neither reflect nor bend lack nothing
        layers[m].ggx_table = gpu::kNone;
        continue;
      }
      const auto [found, is_new] = glass.emplace(materials[m].ior, 0);
      if (is_new) found->second = add(glass_albedo_tables(std::max(materials[m].ior, 1.0f)));
      layers[m].glass_table = found->second;
    }
  }
  if (lobes & gpu::kLobeSheen) {
    const std::uint32_t sheen = add(sheen_albedo_table());
    for (gpu::MaterialLayers& record : layers) record.sheen_table = sheen;
  }
  return tables;
}

} // namespace wavepath
