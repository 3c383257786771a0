#include "host/integrators/radiosity/links.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace wavepath {
namespace {

constexpr double kSettled = 1e-5;         // share of the power by which light still changes when it is solved
constexpr int kMostIterations = 2000;     // surfaces that reflect all would go on for ever
constexpr double kMostReflected = 0.9995; // of the light that a face gets, or light would grow
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
      radiosity_(2 * nodes_.size()),
      irradiance_(2 * nodes_.size()),
      range_(2 * nodes_.size()) {
  link_triangles();
}

void Links::add(std::uint32_t a, std::uint32_t b) {
  const Exchange exchange = exchange_of(nodes_, a, b);
  if (!(exchange.area > 0.0)) return;
  links_.push_back({a, b, static_cast<float>(exchange.area), static_cast<float>(exchange.spread_a),
                    static_cast<float>(exchange.spread_b)});
}

void Links::link_triangles() {
  std::vector<std::uint8_t> is_child(nodes_.size(), 0);
  for (const LinkNode& node : nodes_)
    for (std::uint32_t k = 0; node.first_child && k < 4; ++k) is_child[node.first_child + k] = 1;
  std::vector<std::uint32_t> roots;
  for (std::uint32_t i = 0; i < nodes_.size(); ++i)
    if (!is_child[i]) roots.push_back(i);
  for (std::size_t i = 0; i < roots.size(); ++i)
    for (std::size_t j = i + 1; j < roots.size(); ++j)
      for (std::uint32_t sides = 0; sides < 4; ++sides) add(2 * roots[i] + (sides & 1), 2 * roots[j] + (sides >> 1));
}

std::span<const Link> Links::next(std::uint64_t count) {
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
    double exchange = double{link.exchange} * link.visible;
    if (!limits_.empty()) exchange *= std::min(limits_[link.a], limits_[link.b]);
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

// Inexact form factors of a face may add up to more than 1, and light between mirrors of diffuse light would grow from
// bounce to bounce. Links of such faces are weakened.
void Links::limit_factors() {
  limits_.clear();
  std::ranges::fill(radiosity_, glm::dvec3(1.0));
  gather();
  push();
  std::vector<double> limits(irradiance_.size(), 1.0);
  bool is_limited = false;
  for (std::uint32_t i = static_cast<std::uint32_t>(nodes_.size()); i-- > 0;)
    for (std::uint32_t side = 0; side < 2; ++side) {
      const LinkNode& node = nodes_[i];
      double& limit = limits[2 * i + side];
      if (node.first_child) {
        for (std::uint32_t k = 0; k < 4; ++k) limit = std::min(limit, limits[2 * (node.first_child + k) + side]);
        continue;
      }
      const glm::dvec3& reflectance = faces_[2 * node.patch + side].reflectance;
      const double sent_on = irradiance_[2 * i + side].r * std::max({reflectance.r, reflectance.g, reflectance.b});
      if (sent_on <= kMostReflected) continue;
      limit = kMostReflected / sent_on;
      is_limited = true;
    }
  if (is_limited) limits_ = std::move(limits);
}

void Links::solve() {
  limit_factors();
  std::ranges::fill(range_, 0.0);
  std::ranges::fill(irradiance_, glm::dvec3(0.0));
  for (Face& face : faces_) face.irradiance = glm::dvec3(0.0);
  const double power = power_of(faces_);
  for (int i = 0; i < kMostIterations; ++i) {
    double change = 0.0;
    for (std::uint32_t n = 0; n < nodes_.size(); ++n) {
      if (nodes_[n].first_child) continue;
      for (std::uint32_t side = 0; side < 2; ++side) {
        Face& face = faces_[2 * nodes_[n].patch + side];
        const glm::dvec3 gained = irradiance_[2 * n + side] - face.irradiance;
        change += face.area * (std::abs(gained.r) + std::abs(gained.g) + std::abs(gained.b));
        face.irradiance = irradiance_[2 * n + side];
        const glm::dvec3 sent = face.unshot + (reflects_ ? face.reflectance * face.irradiance : glm::dvec3(0.0));
        radiosity_[2 * n + side] = nodes_[n].area > 0.0 ? face.area / nodes_[n].area * sent : glm::dvec3(0.0);
      }
    }
    if (i > 0 && change <= kSettled * power) break;
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
  const double light_a = sum_of(radiosity_[link.a]), light_b = sum_of(radiosity_[link.b]);
  const bool a_is_larger = nodes_[link.a / 2].area >= nodes_[link.b / 2].area;
  const bool a_is_whole = nodes_[link.a / 2].first_child == 0, b_is_whole = nodes_[link.b / 2].first_child == 0;
  const double stopped = exchange * unknown * std::max(light_a, light_b);
  double of_a = exchange * link.spread_a * certain * (light_b + 0.5 * range_[link.a]);
  double of_b = exchange * link.spread_b * certain * (light_a + 0.5 * range_[link.b]);
  (b_is_whole || (a_is_larger && !a_is_whole) ? of_a : of_b) += stopped;
  if (a_is_whole) of_a = 0.0;
  if (b_is_whole) of_b = 0.0;
  return of_a >= of_b ? Cut{of_a, true} : Cut{of_b, false};
}

// Cuts those that may put the most power in the wrong place, until the number of links has grown.
void Links::cut_links() {
  const double least = kLeastGain * power_of(faces_);
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
  const double power = power_of(faces_);
  return power > 0.0 ? absorbed_power(faces_, irradiance) / power : 0.0;
}

// Of what all faces send, and get.
double Links::lost() const {
  const double power = power_of(faces_);
  double lost = power;
  for (const Face& face : faces_) {
    const glm::dvec3 kept = reflects_ ? 1.0 - face.reflectance : glm::dvec3(1.0);
    lost -= face.area * sum_of(kept * face.irradiance);
  }
  return power > 0.0 ? lost / power : 0.0;
}

} // namespace wavepath
