// Hierarchical radiosity (Hanrahan, Salzman and Aupperle, "A Rapid Hierarchical Radiosity Algorithm", SIGGRAPH 1991):
// light goes by links between nodes of the trees of patches, of large parts where that is exact enough.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "host/integrators/radiosity/link_nodes.h"
#include "host/integrators/radiosity/refinement.h"

namespace wavepath {

// A link carries light both ways between two faces that see each other.
struct Link {
  std::uint32_t a = 0, b = 0; // faces: 2 * node + side
  float exchange = 0.0f;      // Exchange::area
  float spread_a = 0.0f, spread_b = 0.0f;
  float visible = 1.0f; // share of the light that nothing stops
};

// Most triangles of which all pairs are linked.
inline constexpr std::uint64_t kMostLinkedTriangles = 1024;

class Links {
public:
  // `nodes`: see make_link_nodes(). `faces`: of their patches, with the radiosity that they emit, or reflect of lamps,
  // unshot. `most`: links whose visibility may be measured, besides those between whole triangles. `reflects`: faces
  // send on what they get. Throws Error if there are more than kMostLinkedTriangles.
  Links(std::vector<LinkNode> nodes, std::vector<Face> faces, std::uint64_t most, bool reflects = true);

  // Links to be measured next, `count` at most. Empty when light is solved by as many as there may be, or when no
  // further link would change it.
  std::span<const Link> next(std::uint64_t count);
  // Visibility of the links of next(): the share of their light that nothing stops, from 0 to 1.
  void measure(std::span<const float> visible);

  // Results, with the names that Refinement has for them. There is no ambient term.
  std::vector<glm::dvec3> irradiance() const;
  const std::vector<Face>& faces() const { return faces_; }
  double absorbed(const std::vector<glm::dvec3>& irradiance) const;
  double lost() const;      // share that links carry nowhere: it left the scene, or form factors are inexact
  double remaining() const; // share that faces have not sent on when the solution ended
  std::uint32_t shots() const { return 0; }

  std::uint32_t count() const { return static_cast<std::uint32_t>(links_.size()); }
  std::uint64_t measured() const { return measured_; } // those that were cut up since, too

private:
  struct Cut {
    double gain = 0.0; // power that the link may put in the wrong place
    bool of_a = true;  // which face to cut
  };

  void add(std::uint32_t a, std::uint32_t b);
  void link_triangles();
  void gather();
  void push();
  void pull();
  double largest_eigenvalue();
  double reflect();
  void solve();
  Cut best_cut(const Link& link) const;
  void cut_links();

  std::vector<LinkNode> nodes_;
  std::vector<Face> faces_;
  std::uint64_t most_, measured_ = 0;
  bool reflects_;
  double strength_ = 1.0;             // factor of all links
  double power_ = 0.0, unsent_ = 0.0; // of all faces: at first, and when the solution ended
  std::vector<Link> links_;
  std::size_t known_ = 0;              // links whose visibility is measured: the first ones
  std::vector<glm::dvec3> radiosity_;  // by face of a node, over its whole area; W/m^2
  std::vector<glm::dvec3> irradiance_; // the same, of links that end there; after push() those of parents too
  std::vector<double> range_;          // by face: of the radiosity of patches below it, all channels
};

} // namespace wavepath
