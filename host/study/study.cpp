#include "host/study/study.h"

#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <cmath>
#include <list>
#include <numbers>
#include <numeric>
#include <set>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/base/failure.h"
#include "host/picture/files/picture_io.h"
#include "host/plan/plan.h"
#include "host/plan/training.h"
#include "host/render/denoised.h"
#include "host/render/report/stats.h"
#include "host/render/settings/integrator_kind.h"
#include "host/render/settings/settings_table.h"
#include "host/render/workspace/kernel_compiler.h"

namespace wavepath {
namespace {

constexpr std::uint32_t kReferenceSeed = 1u << 30; // apart from the seeds of the points
constexpr std::size_t kPicturesKept = 2;           // one of the last two is nearest to the time that all have in common
constexpr double kMostSamples = 1 << 18;
constexpr double kMostOfBudget = 0.1;        // that one frame of a shadow technique may take
constexpr std::uint32_t kFirstOctave = 1;    // of shadow techniques: two samples a pixel
constexpr std::uint32_t kTrueShadows = 64;   // rays to lights at each point that tell the true shadows of a picture
constexpr std::uint32_t kTrueOverTried = 16; // and at least so many times those of the picture

using Clock = std::chrono::steady_clock;

bool varies(const StudySettings& settings, std::string_view dimension) {
  return std::ranges::count(settings.vary, dimension) > 0;
}

class StudyRun {
public:
  StudyRun(Device& device, const StudyScene& scene, const StudySettings& settings, const StudyCallback& progress)
      : device_(device), scene_(scene), settings_(settings), progress_(progress) {}

  Study run(std::optional<StudyReference> reference) {
    const Configuration *hybrid = nullptr, *rasterized = nullptr;
    const std::vector<Configuration> grid = make_grid(settings_.vary, settings_.render);
    bool occlusion = false;
    for (const Configuration& configuration : grid) {
      if (!fits(configuration)) continue;
      study_.series.push_back({configuration, {}, {}});
      varies_shadows_ |= !configuration.value_of("shadows").empty();
      const RenderPlan& own = configuration.settings;
      if (own.integrator->traces_paths) continue;
      if (!rasterized) rasterized = &configuration;
      if (!hybrid && own.integrator->finds_light) hybrid = &configuration;
      occlusion |= !own.integrator->finds_light || own.max_depth > 1;
    }
    if (study_.series.empty()) throw Error("the grid", study_.unsupported.front().why, "vary something else");
    by_signal_ = rasterized != nullptr;
    reference_fraction_ = varies_shadows_ ? kShadowReferenceFraction : kReferenceFraction;
    double seconds = settings_.budget * (reference ? 1.0 : 1.0 - reference_fraction_);
    study_.reference = reference ? *std::move(reference) : render_reference();
    if (varies_shadows_) shadowed_ = hybrid->settings;
    if (occlusion && !study_.interrupted) {
      study_.occlusion = render_occlusion();
      seconds -= kOcclusionFraction * settings_.budget;
    }
    if (hybrid && !study_.interrupted && device_.info().rasterizes)
      study_.first_hits = measure_first_hits(hybrid->settings);
    if (study_.interrupted) return std::move(study_);
    if (varies_shadows_)
      measure_shadows(seconds);
    else
      measure_all(seconds / static_cast<double>(study_.series.size()));
    if (!study_.unsupported.empty())
      std::erase_if(study_.series, [&](const Series& one) {
        const std::string name = one.configuration.name();
        return one.points.empty() && std::ranges::count(study_.unsupported, name, &Unsupported::name) > 0;
      });
    return std::move(study_);
  }

private:
  // True if the configuration's integrator can render this scene; otherwise the study notes why not.
  bool fits(const Configuration& configuration) {
    const RenderPlan& settings = configuration.settings;
    const std::string why = settings.integrator->unsupported_reason
                                ? settings.integrator->unsupported_reason(settings, scene_.packed_for(settings))
                                : "";
    if (why.empty()) return true;
    const std::string technique(configuration.value_of("shadows")); // whatever the size of its maps
    const std::string name = technique.empty() ? configuration.name() : technique;
    if (std::ranges::count(study_.unsupported, name, &Unsupported::name) == 0)
      study_.unsupported.push_back({name, why});
    return false;
  }

  // Direct light of an octave's points, and the same light as if nothing were in its way: what fractions of it are lit
  // and dark is counted by.
  struct PointLight {
    Picture shadowed, unshadowed;
    ShadowedPicture pair() const { return {shadowed, unshadowed}; }
  };

  Picture render_light(std::string_view technique, std::uint32_t octave, std::uint32_t rays) {
    RenderPlan settings = shadowed_;
    read_setting(setting_named("shadows"), std::string(technique), settings);
    if (technique != "traced") { // a map of no consequence, whose shadows let all light pass
      settings.shadow_size = 64;
      settings.shadow_ambient = 1.0;
    }
    settings.aovs = {"direct"};
    settings.shadow_samples = rays;
    settings.last_sample = 1u << octave;
    settings.seed = settings_.render.seed + octave;
    const PackedScene& scene = scene_.packed_for(settings);
    if (!settings.integrator->unsupported_reason(settings, scene).empty()) return {};
    return render_one(settings, light_kernels_, "the truth of shadows").picture;
  }

  // Pictures of one octave see the same points of surfaces, and so does their truth: what is left of an error is a
  // technique's own, and that of the points of lamps it was asked for.
  const PointLight& true_light(std::uint32_t octave) {
    const auto found = true_light_.find(octave);
    if (found != true_light_.end()) return found->second;
    const std::uint32_t rays =
        std::clamp(kTrueOverTried * settings_.render.shadow_samples, kTrueShadows, kMostFrameRays);
    return true_light_[octave] = {render_light("traced", octave, rays), render_light("map", octave, rays)};
  }
  const Picture& unshadowed(std::uint32_t octave, std::uint32_t rays) {
    const auto found = unshadowed_.find({octave, rays});
    if (found != unshadowed_.end()) return found->second;
    return unshadowed_[{octave, rays}] = render_light("map", octave, rays);
  }

  // As the command that repeats it does (study_report.cpp).
  RenderResult render_one(RenderPlan settings, KernelCompiler& kernels, const std::string& what) {
    settings = as_told(settings);
    set_training_lengths(settings, class_of(device_.info()));
    const auto on_progress = [&](const Progress& progress) {
      return progress_({fmt::format("{}, {} spp", what, settings.last_sample), seconds_ + progress.seconds});
    };
    RenderResult result =
        render(device_, scene_.packed_for(settings), scene_.view, settings, {.progress = on_progress}, kernels);
    seconds_ += result.seconds;
    study_.interrupted |= result.stop == StopReason::interrupted;
    return result;
  }

  // The strongest of what there is, with as many samples as a pilot says that there is time for.
  StudyReference render_reference() {
    RenderPlan settings = settings_.render;
    settings.sampler = gpu::kSamplerSobol;
    settings.direct = gpu::kDirectMis;
    settings.hemisphere = gpu::kHemisphereCosine;
    if (const std::string_view truth = traced_setting(settings_); !truth.empty())
      read_setting(setting_named(truth), "traced", settings);
    else
      settings.integrator = &default_integrator();
    if (by_signal_) settings.aovs = {"direct"};
    KernelCompiler kernels(device_);
    return converge(settings, settings_.reference_spp, reference_fraction_, kernels, "reference");
  }

  StudyReference render_occlusion() {
    RenderPlan settings = settings_.render;
    settings.sampler = gpu::kSamplerSobol;
    settings.integrator = *std::ranges::find(integrators(), false, &IntegratorKind::finds_light);
    settings.ao_samples = 16;
    settings.denoise = kDenoiseOff;
    settings.aovs = {"ao"}; // which is 1 where nothing is hit; the picture is black there
    settings.time_limit = 2.0 * kOcclusionFraction * settings_.budget; // a frame is never cut short
    KernelCompiler kernels(device_);
    return converge(settings, 0, kOcclusionFraction, kernels, "reference of occlusion");
  }

  // `spp`: 0 = what a fraction of the budget allows.
  StudyReference converge(RenderPlan settings, std::uint32_t spp, double fraction, KernelCompiler& kernels,
                          const std::string& what) {
    settings.seed = settings_.render.seed ^ kReferenceSeed;
    settings.last_sample = spp > 0 ? spp : affordable_samples(settings, fraction * settings_.budget, kernels, what);
    RenderResult result = render_one(settings, kernels, what);
    return {std::move(result.picture), "", estimated_error(result), settings.seed, result.spp, result.seconds};
  }

  std::uint32_t affordable_samples(RenderPlan settings, double budget, KernelCompiler& kernels,
                                   const std::string& what) {
    constexpr double kPilotFraction = 1.0 / 32.0; // of the budget
    const double before = seconds_;
    double seconds = 0.0;
    for (settings.last_sample = 1;; settings.last_sample *= 4) {
      seconds = render_one(settings, kernels, "pilot for the " + what).seconds;
      if (study_.interrupted || seconds > kPilotFraction * budget) break;
    }
    // Rounded to the nearest power of two.
    const double samples = std::numbers::sqrt2 * (budget - (seconds_ - before)) * settings.last_sample / seconds;
    return std::bit_floor(static_cast<std::uint32_t>(std::clamp(samples, 2.0, kMostSamples)));
  }

  // Milliseconds a frame that finding first hits takes, after a frame that warms up.
  double frame_ms(RenderPlan settings) {
    const auto& wanted = settings.integrator->first_hit_stages;
    KernelCompiler kernels(device_);
    RenderResult result;
    const std::uint32_t frames = settings.last_sample;
    for (settings.last_sample = 1; settings.last_sample <= frames; settings.last_sample += frames - 1) {
      result = render_one(settings, kernels, "first hits");
      if (study_.interrupted) return 0.0;
    }
    double seconds = 0.0;
    for (const StageTime& stage : result.stages)
      if (std::ranges::find(wanted, stage.name) != wanted.end()) seconds += stage.seconds;
    return 1000.0 * seconds / result.spp;
  }

  // Paths that end at the first hit trace camera rays and nothing else.
  FirstHits measure_first_hits(RenderPlan hybrid) {
    constexpr std::uint32_t kFrames = 16;
    hybrid.last_sample = kFrames;
    hybrid.first_hit = kFirstHitRaster;
    RenderPlan traced = hybrid;
    traced.integrator = &default_integrator();
    traced.denoise = kDenoiseOff;
    traced.max_depth = 0;
    return {frame_ms(hybrid), frame_ms(traced), kFrames};
  }

  // In turns, so that other load on the machine disturbs all alike. A configuration ends where twice the time of
  // its last render would not fit into what is left of its `budget`, in seconds.
  void measure_all(double budget) {
    std::list<KernelCompiler> kernels;
    std::vector<double> used(study_.series.size(), 0.0);
    std::vector<KernelCompiler*> active;
    for (std::size_t i = 0; i < study_.series.size(); ++i) active.push_back(&kernels.emplace_back(device_));
    for (std::uint32_t octave = 0; std::any_of(active.begin(), active.end(), [](auto* k) { return k != nullptr; });
         ++octave)
      for (std::size_t i = 0; i < active.size(); ++i) {
        if (!active[i]) continue;
        const bool measured = is_rendered(study_.series[i], [&] {
          if (octave == 0) warm_up(study_.series[i], *active[i]);
          measure(study_.series[i], octave, *active[i]);
        });
        if (study_.interrupted) return;
        if (!measured) {
          active[i] = nullptr;
          continue;
        }
        const double seconds = study_.series[i].points.back().seconds * (by_signal_ ? 2.0 : 1.0); // see measure()
        used[i] += seconds;
        if (used[i] + 2.0 * seconds > budget || (1u << octave) >= kMostSamples) active[i] = nullptr;
      }
  }

  // Where shadows are compared, all have one sample count, the highest that a budget allows: their errors do not fall
  // with samples, and their pictures must have as much noise. At least two, the first of which warms up. The budget
  // counts what passes on the clock: each of many short renders takes as long again to set up.
  void measure_shadows(double budget) {
    const auto start = Clock::now();
    const auto passed = [&] { return std::chrono::duration<double>(Clock::now() - start).count(); };
    KernelCompiler kernels(device_); // techniques are many, and what they share is most of their kernels
    std::vector<Series*> fitting;
    double frames = 0.0; // seconds of one of each
    for (Series& series : study_.series) {
      if (!fits_device(series, kernels)) continue;
      if (study_.interrupted) return;
      const double frame = series.points.front().seconds / series.points.front().spp;
      if (frame > kMostOfBudget * budget && !fitting.empty()) {
        study_.unsupported.push_back(
            {series.configuration.name(), fmt::format("takes {:.1f} s a frame: too much of --budget", frame)});
        series.points.clear();
        continue;
      }
      fitting.push_back(&series);
      frames += frame;
    }
    const double all = passed(), besides = all - frames * (1u << kFirstOctave);
    std::uint32_t octave = kFirstOctave;
    while ((2u << octave) < kMostSamples && besides + frames * (2u << octave) < budget - all) ++octave;
    if (octave == kFirstOctave) return;
    for (Series* series : fitting) {
      Series longer{series->configuration, {}, {}};
      const bool measured = is_rendered(*series, [&] { measure(longer, octave, kernels); });
      if (study_.interrupted) return;
      if (measured) *series = std::move(longer);
    }
  }

  // Measures the first octave. False if the device cannot hold it, where that is a matter of one configuration: the
  // size of its maps.
  bool fits_device(Series& series, KernelCompiler& kernels) {
    return is_rendered(series, [&] {
      if (warm_.insert(std::string(series.configuration.value_of("shadows"))).second) warm_up(series, kernels);
      if (!study_.interrupted) measure(series, kFirstOctave, kernels);
    });
  }

  // A configuration that fails is left out, or ends with what it has; a device that is lost ends the study so.
  template <class Step>
  bool is_rendered(const Series& series, const Step& step) {
    try {
      step();
      return true;
    } catch (const DeviceLost& lost) {
      study_.lost = lost.what();
      study_.interrupted = true;
    } catch (const std::exception& failure) {
      study_.unsupported.push_back({series.configuration.name(), failure_text(failure)});
    }
    return false;
  }

  // The first render of a kernel also takes the time of what drivers postpone until then.
  void warm_up(const Series& series, KernelCompiler& kernels) {
    RenderPlan settings = series.configuration.settings;
    settings.last_sample = 1;
    if (scores_shadows(series)) add_signals(settings);
    render_one(settings, kernels, series.configuration.name());
  }

  // Every point has a seed of its own: their errors are then independent, as the interval of a slope supposes.
  void measure(Series& series, std::uint32_t octave, KernelCompiler& kernels) {
    RenderPlan settings = series.configuration.settings;
    settings.last_sample = 1u << octave;
    settings.seed = settings_.render.seed + octave;
    if (scores_shadows(series)) add_signals(settings);
    RenderResult result = render_one(settings, kernels, series.configuration.name());
    if (study_.interrupted) return;
    const Picture& reference = study_.reference_of(series).picture;
    StudyPoint point{result.spp, settings.seed, result.seconds, result.gpu_seconds, result.rays.total()};
    denoise_if_asked(result, settings);
    if (result.denoised) point.seconds += result.denoised->seconds;
    const Picture shown = shown_picture(result.picture);
    point.metrics = compare_pictures(shown, reference);
    std::vector<float> flip = hdr_flip(shown, reference);
    point.flip = std::accumulate(flip.begin(), flip.end(), 0.0) / static_cast<double>(flip.size());
    point.estimated_error = estimated_error(result);
    point.shadow_work = varies_shadows_ ? shadow_work(result) : std::nullopt;
    std::optional<Picture> false_shadows;
    if (scores_shadows(series)) {
      false_shadows = measure_signals(result.picture, settings, point);
    } else if (series.shows_occlusion()) {
      point.occlusion = point.metrics;
    } else if (by_signal_) { // again, because the additional channels would add to the measured time
      add_signals(settings);
      measure_signals(render_one(settings, kernels, series.configuration.name()).picture, settings, point);
    }
    if (study_.interrupted) return;
    series.pictures.push_back(
        {series.points.size(), std::move(result.picture), std::move(flip), std::move(false_shadows)});
    if (series.pictures.size() > kPicturesKept) series.pictures.erase(series.pictures.begin());
    series.points.push_back(point);
  }

  // Times of a technique. Tracing rays of lights that it does not cover counts as looking up; traced shadows do nothing
  // else.
  static std::optional<ShadowReport> shadow_work(const RenderResult& result) {
    ShadowReport report = result.shadows.value_or(ShadowReport{});
    const auto rays = std::ranges::find(result.stages, "connect", &StageTime::name);
    if (rays == result.stages.end()) return result.shadows;
    const double ms = 1000.0 * rays->seconds / result.spp;
    for (double* time : {&report.look_up.median, &report.look_up.least, &report.look_up.most}) *time += ms;
    return report;
  }

  bool scores_shadows(const Series& series) const { return varies_shadows_ && !series.shows_occlusion(); }

  static void add_signals(RenderPlan& settings) {
    settings.aovs.clear();
    if (std::ranges::count(settings.integrator->lacks_aovs, "direct") == 0) settings.aovs.emplace_back("direct");
    if (std::ranges::count(settings.integrator->aovs, "ao") > 0) settings.aovs.emplace_back("ao");
  }

  // Returns where shadows are false, if the grid varies them.
  std::optional<Picture> measure_signals(const Picture& picture, const RenderPlan& settings, StudyPoint& point) {
    if (study_.interrupted) return std::nullopt;
    const Picture& reference = study_.reference.picture;
    point.direct = compare(picture, reference, {"direct.R", "direct.G", "direct.B"});
    if (study_.occlusion) point.occlusion = compare(picture, study_.occlusion->picture, {"ao", "ao", "ao"});
    if (!varies_shadows_) return std::nullopt;
    const auto octave = static_cast<std::uint32_t>(std::countr_zero(point.spp));
    const ShadowedPicture ours{picture, unshadowed(octave, settings.shadow_samples)},
        theirs = true_light(octave).pair();
    point.shadows = score_shadows(ours, theirs);
    return false_shadow_map(ours, theirs);
  }

  // The channels of that name as a picture of their own; nothing where one of the two lacks them.
  static std::optional<PictureMetrics> compare(const Picture& picture, const Picture& reference,
                                               const std::array<std::string, 3>& channels) {
    Picture ours{picture.width, picture.height, {}}, theirs{reference.width, reference.height, {}};
    for (const std::string& name : channels) {
      const Channel *a = find_channel(picture, name), *b = find_channel(reference, name);
      if (!a || !b) return std::nullopt;
      ours.channels.push_back(*a);
      theirs.channels.push_back(*b);
    }
    return compare_pictures(ours, theirs);
  }

  Device& device_;
  const StudyScene& scene_;
  const StudySettings& settings_;
  const StudyCallback& progress_;
  Study study_;
  bool by_signal_ = false; // direct light and occlusion on their own as well
  bool varies_shadows_ = false;
  double reference_fraction_ = 0.0;
  // Where shadows are varied: a configuration that has some, and by octave the light with true ones and without any.
  RenderPlan shadowed_;
  std::map<std::uint32_t, PointLight> true_light_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, Picture> unshadowed_; // and by rays to lights
  KernelCompiler light_kernels_{device_};
  std::set<std::string> warm_; // techniques whose kernels ran
  double seconds_ = 0.0;       // rendering so far
};

} // namespace

std::string_view traced_setting(const StudySettings& settings) {
  if (varies(settings, "integrator")) return "";
  return varies(settings, "reflections") ? "reflections" : varies(settings, "bounce") ? "bounce" : "";
}

double StudyPoint::relative_rms() const { return std::sqrt(metrics.relmse); }

Study run_study(Device& device, const StudyScene& scene, const StudySettings& settings,
                std::optional<StudyReference> reference, const StudyCallback& progress) {
  return StudyRun(device, scene, settings, progress).run(std::move(reference));
}

} // namespace wavepath
