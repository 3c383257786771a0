#include "host/plan/integrator.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "host/gpu/device_limit.h"
#include "host/plan/lamps_in_sight.h"
#include "host/render/agreement.h"
#include "host/render/lost_light.h"
#include "host/render/pilot_work.h"
#include "host/render/settings/settings_table.h"
#include "host/render/workspace/light_training.h"

namespace wavepath {
namespace {

// How long a pilot is. Two iterations of guiding are enough to see that it does not pay; where it does, the field of
// the whole render, which learns for longer, is better still.
struct Round {
  const PilotRow& row;
  std::uint32_t guide_iterations;
};
constexpr Round kFirstRound{kIntegratorPilot, 2};
constexpr Round kSecondRound{kIntegratorPilotAgain, kGuideIterations};
constexpr double kWorkOverSecond = 10.0; // of the render; guiding and paths from both ends cost more than paths tell
constexpr std::uint32_t kSecondOverFirst = kIntegratorPilotAgain.samples / kIntegratorPilot.samples;
constexpr double kAlike = 2.0; // of costs after 16 samples: either may be the lower one
// Errors of the first trial. Where it is below kEasy, nothing else is tried; above kHard and kHopeless, trials may cost
// more of the render, because such scenes gain by factors.
constexpr double kEasy = 0.1, kHard = 1.0, kHopeless = 3.0;
constexpr double kWholeOverTrials = 20.0, kWholeOverTrialsIfHard = 2.0, kWholeOverTrialsIfHopeless = 1.0;
// The other trials: in work of the first one, that of guiding counting for what it learns from; and compiling their
// kernels, in camera rays: 1.2 s on llvmpipe (its cache has them), which takes 90 to 470 ns for one. Nobody timed a
// GPU.
constexpr double kTrialsOverFirst = 6.0, kCpuKernels = 5e6, kGpuKernels = 2.5e9;
// A trial that lacks more light than this, beyond four standard errors, does not find all of it, however smooth it is.
constexpr double kMissing = 0.01, kSure = 4.0;
constexpr double kNever = 1e30; // a cost that no other exceeds
// Pictures that seem to differ both ways are looked at again with other random numbers.
constexpr std::uint32_t kSeedOfConfirmation = 0x6c8e9cf5u;

// Below this, lamps count as hidden. Generated scenes with a lamp in a shade or in a globe of glass have 0 to 0.15,
// others 0.38 to 0.98 (benchmarks/generated_scenes.py).
constexpr double kHiddenLamps = 0.2;

// Whether lamps alone light the scene, few of them, and hardly any of their light arrives straight: paths from the
// camera then find it by chance. Over `path`, `bidirectional` takes 0.005x to 0.9x of squared error times seconds (two
// shades, a globe, a slit, a door, Veach's door). Of many lamps most are in other rooms, where light paths are lost;
// and thin panes let shadow rays pass.
bool hides_lamps(const PackedScene& scene, const View& view) {
  if (scene.local_light_count != scene.lights.size() || !scene.light_tree.empty() ||
      (scene.features & (gpu::kFeatureEnvironment | gpu::kFeaturePanes)) != 0)
    return false;
  const std::optional<double> in_sight = lamps_in_sight(scene, view);
  return in_sight && *in_sight < kHiddenLamps;
}

RenderPlan pilot_of(const RenderPlan& settings, const Round& round = kFirstRound) {
  RenderPlan pilot = PilotRunner::settings_of(round.row, settings);
  pilot.training.guide_iterations = round.guide_iterations;
  return pilot;
}

// How many times the paths of a pilot the whole render has.
double length_of(const RenderPlan& settings, DeviceClass device) {
  return expected_paths(settings, device) / paths_of(pilot_of(settings));
}

struct Tried {
  RenderPlan settings; // of the whole render
  RenderResult result;
  PictureLight light;
  double steady = 0.0, learned = 0.0; // work of the pilot: for its samples, and for what came before them
  double work = 0.0;                  // of its samples, and as much of training as they have to bear
};

// Of the work from which a trial learned, what the samples of the trial have to bear: a whole render learns once, and
// of guiding that pays for longer, since each iteration after the second has twice as many paths.
double training_fraction(const RenderPlan& settings, const RenderResult& trial, const Round& round) {
  const bool longer = trial.guide && trial.guide->used;
  const double length = longer ? std::exp2(static_cast<double>(kGuideIterations - round.guide_iterations)) : 1.0;
  return length * paths_of(pilot_of(settings, round)) / paths_of(settings);
}

// Whether to try the others after the first, in a render `length` times as long as a pilot.
bool tries_others(const Tried& first, double length, bool may_lack_light, DeviceClass device) {
  const double error = first.result.error.relative_rms;
  if (may_lack_light || error < kEasy) return may_lack_light;
  const double trials = kTrialsOverFirst * first.work + (is_cpu(device) ? kCpuKernels : kGpuKernels);
  const double whole_over_trials = error > kHopeless ? kWholeOverTrialsIfHopeless
                                   : error > kHard   ? kWholeOverTrialsIfHard
                                                     : kWholeOverTrials;
  return length * first.work >= whole_over_trials * trials;
}

double cost_of(const Tried& pilot) {
  const double error = pilot.result.error.relative_rms;
  return error * error * pilot.work;
}

// Of the logarithm of the cost: half the width of its 95 % interval.
double doubt_of(const Tried& pilot) {
  const ErrorEstimate& error = pilot.result.error;
  return error.relative_rms > 0.0 ? 2.0 * std::log(error.ci95[1] / error.relative_rms) : 0.0;
}

// Against the first and the brightest of the pilots.
Trial judge(const Tried& pilot, const Tried& first, const PictureLight& brightest) {
  Trial trial{.flags = candidate_text(pilot.settings)};
  const double ours = cost_of(pilot), theirs = cost_of(first);
  trial.cost = theirs > 0.0 ? ours / theirs : ours > 0.0 ? kNever : 1.0; // a black picture is as good as another
  const double doubt = &pilot == &first ? 0.0 : std::hypot(doubt_of(pilot), doubt_of(first));
  trial.lo = trial.cost * std::exp(-doubt);
  trial.hi = std::min(trial.cost * std::exp(doubt), kNever);
  const double gap = brightest.sum - pilot.light.sum;
  if (gap > kSure * std::sqrt(brightest.variance + pilot.light.variance) && gap > kMissing * brightest.sum)
    trial.missing = gap / brightest.sum;
  return trial;
}

// The cheapest of those that find all light. The first one is left only for one that is cheaper by more than a standard
// error, half of the interval's.
std::size_t best_of(const std::vector<Trial>& trials) {
  std::size_t best = 0;
  for (std::size_t i = 1; i < trials.size(); ++i) {
    const Trial &trial = trials[i], &so_far = trials[best];
    if (trial.missing > 0.0 || trial.disagrees) continue;
    const bool surely = std::sqrt(trial.cost * trial.hi) < 1.0;
    if (so_far.missing > 0.0 || (surely && trial.cost < so_far.cost)) best = i;
  }
  return best;
}

// Those other than the first whose costs may be alike, the best one among them. Guiding is worth more than two
// iterations show: behind a door it costs half of what else is best, and 16 samples tell so every other time.
std::vector<std::size_t> contenders(const std::vector<Trial>& trials, std::size_t best) {
  std::vector<std::size_t> found;
  for (std::size_t i = 1; i < trials.size(); ++i)
    if (trials[i].missing == 0.0 && trials[i].cost <= kAlike * trials[best].cost) found.push_back(i);
  return found;
}

// Whether to try those again, in a render `length` times as long as a pilot.
bool tries_again(const std::vector<Tried>& pilots, const std::vector<std::size_t>& which, double length,
                 DeviceClass device) {
  if (which.size() < 2 || !is_affordable(kIntegratorPilotAgain, pilots.front().settings, device)) return false;
  double work = 0.0, cheapest = std::numeric_limits<double>::infinity();
  for (const std::size_t i : which) {
    cheapest = std::min(cheapest, pilots[i].work);
    constexpr double kLonger = 1u << (kSecondRound.guide_iterations - kFirstRound.guide_iterations);
    work += kSecondOverFirst * pilots[i].steady + kLonger * pilots[i].learned;
  }
  return length * cheapest >= kWorkOverSecond * work;
}

// Why that was taken; empty where nothing but the choice is to be told.
std::string reason_of(const IntegratorChoice& choice) {
  if (choice.hidden_lamps) return "the render is short, and lamps are hidden";
  if (choice.trials.empty()) return choice.too_large.empty() ? "the render is short" : "";
  const Trial &taken = choice.trials[choice.taken], &first = choice.trials.front();
  if (choice.taken == 0 && first.missing > 0.0 && !choice.disagreement.empty()) return "";
  if (choice.taken > 0 && first.missing > 0.0)
    return fmt::format("{} lacks {:.3g} % of the light", first.flags, 100.0 * first.missing);
  if (choice.taken > 0)
    return fmt::format("a given error costs {:.2g} ({:.2g} to {:.2g}) of the work of {}", taken.cost, taken.lo,
                       taken.hi, first.flags);
  if (choice.trials.size() == 1 && !choice.refused.empty()) return "";
  if (choice.trials.size() == 1) return "the others would cost more than they may gain";
  const auto second = std::min_element(choice.trials.begin() + 1, choice.trials.end(),
                                       [](const Trial& a, const Trial& b) { return a.cost < b.cost; });
  return fmt::format("a given error costs {} {:.2g} ({:.2g} to {:.2g}) times the work", second->flags, second->cost,
                     second->lo, second->hi);
}

// What could not be tried, as clauses.
std::vector<std::string> exceptions_of(const IntegratorChoice& choice) {
  std::vector<std::string> clauses;
  if (!choice.too_large.empty())
    clauses.push_back(fmt::format("there is too little memory for {}", fmt::join(choice.too_large, " or ")));
  if (!choice.refused.empty())
    clauses.push_back(fmt::format("the device's limits rule out {}", fmt::join(choice.refused, " and ")));
  return clauses;
}

} // namespace

std::string candidate_text(const RenderPlan& settings) {
  std::string text(settings.integrator->name);
  for (const Setting& row : settings_table())
    if (row.decides == Decides::picture && row.supported_by != SupportedBy::all && is_supported(row, settings) &&
        !is_default(row, settings))
      text += " " + flag_text(row, settings);
  return text;
}

std::vector<RenderPlan> candidates_of(const RenderPlan& settings, const PackedScene& scene) {
  std::vector<RenderPlan> all;
  for (const IntegratorKind* kind : integrators())
    if (kind->candidates) std::ranges::copy(kind->candidates(settings, scene), std::back_inserter(all));
  return all;
}

IntegratorChoice choose_integrator(PilotRunner& pilots, const RenderPlan& settings,
                                   const std::function<bool(const RenderPlan&)>& fits) {
  IntegratorChoice choice;
  choice.settings = settings;
  if (!settings.integrator.is_auto()) return choice;
  const PilotStart start = pilots.start();
  const PackedScene& scene = pilots.scene();
  const std::vector<RenderPlan> all = candidates_of(settings, scene);
  const DeviceClass device = pilots.device_class();
  choice.settings = all.front();
  const double length = length_of(settings, device);
  if (all.size() < 2) return choice;
  const double training =
      trains_light_selection(scene, all.front()) ? static_cast<double>(kPartTrainingPaths) : 0.0; // of the first pilot
  if (!is_affordable(kIntegratorPilot, settings, device, training)) {
    const auto finder = std::ranges::find_if(all, [](const RenderPlan& way) { return way.integrator->splats; });
    if (finder == all.end() || !hides_lamps(scene, pilots.view()) || !fits(*finder)) return choice;
    choice.settings = *finder;
    choice.hidden_lamps = true;
    return choice;
  }
  std::vector<RenderPlan> candidates = {all.front()};
  for (std::size_t i = 1; i < all.size(); ++i)
    if (fits(all[i]))
      candidates.push_back(all[i]);
    else
      choice.too_large.push_back(candidate_text(all[i]));
  if (candidates.size() < 2) return choice;
  std::vector<Tried> tried;
  const auto try_out = [&](const RenderPlan& candidate, const Round& round) {
    PilotRender pilot = pilots.run(pilot_of(candidate, round));
    Tried one{candidate, std::move(pilot.result), pilot.light, pilot.steady_work, pilot.training_work};
    one.work = one.steady + one.learned * training_fraction(candidate, one.result, round);
    return one;
  };
  const auto judge_all = [&] {
    const PictureLight& brightest =
        std::ranges::max_element(tried, {}, [](const auto& t) { return t.light.sum; })->light;
    choice.trials.clear();
    for (const Tried& one : tried) choice.trials.push_back(judge(one, tried.front(), brightest));
    choice.taken = best_of(choice.trials);
  };
  tried.push_back(try_out(candidates.front(), kFirstRound));
  if (tries_others(tried[0], length, may_lose_light(scene), device)) {
    for (std::size_t i = 1; i < candidates.size(); ++i) {
      try {
        tried.push_back(try_out(candidates[i], kFirstRound));
      } catch (const DeviceLimit&) {
        choice.refused.push_back(candidate_text(candidates[i]));
      }
    }
  }
  judge_all();
  const std::vector<std::size_t> close = contenders(choice.trials, choice.taken);
  if (choice.taken > 0 && tries_again(tried, close, length, device)) {
    for (const std::size_t i : close) tried[i] = try_out(tried[i].settings, kSecondRound);
    judge_all();
  }
  const auto disagree = [&](std::size_t i, const std::string& how) {
    choice.trials[i].disagrees = true;
    choice.disagreement = fmt::format(
        "{} and {} disagree on light that both find, {}: one of them is wrong, please report it with the scene",
        choice.trials[i].flags, choice.trials[0].flags, how);
    choice.taken = best_of(choice.trials);
  };
  for (std::size_t i = 1; i < tried.size() && !folds_mirrors(scene); ++i) {
    if (!differ_both_ways(*tried[i].result.film, *tried[0].result.film)) continue;
    RenderPlan ours = tried[i].settings, theirs = tried[0].settings;
    ours.seed ^= kSeedOfConfirmation, theirs.seed ^= kSeedOfConfirmation;
    const Round again{kSecondRound.row, kFirstRound.guide_iterations};
    if (differ_both_ways(*try_out(ours, again).result.film, *try_out(theirs, again).result.film))
      disagree(i, "each brighter than the other somewhere");
  }
  if (choice.taken > 0 && tried[choice.taken].settings.integrator != tried[0].settings.integrator)
    if (const auto apart = find_disagreement(pilots.device(), scene, pilots.view(), tried[0].settings,
                                             tried[choice.taken].settings, pilots.kernels(), pilots.shared()))
      disagree(choice.taken, fmt::format("by {:.2g} % +- {:.1g} % after one bounce", 100.0 * apart->fraction,
                                         100.0 * apart->standard_error));
  choice.settings = tried[choice.taken].settings;
  static_cast<PilotOutcome&>(choice) = pilots.outcome_since(start, kIntegratorPilot, settings);
  return choice;
}

std::string choice_text(const IntegratorChoice& choice) {
  const std::string reason = reason_of(choice);
  std::string text = fmt::format("auto took {}{}{}{}", candidate_text(choice.settings),
                                 choice.trials.empty() ? " without a trial" : "", reason.empty() ? "" : ": ", reason);
  for (const std::string& clause : exceptions_of(choice)) text += "; " + clause;
  return text;
}

Decision decision_of(const IntegratorChoice& choice) {
  Decision decision{.what = "integrator",
                    .taken = std::string(choice.settings.integrator->name),
                    .is_told = !choice.trials.empty() || !choice.too_large.empty() || choice.hidden_lamps,
                    .trials = choice.trials};
  decision.add(choice);
  std::vector<std::string> clauses = exceptions_of(choice);
  if (const std::string reason = reason_of(choice); !reason.empty()) clauses.insert(clauses.begin(), reason);
  decision.why = fmt::format("{}{}", choice.trials.empty() ? "no pilot: " : "", fmt::join(clauses, "; "));
  if (!choice.trials.empty()) {
    const Trial& taken = choice.trials[choice.taken];
    decision.cost = taken.cost, decision.lo = taken.lo, decision.hi = taken.hi;
  }
  return decision;
}

} // namespace wavepath
