// Progressive refinement (Cohen, Chen, Wallace, Greenberg, "A Progressive Refinement Approach to Fast Radiosity Image
// Generation", SIGGRAPH 1988): faces shoot the power that they have not yet sent on, those with the most first.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

namespace wavepath {

struct Face {
  double area = 0.0; // square metres
  glm::dvec3 reflectance{0.0};
  glm::dvec3 unshot{0.0};     // radiosity that it has not yet sent on, W/m^2 as far as scenes have units
  glm::dvec3 irradiance{0.0}; // without that of lamps that are no faces

  double unshot_power() const { return area * (unshot.r + unshot.g + unshot.b); }
};

// Power that faces absorb of that irradiance, all channels.
double absorbed_power(const std::vector<Face>& faces, const std::vector<glm::dvec3>& irradiance);

struct Shot {
  std::uint32_t face = 0, rays = 0, number = 0;
  glm::dvec3 power{0.0};
};

class Refinement {
public:
  // `faces`: with the radiosity that they emit, or reflect of lamps, unshot. `rays`: how many the first of all power is
  // worth; the same share of power is worth as many later. `reflects`: faces send on what they get.
  Refinement(std::vector<Face> faces, double rays, bool reflects = true);

  // The faces with the most unshot power, which they lose: as many as `rays` rays are worth, but one at least. Empty
  // when kRemaining or less of the first power is unshot, or when power does not get less.
  std::vector<Shot> next_shots(std::uint64_t rays);
  // Gives a face power of a shot.
  void receive(std::uint32_t face, const glm::dvec3& power);
  void lose(const glm::dvec3& power) { lost_ += power.r + power.g + power.b; }

  // Irradiance by face, with the ambient term in place of what is unshot (Cohen et al., equations 6 to 10).
  std::vector<glm::dvec3> irradiance() const;

  const std::vector<Face>& faces() const { return faces_; }
  double remaining() const { return first_power_ > 0.0 ? unshot_power() / first_power_ : 0.0; }
  // Share of the power that faces absorb of that irradiance.
  double absorbed(const std::vector<glm::dvec3>& irradiance) const;
  double lost() const { return first_power_ > 0.0 ? lost_ / first_power_ : 0.0; } // share that left the scene
  double first_power() const { return first_power_; }
  std::uint32_t shots() const { return shots_; }
  std::uint64_t rays() const { return rays_; }

  static constexpr double kRemaining = 1e-3;

private:
  double unshot_power() const;

  std::vector<Face> faces_;
  bool reflects_;
  double first_power_ = 0.0, power_of_ray_ = 0.0, lost_ = 0.0;
  std::uint32_t shots_ = 0;
  std::uint64_t rays_ = 0, most_rays_ = 0;
};

} // namespace wavepath
