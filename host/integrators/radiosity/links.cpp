#include "host/integrators/radiosity/links.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "host/base/error.h"

namespace wavepath {
namespace {

constexpr double kSettled = 1e-6;               // share of the power that faces have not sent on when light is solved
constexpr std::uint32_t kMostIterations = 2000; // surfaces that reflect all would go on for ever
constexpr std::uint32_t kFirstIterations = 8;   // in which the power of light may rise and fall
constexpr int kPowerIterations = 32;
constexpr double kMostReflected = 0.9995; // of the light that faces get
constexpr double kLeastGain = 1e-7;       // share of the power that a link has to put in the wrong place, to be cut
constexpr double kGrowth = 2.0;           // links between two solutions

double sum_of(const glm::dvec3& light) { return light.r + light.g + light.b; }

double power_of(std::span<const Face> faces) {
  double sum = 0.0;
  for (const Face& face : faces) sum += face.unshot_power();
  return sum;
}

} // namespace

Links::Links(std::vector<LinkNode> nodes, std::vector<Face> faces, std::uint64_t most, bool reflects)
    : nodes_(std::move(nodes)),
      faces_(std::move(faces)),
      most_(most),
      reflects_(reflects),
      power_(power_of(faces_)),
      radiosity_(2 * nodes_.size()),
      irradiance_(2 * nodes_.size()),
      range_(2 * nodes_.size()) {
  if (power_ > 0.0) link_triangles();
  most_ += links_.size();
}

void Links::add(std::uint32_t a, std::uint32_t b) {
  const auto is_there = [&](std::uint32_t face) { return !(face & 1u) || nodes_[face / 2].has_back; };
  if (!is_there(a) || !is_there(b)) return;
  const Exchange exchange = exchange_of(nodes_, a, b);
  if (!(exchange.area > 0.0)) return;
  links_.push_back({a, b, static_cast<float>(exchange.area), static_cast<float>(exchange.spread_a),
                    static_cast<float>(exchange.spread_b)});
}

void Links::link_triangles() {
  std::vector<std::uint32_t> roots;
  for (std::uint32_t i = 0; i < nodes_.size(); ++i)
    if (nodes_[i].is_root) roots.push_back(i);
  if (roots.size() > kMostLinkedTriangles)
    throw Error("--form-factors links",
                fmt::format("links all pairs of triangles, and the scene has more than {}", kMostLinkedTriangles),
                "use --form-factors rays");
  for (std::size_t i = 0; i < roots.size(); ++i)
    for (std::size_t j = i + 1; j < roots.size(); ++j)
      for (std::uint32_t sides = 0; sides < 4; ++sides) add(2 * roots[i] + (sides & 1), 2 * roots[j] + (sides >> 1));
}

std::span<const Link> Links::next(std::uint64_t count) {
  if (!(power_ > 0.0)) return {};
  if (known_ == links_.size()) {
    solve();
    cut_links();
  }
  return std::span(links_).subspan(known_, std::min<std::uint64_t>(count, links_.size() - known_));
}

void Links::measure(std::span<const float> visible) {
  for (const float share : visible) links_[known_++].visible = share;
  measured_ += visible.size();
}

// Light of all links, at the nodes where they end.
void Links::gather() {
  std::ranges::fill(irradiance_, glm::dvec3(0.0));
  for (const Link& link : links_) {
    const double exchange = strength_ * link.exchange * link.visible;
    irradiance_[link.a] += exchange / nodes_[link.a / 2].area * radiosity_[link.b];
    irradiance_[link.b] += exchange / nodes_[link.b / 2].area * radiosity_[link.a];
  }
}

// Light of a node arrives at all parts of it.
void Links::push() {
  for (std::uint32_t i = 0; i < nodes_.size(); ++i)
    for (std::uint32_t k = 0; nodes_[i].first_child && k < 4; ++k)
      for (std::uint32_t side = 0; side < 2; ++side)
        irradiance_[2 * (nodes_[i].first_child + k) + side] += irradiance_[2 * i + side];
}

// A node sends what its parts send.
void Links::pull() {
  for (std::uint32_t i = static_cast<std::uint32_t>(nodes_.size()); i-- > 0;) {
    const LinkNode& node = nodes_[i];
    if (!node.first_child) continue;
    for (std::uint32_t side = 0; side < 2; ++side) {
      glm::dvec3 power(0.0);
      double lowest = 1e300, highest = 0.0;
      for (std::uint32_t k = 0; k < 4; ++k) {
        const std::uint32_t part = 2 * (node.first_child + k) + side;
        power += nodes_[node.first_child + k].area * radiosity_[part];
        const double middle = sum_of(radiosity_[part]), half = 0.5 * range_[part];
        lowest = std::min(lowest, middle - half), highest = std::max(highest, middle + half);
      }
      radiosity_[2 * i + side] = node.area > 0.0 ? power / node.area : glm::dvec3(0.0);
      range_[2 * i + side] = highest - lowest;
    }
  }
}

// Largest eigenvalue of the form factors, by power iteration with Rayleigh quotients: areas times form factors are
// symmetric. It is 1 in a closed scene, if they are exact.
double Links::largest_eigenvalue() {
  std::ranges::fill(radiosity_, glm::dvec3(1.0));
  double eigenvalue = 0.0;
  for (int i = 0; i < kPowerIterations; ++i) {
    double before = 0.0, after = 0.0;
    pull();
    gather();
    push();
    for (std::uint32_t n = 0; n < nodes_.size(); ++n)
      for (std::uint32_t face = 2 * n; nodes_[n].first_child == 0 && face < 2 * n + 2; ++face) {
        before += nodes_[n].area * radiosity_[face].r * radiosity_[face].r;
        after += nodes_[n].area * radiosity_[face].r * irradiance_[face].r;
        radiosity_[face] = irradiance_[face];
      }
    eigenvalue = before > 0.0 ? after / before : 0.0;
  }
  return eigenvalue;
}

// Faces take what their patches have got, and send on their share of it. Returns the power that is new in that.
double Links::reflect() {
  double unsent = 0.0;
  for (std::uint32_t i = 0; i < nodes_.size(); ++i)
    for (std::uint32_t side = 0; nodes_[i].first_child == 0 && side < 2; ++side) {
      Face& face = faces_[2 * nodes_[i].patch + side];
      const glm::dvec3& got = irradiance_[2 * i + side];
      const glm::dvec3 reflectance = reflects_ ? face.reflectance : glm::dvec3(0.0);
      unsent += face.area * sum_of(reflectance * glm::abs(got - face.irradiance));
      face.irradiance = got;
      const double covered = nodes_[i].area > 0.0 ? face.area / nodes_[i].area : 0.0; // by what is no hole
      radiosity_[2 * i + side] = covered * (face.unshot + reflectance * got);
    }
  return unsent;
}

// Iterations begin with the light of the last solution. Inexact form factors may add up to more than 1. Where faces
// reflect nearly all light, it would grow from bounce to bounce; then all links are weakened until none does.
void Links::solve() {
  strength_ = 1.0;
  std::ranges::fill(range_, 0.0);
  for (std::uint32_t i = 0; i < nodes_.size(); ++i)
    for (std::uint32_t side = 0; nodes_[i].first_child == 0 && side < 2; ++side)
      irradiance_[2 * i + side] = faces_[2 * nodes_[i].patch + side].irradiance;
  for (Face& face : faces_) face.irradiance = glm::dvec3(0.0);
  double before = 0.0; // power that was unsent an iteration earlier
  for (std::uint32_t i = 0; i < kMostIterations; ++i) {
    unsent_ = reflect();
    if (i > 0 && unsent_ <= kSettled * power_) break;
    if (i > kFirstIterations && unsent_ > kMostReflected * before && strength_ == 1.0) {
      strength_ = kMostReflected / std::max(largest_eigenvalue(), kMostReflected + 1e-9);
      std::ranges::fill(irradiance_, glm::dvec3(0.0));
      continue;
    }
    before = unsent_;
    pull();
    gather();
    push();
  }
}

// A part of a face gets other light than its mean if form factors of points differ; and sends other light to a place
// than its mean if its own radiosity differs where they do. A link that something stands in is cut at its larger face:
// by how much of it is seen, of which few rays tell. They also miss small holes and small things, so none is certain.
Links::Cut Links::best_cut(const Link& link) const {
  constexpr double kRays = gpu::kBlockRays;
  const double certain = (kRays * link.visible + 0.5) / (kRays + 1.0);
  const double exchange = link.exchange, unknown = 2.0 * certain * (1.0 - certain);
  // Radiosity differs over a face: its bright parts may be those that form factors and rays tell nothing of.
  const auto differs = [&](double spread, std::uint32_t face) {
    return range_[face] * std::min(1.0, 0.5 * spread * certain + unknown);
  };
  const double light_a = sum_of(radiosity_[link.a]), light_b = sum_of(radiosity_[link.b]);
  const bool a_is_larger = nodes_[link.a / 2].area >= nodes_[link.b / 2].area;
  const bool a_is_whole = nodes_[link.a / 2].first_child == 0, b_is_whole = nodes_[link.b / 2].first_child == 0;
  const double stopped = exchange * unknown * std::max(light_a, light_b);
  double of_a = exchange * (link.spread_a * certain * light_b + differs(link.spread_a, link.a));
  double of_b = exchange * (link.spread_b * certain * light_a + differs(link.spread_b, link.b));
  (b_is_whole || (a_is_larger && !a_is_whole) ? of_a : of_b) += stopped;
  if (a_is_whole) of_a = 0.0;
  if (b_is_whole) of_b = 0.0;
  return of_a >= of_b ? Cut{of_a, true} : Cut{of_b, false};
}

// Cuts those that may put the most power in the wrong place, until the number of links has grown.
void Links::cut_links() {
  const double least = kLeastGain * power_;
  std::vector<std::pair<double, std::uint32_t>> order;
  for (std::uint32_t i = 0; i < links_.size(); ++i)
    if (const double gain = best_cut(links_[i]).gain; gain > least) order.emplace_back(gain, i);
  std::ranges::sort(
      order, [](const auto& x, const auto& y) { return x.first != y.first ? x.first > y.first : x.second < y.second; });
  const auto grown = static_cast<std::uint64_t>(kGrowth * static_cast<double>(std::max<std::uint64_t>(measured_, 64)));
  const std::uint64_t allowed = std::min(most_, grown);
  std::vector<std::uint8_t> is_cut(links_.size(), 0);
  const std::size_t before = links_.size();
  for (const auto& [gain, i] : order) {
    if (measured_ + (links_.size() - before) + 4 > allowed) break;
    const Link link = links_[i];
    const bool of_a = best_cut(link).of_a;
    const std::uint32_t whole = of_a ? link.a : link.b, other = of_a ? link.b : link.a;
    is_cut[i] = 1;
    for (std::uint32_t k = 0; k < 4; ++k) add(2 * (nodes_[whole / 2].first_child + k) + (whole & 1u), other);
  }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < links_.size(); ++i)
    if (i >= before || !is_cut[i]) links_[kept++] = links_[i];
  known_ = before - static_cast<std::size_t>(std::ranges::count(is_cut, 1));
  links_.resize(kept);
}

std::vector<glm::dvec3> Links::irradiance() const {
  std::vector<glm::dvec3> result;
  result.reserve(faces_.size());
  for (const Face& face : faces_) result.push_back(face.irradiance);
  return result;
}

double Links::absorbed(const std::vector<glm::dvec3>& irradiance) const {
  return power_ > 0.0 ? absorbed_power(faces_, irradiance) / power_ : 0.0;
}

double Links::remaining() const { return power_ > 0.0 ? unsent_ / power_ : 0.0; }

// Power that is neither absorbed nor still to be sent on. Without reflections, all that arrives stays.
double Links::lost() const {
  if (!(power_ > 0.0)) return 0.0;
  double kept = unsent_;
  for (const Face& face : faces_)
    kept += face.area * sum_of((reflects_ ? 1.0 - face.reflectance : glm::dvec3(1.0)) * face.irradiance);
  return 1.0 - kept / power_;
}

} // namespace wavepath
