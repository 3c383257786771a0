// The progress line, and how it is printed.
#include "host/cli/progress.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <string_view>

#include <sys/ioctl.h>
#include <unistd.h>

#include <fmt/format.h>

#include "host/base/print.h"
#include "host/film/error.h"

namespace wavepath {
namespace {

constexpr std::chrono::milliseconds kRedraw{100}, kLineInterval{5000};

// Seconds left until the first limit ends the render. The error is assumed to go on falling at its present rate.
double seconds_left(const Progress& progress, double time_limit, double target_error) {
  double left = std::numeric_limits<double>::infinity();
  if (progress.fraction > 0.0) left = progress.seconds * (1.0 - progress.fraction) / progress.fraction;
  if (time_limit > 0.0) left = std::min(left, time_limit - progress.seconds);
  if (target_error > 0.0 && progress.error.relative_rms > 0.0) {
    const double ratio = progress.error.relative_rms / target_error;
    left = std::min(left, progress.seconds * (growth_for(ratio, progress.slope) - 1.0));
  }
  return std::max(left, 0.0);
}

// With a time limit or a target error, samples seldom end the render: then it is the fraction of the time.
double fraction_done(const Progress& progress, double left) {
  return progress.seconds + left > 0.0 && std::isfinite(left) ? progress.seconds / (progress.seconds + left)
                                                              : progress.fraction;
}

// Empty, or with a space behind it.
std::string bar(double done, int width) {
  if (width <= 0) return {};
  const int filled = std::clamp(static_cast<int>(std::lround(done * width)), 0, width);
  return "[" + std::string(static_cast<std::size_t>(filled), '#') +
         std::string(static_cast<std::size_t>(width - filled), '.') + "] ";
}

int terminal_width() {
  winsize size{};
  return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

} // namespace

std::string duration_text(double seconds) {
  const auto whole = static_cast<long long>(std::min(seconds, 1e9));
  if (seconds < 60.0) return fmt::format("{:.1f} s", seconds);
  if (seconds < 3600.0) return fmt::format("{}:{:02} min", whole / 60, whole % 60);
  return fmt::format("{}:{:02}:{:02} h", whole / 3600, whole / 60 % 60, whole % 60);
}

std::string progress_text(const Progress& progress, double time_limit, double target_error, int bar_width) {
  const double left = seconds_left(progress, time_limit, target_error);
  const double done = fraction_done(progress, left);
  std::string text = bar(done, bar_width);
  text += fmt::format("{:3.0f} %  {}/{} spp  {} elapsed", 100.0 * done, progress.spp_done, progress.spp_planned,
                      duration_text(progress.seconds));
  if (std::isfinite(left)) text += fmt::format(", {} left", duration_text(left));
  text += fmt::format("  {:.2f} Mrays/s", progress.mrays_per_second);
  if (progress.error.relative_rms > 0.0) text += fmt::format("  error {:.2g} %", 100.0 * progress.error.relative_rms);
  return text;
}

std::string progress_text(const Progress& progress, const FramesDone& frames, double seconds, double time_limit,
                          double target_error, int bar_width) {
  const double of_frame = fraction_done(progress, seconds_left(progress, time_limit, target_error));
  const double done = (static_cast<double>(frames.before) + of_frame) / static_cast<double>(frames.count);
  std::string text = bar(done, bar_width);
  text += fmt::format("{:3.0f} %  frame {} ({} of {})  {}/{} spp  {} elapsed", 100.0 * done, frames.number,
                      frames.before + 1, frames.count, progress.spp_done, progress.spp_planned, duration_text(seconds));
  if (done > 0.0) text += fmt::format(", {} left", duration_text(seconds * (1.0 - done) / done));
  return text + fmt::format("  {:.2f} Mrays/s", progress.mrays_per_second);
}

ProgressDisplay::ProgressDisplay(bool quiet, double time_limit, double target_error)
    : quiet_(quiet), time_limit_(time_limit), target_error_(target_error), last_(Clock::now()) {
  const char* kind = std::getenv("TERM");
  terminal_ = isatty(STDERR_FILENO) != 0 && kind != nullptr && std::string_view(kind) != "dumb";
}

void ProgressDisplay::clear() {
  if (drawn_ && terminal_) write_err("\r\x1b[K");
  drawn_ = false;
}

void ProgressDisplay::begin_frame(const FramesDone& frames) {
  if (!frames_) begun_ = Clock::now();
  frames_ = frames;
}

void ProgressDisplay::show(const Progress& progress) {
  if (meanwhile_) meanwhile_();
  const Clock::time_point now = Clock::now();
  if (quiet_ || now - last_ < (terminal_ ? kRedraw : kLineInterval)) return;
  last_ = now;
  drawn_ = true;
  const auto text = [&](int bar_width) {
    return frames_ ? progress_text(progress, *frames_, seconds_since(begun_), time_limit_, target_error_, bar_width)
                   : progress_text(progress, time_limit_, target_error_, bar_width);
  };
  if (!terminal_) {
    print_err("wavepath: {}\n", text(0));
    return;
  }
  const std::size_t width = static_cast<std::size_t>(terminal_width() - 1);
  print_err("\r\x1b[K{}", text(20).substr(0, width));
}

} // namespace wavepath
