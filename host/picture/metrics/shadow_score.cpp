#include "host/picture/metrics/shadow_score.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "host/picture/files/picture_io.h"

namespace wavepath {
namespace {

// Fractions of a few samples are whole fractions but for rounding, which must not decide: no such fraction is near
// these.
constexpr double kFalse = 0.2503; // of the light without shadows
constexpr double kHalf = 0.4997;
constexpr double kPartly = 0.1; // from this fraction of the light on, up to 1 less it
constexpr double kDark = 1e-3;  // of the typical light: what has less could not be lit
constexpr double kLeast = 0.1;  // of light, in denominators
constexpr double kNever = std::numeric_limits<double>::infinity();

std::vector<double> direct_light(const Picture& picture) {
  std::vector<double> light;
  for (const char* name : {"direct.R", "direct.G", "direct.B"}) {
    const Channel* channel = find_channel(picture, name);
    if (!channel) return {};
    light.resize(channel->values.size());
    for (std::size_t i = 0; i < light.size(); ++i) light[i] += channel->values[i];
  }
  return light;
}

// Median of the light over the pixels that lights reach.
double typical_light(std::vector<double> light) {
  std::erase_if(light, [](double l) { return !(l > 0.0); });
  if (light.empty()) return 0.0;
  const auto middle = light.begin() + static_cast<std::ptrdiff_t>(light.size() / 2);
  std::ranges::nth_element(light, middle);
  return *middle;
}

// Squared distances to the nearest true pixel: along columns first, then the lower envelope of parabolas along rows
// (Felzenszwalb and Huttenlocher 2012).
std::vector<double> squared_distances(const std::vector<bool>& set, std::size_t width, std::size_t height) {
  std::vector<double> distance(set.size());
  const auto sweep = [](std::vector<double>& line) {
    const std::size_t n = line.size();
    std::vector<std::size_t> apex;
    std::vector<double> from;
    const auto crossing = [&](std::size_t p, std::size_t q) {
      const auto a = static_cast<double>(p), b = static_cast<double>(q);
      return ((line[q] + b * b) - (line[p] + a * a)) / (2.0 * (b - a));
    };
    for (std::size_t q = 0; q < n; ++q) {
      if (line[q] == kNever) continue;
      while (!apex.empty() && crossing(apex.back(), q) <= from.back()) {
        apex.pop_back();
        from.pop_back();
      }
      from.push_back(apex.empty() ? -kNever : crossing(apex.back(), q));
      apex.push_back(q);
    }
    if (apex.empty()) return;
    std::vector<double> result(n);
    for (std::size_t q = 0, k = 0; q < n; ++q) {
      while (k + 1 < apex.size() && from[k + 1] < static_cast<double>(q)) ++k;
      const double away = static_cast<double>(q) - static_cast<double>(apex[k]);
      result[q] = away * away + line[apex[k]];
    }
    line = std::move(result);
  };
  for (std::size_t i = 0; i < set.size(); ++i) distance[i] = set[i] ? 0.0 : kNever;
  std::vector<double> column(height), row(width);
  for (std::size_t x = 0; x < width; ++x) {
    for (std::size_t y = 0; y < height; ++y) column[y] = distance[y * width + x];
    sweep(column);
    for (std::size_t y = 0; y < height; ++y) distance[y * width + x] = column[y];
  }
  for (std::size_t y = 0; y < height; ++y) {
    std::copy_n(distance.begin() + static_cast<std::ptrdiff_t>(y * width), width, row.begin());
    sweep(row);
    std::ranges::copy(row, distance.begin() + static_cast<std::ptrdiff_t>(y * width));
  }
  return distance;
}

// Fraction of the light that arrives, by pixel; below 0 where none could.
using Fractions = std::vector<double>;

Fractions lit_fractions(const ShadowedPicture& picture) {
  const std::vector<double> light = direct_light(picture.shadowed), whole = direct_light(picture.unshadowed);
  if (whole.empty() || light.size() != whole.size()) return {};
  const double dark = kDark * typical_light(whole);
  Fractions fractions(whole.size(), -1.0);
  for (std::size_t i = 0; i < whole.size(); ++i)
    if (whole[i] > dark) fractions[i] = light[i] / whole[i];
  return fractions;
}

// Pixels that are half lit or more, next to one that is less.
std::vector<bool> edges(const Fractions& fractions, std::size_t width) {
  std::vector<bool> found(fractions.size());
  const auto differs = [&](std::size_t a, std::size_t b) {
    return fractions[a] >= kHalf && fractions[b] >= 0.0 && fractions[b] < kHalf;
  };
  for (std::size_t i = 0; i < fractions.size(); ++i) {
    const bool right = i % width + 1 < width, below = i + width < fractions.size();
    if (right && differs(i, i + 1)) found[i] = true;
    if (right && differs(i + 1, i)) found[i + 1] = true;
    if (below && differs(i, i + width)) found[i] = true;
    if (below && differs(i + width, i)) found[i + width] = true;
  }
  return found;
}

double partly_lit(const Fractions& fractions) {
  return static_cast<double>(
      std::ranges::count_if(fractions, [](double s) { return s > kPartly && s < 1.0 - kPartly; }));
}

} // namespace

std::optional<ShadowScore> score_shadows(const ShadowedPicture& picture, const ShadowedPicture& truth) {
  const Fractions ours = lit_fractions(picture), theirs = lit_fractions(truth);
  if (ours.empty() || ours.size() != theirs.size()) return std::nullopt;
  const std::vector<double> light = direct_light(truth.unshadowed);
  const double typical = typical_light(light);
  double judged = 0.0, squares = 0.0;
  ShadowScore score;
  for (std::size_t i = 0; i < ours.size(); ++i) {
    if (ours[i] < 0.0 || theirs[i] < 0.0) continue;
    ++judged;
    const double off = (ours[i] - theirs[i]) * light[i], right = theirs[i] * light[i],
                 least = kLeast * std::max(light[i], typical);
    squares += off * off / (right * right + least * least);
    if (ours[i] - theirs[i] > kFalse) ++score.falsely_lit;
    if (theirs[i] - ours[i] > kFalse) ++score.falsely_dark;
  }
  if (judged == 0.0) return score;
  score.relative_rms = std::sqrt(squares / judged);
  score.falsely_lit /= judged;
  score.falsely_dark /= judged;
  const std::size_t width = truth.shadowed.width, height = truth.shadowed.height;
  const std::vector<bool> mine = edges(ours, width), true_ones = edges(theirs, width);
  if (std::ranges::count(mine, true) > 0 && std::ranges::count(true_ones, true) > 0) {
    const std::vector<double> away = squared_distances(true_ones, width, height);
    double sum = 0.0, count = 0.0;
    for (std::size_t i = 0; i < mine.size(); ++i)
      if (mine[i]) sum += std::sqrt(away[i]), ++count;
    score.edge_displacement = sum / count;
  }
  if (const double area = partly_lit(theirs); area > 0.0) score.penumbra_ratio = partly_lit(ours) / area;
  return score;
}

Picture false_shadow_map(const ShadowedPicture& picture, const ShadowedPicture& truth) {
  constexpr double kGrey = 0.6; // of what is fully lit
  const Fractions ours = lit_fractions(picture), theirs = lit_fractions(truth);
  Picture map{truth.shadowed.width, truth.shadowed.height, {}};
  if (ours.empty() || ours.size() != theirs.size()) return map;
  for (const char* name : {"R", "G", "B"}) map.channels.push_back({name, std::vector<float>(ours.size())});
  for (std::size_t i = 0; i < ours.size(); ++i) {
    const bool judged = ours[i] >= 0.0 && theirs[i] >= 0.0;
    const double difference = judged ? std::clamp(ours[i] - theirs[i], -1.0, 1.0) : 0.0;
    const double grey = kGrey * std::clamp(theirs[i], 0.0, 1.0) * (1.0 - std::abs(difference));
    const double lit = std::max(difference, 0.0), dark = std::max(-difference, 0.0);
    map.channels[0].values[i] = static_cast<float>(grey + lit + 0.1 * dark);
    map.channels[1].values[i] = static_cast<float>(grey + 0.55 * lit + 0.4 * dark);
    map.channels[2].values[i] = static_cast<float>(grey + dark);
  }
  return map;
}

} // namespace wavepath
