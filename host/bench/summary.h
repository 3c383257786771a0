// Summarizes repetitions of a measurement by median and spread, which other load on the machine changes little.
#pragma once

#include <vector>

namespace wavepath {

struct Summary {
  double median = 0.0;
  double spread = 0.0; // interquartile range over the median
};

// Summarizes values, at least one.
Summary summarize(std::vector<double> values);

// Medians of a and b, measured in turns: a over b.
double ratio_of_medians(const std::vector<double>& a, const std::vector<double>& b);

} // namespace wavepath
