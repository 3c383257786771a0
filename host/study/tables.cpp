#include "host/study/tables.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace wavepath {
namespace {

template <class X, class Y>
std::vector<Measured> curve(const Series& series, X x, Y y) {
  std::vector<Measured> points;
  for (const StudyPoint& point : series.points)
    if (y(point) > 0.0) points.push_back({static_cast<double>(x(point)), y(point)});
  return points;
}

// Errors of pictures of light and of pictures of occlusion have nothing in common; a table is of the first one's kind.
bool comparable(const Study& study, const Series& series) {
  return series.shows_occlusion() == study.series.front().shows_occlusion();
}

double seconds_of(const StudyPoint& point) { return point.seconds; }

std::optional<EqualTimeRow> row_at(const Study& study, const Series& series, double seconds) {
  const auto at = [&](auto metric) { return value_at(curve(series, seconds_of, metric), seconds); };
  const std::optional<double> relmse = at([](const StudyPoint& p) { return p.metrics.relmse; });
  if (!relmse) return std::nullopt;
  EqualTimeRow row;
  row.relmse = *relmse;
  row.relative_rms = std::sqrt(*relmse);
  row.mse = at([](const StudyPoint& p) { return p.metrics.mse; }).value_or(0.0);
  row.mrse = at([](const StudyPoint& p) { return p.metrics.mrse; }).value_or(0.0);
  row.flip = at([](const StudyPoint& p) { return p.flip; }).value_or(0.0);
  row.efficiency = 1.0 / (row.mse * seconds);
  if (const auto fit = fit_of(study, series, error_by_seconds(series))) row.scatter = fit->scatter;
  row.at_floor = study.at_floor(series, row.relative_rms);
  return row;
}

// Scatters of two independent measurements add in squares.
bool within_scatter(const EqualTimeRow& a, const EqualTimeRow& b) {
  const double difference = std::abs(std::log(a.relative_rms / b.relative_rms));
  return a.scatter && b.scatter && difference <= std::hypot(*a.scatter, *b.scatter);
}

std::vector<double> levels(const std::vector<std::vector<Measured>>& curves) {
  std::vector<double> found;
  const auto measured = static_cast<std::size_t>(
      std::count_if(curves.begin(), curves.end(), [](const std::vector<Measured>& curve) { return !curve.empty(); }));
  for (int exponent = 2; exponent >= -8; --exponent)
    for (const double digit : {5.0, 2.0, 1.0}) {
      const double level = digit * std::pow(10.0, exponent);
      const auto passed = std::count_if(curves.begin(), curves.end(), [&](const std::vector<Measured>& curve) {
        return time_to(curve, level).how == Reach::interpolated;
      });
      if (passed > 0 && 2 * static_cast<std::size_t>(passed) >= measured) found.push_back(level);
    }
  constexpr std::size_t kMostLevels = 3;
  if (found.size() > kMostLevels) found.erase(found.begin(), found.end() - kMostLevels);
  if (!found.empty()) return found;
  std::vector<double> last;
  for (const std::vector<Measured>& curve : curves)
    if (!curve.empty()) last.push_back(curve.back().y);
  if (last.empty()) return {};
  std::sort(last.begin(), last.end());
  return {last[last.size() / 2]};
}

} // namespace

std::vector<Measured> error_by_seconds(const Series& series) {
  return curve(series, seconds_of, [](const StudyPoint& p) { return p.relative_rms(); });
}

std::vector<Measured> error_by_spp(const Series& series) {
  return curve(
      series, [](const StudyPoint& p) { return p.spp; }, [](const StudyPoint& p) { return p.relative_rms(); });
}

std::vector<Measured> above_floor(const Study& study, const Series& series, std::vector<Measured> points) {
  std::erase_if(points, [&](const Measured& point) { return study.at_floor(series, point.y); });
  return points;
}

std::optional<double> levels_off(const Series& series) {
  constexpr std::size_t kOctaves = 2;
  constexpr double kFall = 0.8;
  const std::vector<Measured> points = error_by_spp(series);
  if (!series.is_biased() || points.size() <= kOctaves) return std::nullopt;
  const double last = points.back().y, before = points[points.size() - 1 - kOctaves].y;
  return last > kFall * before ? std::optional(last) : std::nullopt;
}

std::optional<PowerFit> fit_of(const Study& study, const Series& series, std::vector<Measured> points) {
  return levels_off(series) ? std::nullopt : fit_power(above_floor(study, series, std::move(points)));
}

EqualTime equal_time(const Study& study) {
  EqualTime table{std::numeric_limits<double>::infinity(), {}};
  for (const Series& series : study.series)
    if (comparable(study, series) && !series.points.empty())
      table.seconds = std::min(table.seconds, series.points.back().seconds);
  for (const Series& series : study.series)
    table.rows.push_back(comparable(study, series) ? row_at(study, series, table.seconds) : std::nullopt);
  const EqualTimeRow* best = nullptr;
  for (const auto& row : table.rows)
    if (row && (!best || row->relative_rms < best->relative_rms)) best = &*row;
  for (auto& row : table.rows) {
    if (!row) continue;
    if (table.rows.front()) row->ratio = row->relative_rms / table.rows.front()->relative_rms;
    row->as_good_as_best = &*row == best || within_scatter(*row, *best);
  }
  return table;
}

std::vector<EqualError> equal_error(const Study& study) {
  std::vector<std::vector<Measured>> curves;
  for (const Series& series : study.series)
    curves.push_back(comparable(study, series) ? error_by_seconds(series) : std::vector<Measured>{});
  std::vector<EqualError> tables;
  for (const double level : levels(curves)) {
    EqualError& table = tables.emplace_back(EqualError{level, {}});
    for (std::size_t i = 0; i < curves.size(); ++i) {
      TimeTo time = time_to(curves[i], level);
      if (time.how == Reach::extrapolated && levels_off(study.series[i])) time = {}; // it will not go on
      table.rows.push_back({time, {}});
    }
    const auto known = [](const TimeTo& t) { return t.how == Reach::interpolated || t.how == Reach::extrapolated; };
    const TimeTo naive = table.rows.front().time;
    for (EqualErrorRow& row : table.rows)
      if (known(naive) && known(row.time)) row.speedup = naive.x / row.time.x;
  }
  return tables;
}

const StudyPicture* picture_near(const Series& series, double seconds) {
  const auto distance = [&](const StudyPicture& p) {
    return std::abs(std::log(series.points[p.point].seconds / seconds));
  };
  const auto nearest = std::ranges::min_element(series.pictures, {}, distance);
  return nearest == series.pictures.end() ? nullptr : &*nearest;
}

} // namespace wavepath
