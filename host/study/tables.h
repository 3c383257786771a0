// Tables of a study's results: every configuration at one time, and the times to common errors.
#pragma once

#include "host/study/fit.h"
#include "host/study/study.h"

namespace wavepath {

// Relative RMS error against seconds, or against samples a pixel; points without error are left out.
std::vector<Measured> error_by_seconds(const Series& series);
std::vector<Measured> error_by_spp(const Series& series);
// The same without points whose error is mostly the reference's: those that a slope may be fitted to.
std::vector<Measured> above_floor(const Study& study, const Series& series, std::vector<Measured> points);

// The error at which a biased configuration no longer improves: over the last two octaves, which halve the error of
// plain Monte Carlo, it lost less than a fifth. No power law fits that.
std::optional<double> levels_off(const Series& series);

// The power law that a configuration follows; nothing where it follows none, or too little was measured.
std::optional<PowerFit> fit_of(const Study& study, const Series& series, std::vector<Measured> points);

// Interpolated to one time; ratios are to the first, naive configuration: below 1 is better.
struct EqualTimeRow {
  double relative_rms = 0.0, mse = 0.0, relmse = 0.0, mrse = 0.0, flip = 0.0;
  double efficiency = 0.0; // 1 / (MSE seconds)
  std::optional<double> ratio;
  std::optional<double> scatter; // see PowerFit::scatter
  bool as_good_as_best = false;  // the difference to the best is within the scatter of the two
  bool at_floor = false;
};

struct EqualTime {
  double seconds = 0.0;                          // the longest that every configuration was rendered for
  std::vector<std::optional<EqualTimeRow>> rows; // for each of Study::series; empty if its first sample took longer
};
EqualTime equal_time(const Study& study);

struct EqualErrorRow {
  TimeTo time;
  std::optional<double> speedup; // seconds of the naive configuration over these
};

struct EqualError {
  double relative_rms = 0.0;
  std::vector<EqualErrorRow> rows; // for each of Study::series
};
// At round errors (1, 2, 5, ...) that at least half of the configurations passed while being measured: the lowest
// three. Where there is none, at the median of the errors that were reached.
std::vector<EqualError> equal_error(const Study& study);

// The picture of `series` that was rendered in about this time; null if it has none.
const StudyPicture* picture_near(const Series& series, double seconds);

} // namespace wavepath
