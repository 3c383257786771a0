#include "host/study/study_report.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>

#include <fmt/format.h>

#include "host/base/atomic_file.h"
#include "host/base/error.h"
#include "host/base/failure.h"
#include "host/base/shell_quote.h"
#include "host/picture/files/picture_io.h"
#include "host/plan/plan.h"
#include "host/render/report/stats.h"
#include "host/render/settings/settings_table.h"
#include "host/study/study_pictures.h"
#include "host/study/tables.h"

namespace wavepath {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kOcclusionFile = "ao-reference.exr";
constexpr std::string_view kReachNames[] = {"interpolated", "extrapolated", "at_most", "not_reached"}; // as Reach

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }
Json number(const std::optional<double>& value) { return value ? number(*value) : Json(nullptr); }

std::string in_folder(const StudyRecord& record, const std::string& name) {
  return (std::filesystem::path(record.folder) / name).string();
}

std::string reference_file(const StudyRecord& record) {
  const std::string& own = record.study.reference.file;
  return own.empty() ? in_folder(record, kReferenceFile) : own;
}

std::string occlusion_file(const StudyRecord& record) { return in_folder(record, kOcclusionFile); }

// The flags that all frames of the grid share, and that path integrators do not support.
std::string frame_flags(const StudyRecord& record) {
  return fmt::format(" --ao-radius {}", record.settings.render.ao_radius.value_or(0.0));
}

// Flags for settings that `render` would otherwise decide by pilots, since a study renders without pilots.
std::string told_flags(const RenderPlan& settings, const Configuration* varied) {
  const RenderPlan told = as_told(settings);
  std::string flags;
  for (const Setting& row : settings_table()) {
    if (!row.planned || !is_supported(row, told) || (varied && !varied->value_of(row.name).empty())) continue;
    if (const std::string flag = flag_text(row, told); !flag.empty() && !is_auto(row, told)) flags += " " + flag;
  }
  return flags;
}

std::string point_command(const StudyRecord& record, const Series& series, const StudyPoint& point) {
  const Configuration& configuration = series.configuration;
  const bool path = configuration.settings.integrator->traces_paths;
  const bool has_samples =
      !configuration.value_of("shadows").empty() && configuration.value_of("shadow-samples").empty();
  return fmt::format(
      "{}{} {}{}{} --seed {} --spp {} --reference {} -o {}-{}.exr", record.repeat,
      told_flags(configuration.settings, &configuration), configuration.flags(), path ? "" : frame_flags(record),
      has_samples ? fmt::format(" --shadow-samples {}", configuration.settings.shadow_samples) : "", point.seed,
      point.spp, shell_quoted(series.shows_occlusion() ? occlusion_file(record) : reference_file(record)),
      configuration.name("-"), point.spp);
}

std::string reference_command(const StudyRecord& record) {
  const StudyReference& reference = record.study.reference;
  if (!reference.file.empty()) return "";
  RenderPlan settings = record.settings.render;
  const std::string_view truth = traced_setting(record.settings);
  if (truth.empty()) settings.integrator = &default_integrator();
  return fmt::format("{}{} --sampler sobol --direct mis --hemisphere cosine{}{} --seed {} --spp {} -o {}",
                     record.repeat, told_flags(settings, nullptr),
                     truth.empty() ? "" : fmt::format("{} --{} traced", frame_flags(record), truth),
                     record.study.occlusion ? " --aov direct" : "", reference.seed, reference.spp,
                     shell_quoted(reference_file(record)));
}

std::string occlusion_command(const StudyRecord& record) {
  const StudyReference& reference = *record.study.occlusion;
  return fmt::format("{} --integrator ao --ao-samples 16 --aov ao{} --seed {} --spp {} -o {}", record.repeat,
                     frame_flags(record), reference.seed, reference.spp, shell_quoted(occlusion_file(record)));
}

Json slope_json(const std::optional<PowerFit>& fit) {
  if (!fit) return nullptr;
  return {{"slope", fit->slope}, {"ci95", fit->ci95}, {"intercept", fit->intercept}, {"points", fit->points}};
}

Json metrics_json(const std::optional<PictureMetrics>& metrics) {
  if (!metrics || !metrics->finite()) return nullptr;
  return {{"relative_rms", std::sqrt(metrics->relmse)},
          {"mse", metrics->mse},
          {"relmse", metrics->relmse},
          {"mrse", metrics->mrse}};
}

std::optional<PictureMetrics> whole_picture(const Series& series, const StudyPoint& point) {
  return series.shows_occlusion() ? std::nullopt : std::optional(point.metrics);
}

Json occlusion_json(const StudyRecord& record) {
  const std::optional<StudyReference>& reference = record.study.occlusion;
  if (!reference) return nullptr;
  return {{"file", occlusion_file(record)},
          {"picture", kOcclusionPicture},
          {"spp", reference->spp},
          {"seconds", reference->seconds},
          {"relative_rms", number(reference->error)},
          {"radius", number(record.settings.render.ao_radius)},
          {"command", occlusion_command(record)}};
}

Json first_hits_json(const std::optional<FirstHits>& cost) {
  if (!cost) return nullptr;
  return {{"rasterized_ms", cost->rasterized}, {"traced_ms", cost->traced}, {"frames", cost->frames}};
}

Json cost_json(const ShadowCost& cost) { return {{"median", cost.median}, {"least", cost.least}, {"most", cost.most}}; }

// Errors of shadows by kind, and what the technique took; null where the grid does not vary them.
Json shadows_json(const StudyPoint& point) {
  if (!point.shadows) return nullptr;
  Json result = {{"relative_rms", point.shadows->relative_rms},
                 {"falsely_lit", point.shadows->falsely_lit},
                 {"falsely_dark", point.shadows->falsely_dark},
                 {"edge_displacement_pixels", number(point.shadows->edge_displacement)},
                 {"penumbra_ratio", number(point.shadows->penumbra_ratio)}};
  if (point.shadow_work)
    result.update({{"build_ms", cost_json(point.shadow_work->build)},
                   {"look_up_ms", cost_json(point.shadow_work->look_up)},
                   {"bytes", point.shadow_work->bytes},
                   {"covered", point.shadow_work->covered},
                   {"traced", point.shadow_work->traced}});
  return result;
}

Json unsupported_json(const Study& study) {
  Json list = Json::array();
  for (const Unsupported& one : study.unsupported) list.push_back({{"configuration", one.name}, {"why", one.why}});
  return list;
}

Json point_json(const StudyRecord& record, const Series& series, const StudyPoint& point) {
  return {{"spp", point.spp},
          {"seconds", point.seconds},
          {"gpu_seconds", point.gpu_seconds},
          {"rays", point.rays},
          {"relative_rms", point.relative_rms()},
          {"estimated_relative_rms", number(point.estimated_error)},
          {"mse", point.metrics.mse},
          {"relmse", point.metrics.relmse},
          {"mrse", point.metrics.mrse},
          {"flip", point.flip},
          {"efficiency", number(point.efficiency())},
          {"at_floor", record.study.at_floor(series, point.relative_rms())},
          {"ms_per_frame", point.ms_per_frame()},
          {"direct", metrics_json(point.direct)},
          {"ao", metrics_json(point.occlusion)},
          {"full", metrics_json(whole_picture(series, point))},
          {"shadows", shadows_json(point)},
          {"command", point_command(record, series, point)}};
}

Json series_json(const StudyRecord& record, const Series& series, double common_seconds) {
  Json flags = Json::object(), points = Json::array(), picture = nullptr;
  for (const Choice& choice : series.configuration.choices) flags[std::string(choice.dimension)] = choice.value;
  for (const StudyPoint& point : series.points) points.push_back(point_json(record, series, point));
  if (const StudyPicture* shown = picture_near(series, common_seconds))
    picture = {{"file", picture_name(series)},
               {"error_map", map_name(series)},
               {"false_shadows", shown->false_shadows ? Json(false_shadow_name(series)) : Json(nullptr)},
               {"spp", series.points[shown->point].spp},
               {"seconds", series.points[shown->point].seconds}};
  const auto fit = [&](const std::vector<Measured>& curve) { return slope_json(fit_of(record.study, series, curve)); };
  return {{"name", series.configuration.name()},
          {"flags", flags},
          {"slope", {{"seconds", fit(error_by_seconds(series))}, {"spp", fit(error_by_spp(series))}}},
          {"levels_off", number(levels_off(series))},
          {"shows", series.shows_occlusion() ? "ao" : "full"},
          {"picture", picture},
          {"points", points}};
}

Json equal_time_json(const Study& study, const EqualTime& table) {
  Json rows = Json::array();
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    Json row{{"configuration", study.series[i].configuration.name()}};
    if (const auto& values = table.rows[i])
      row.update({{"relative_rms", values->relative_rms},
                  {"ratio", number(values->ratio)},
                  {"scatter95", number(values->scatter)},
                  {"as_good_as_best", values->as_good_as_best},
                  {"at_floor", values->at_floor},
                  {"mse", values->mse},
                  {"relmse", values->relmse},
                  {"mrse", values->mrse},
                  {"flip", values->flip},
                  {"efficiency", number(values->efficiency)}});
    rows.push_back(row);
  }
  return {{"seconds", number(table.seconds)}, {"rows", rows}};
}

Json equal_error_json(const Study& study) {
  Json tables = Json::array();
  for (const EqualError& table : equal_error(study)) {
    Json rows = Json::array();
    for (std::size_t i = 0; i < table.rows.size(); ++i) {
      const TimeTo& time = table.rows[i].time;
      rows.push_back({{"configuration", study.series[i].configuration.name()},
                      {"seconds", time.how == Reach::not_reached ? Json(nullptr) : Json(time.x)},
                      {"how", kReachNames[static_cast<std::size_t>(time.how)]},
                      {"speedup", number(table.rows[i].speedup)}});
    }
    tables.push_back({{"relative_rms", table.relative_rms}, {"rows", rows}});
  }
  return tables;
}

// Relative RMS error and MSE, or two empty fields.
std::string csv_pair(const std::optional<PictureMetrics>& metrics) {
  return metrics ? fmt::format("{:.8g},{:.8g}", std::sqrt(metrics->relmse), metrics->mse) : ",";
}

// Eight fields, empty where the grid does not vary shadows, or where there is nothing to tell.
std::string csv_shadows(const StudyPoint& point) {
  const auto field = [](const std::optional<double>& value) { return value ? fmt::format("{:.6g}", *value) : ""; };
  std::string text = ",,,,";
  if (point.shadows)
    text = fmt::format("{:.6g},{:.6g},{:.6g},{},{}", point.shadows->relative_rms, point.shadows->falsely_lit,
                       point.shadows->falsely_dark, field(point.shadows->edge_displacement),
                       field(point.shadows->penumbra_ratio));
  if (!point.shadow_work) return text + ",,,";
  return text + fmt::format(",{:.6g},{:.6g},{}", point.shadow_work->build.median, point.shadow_work->look_up.median,
                            point.shadow_work->bytes);
}

// So that `compare` and later studies can take it.
void write_reference(const StudyRecord& record, const StudyReference& reference, const std::string& file,
                     const std::string& command) {
  PictureInfo info;
  info.spp = reference.spp;
  info.seconds = reference.seconds;
  info.error = reference.error;
  info.seed = reference.seed;
  info.samples = fmt::format("0:{}", reference.spp);
  info.scene = record.scene;
  info.command = command;
  info.filter = kFilterNames[record.settings.render.filter];
  write_picture(file, reference.picture, info, {});
}

} // namespace

Json study_document(const StudyRecord& record) {
  const Study& study = record.study;
  const RenderPlan& settings = record.settings.render;
  const EqualTime table = equal_time(study);
  const StudyPictures pictures = plan_pictures(study);
  Json series = Json::array();
  for (const Series& one : study.series) series.push_back(series_json(record, one, table.seconds));
  return {{"wavepath", WAVEPATH_VERSION},
          {"scene", record.scene},
          {"command", record.command},
          {"date", record.date},
          {"device",
           {{"name", record.device.name},
            {"driver", record.device.driver},
            {"type", record.device.type},
            {"api", record.device.api}}},
          {"size", {settings.width, settings.height}},
          {"max_depth", settings.max_depth},
          {"filter", kFilterNames[settings.filter]},
          {"budget_seconds", record.settings.budget},
          {"interrupted", study.interrupted},
          {"vary", record.settings.vary},
          {"reference",
           {{"file", reference_file(record)},
            {"given", !study.reference.file.empty()},
            {"spp", study.reference.spp},
            {"seconds", study.reference.seconds},
            {"relative_rms", number(study.reference.error)},
            {"floor", study.reference.error ? Json(kFloor * *study.reference.error) : Json(nullptr)},
            {"picture", kReferencePicture},
            {"command", reference_command(record)}}},
          {"ao_reference", occlusion_json(record)},
          {"first_hits", first_hits_json(study.first_hits)},
          {"exposure", pictures.exposure},
          {"error_map", {{"metric", "FLIP"}, {"brightest", pictures.brightest}}},
          {"equal_time", equal_time_json(study, table)},
          {"equal_error", equal_error_json(study)},
          {"unfit", unsupported_json(study)},
          {"configurations", series}};
}

std::string study_csv(const StudyRecord& record) {
  std::string text = fmt::format(
      "configuration,{},spp,seconds,gpu_seconds,rays,relative_rms,estimated_relative_rms,mse,relmse,mrse,flip,"
      "efficiency,at_floor,command,ms_per_frame,direct_relative_rms,direct_mse,ao_relative_rms,ao_mse,"
      "shadow_relative_rms,falsely_lit,falsely_dark,edge_displacement_pixels,penumbra_ratio,build_ms,look_up_ms,"
      "bytes\n",
      fmt::join(record.settings.vary, ","));
  for (const Series& series : record.study.series)
    for (const StudyPoint& point : series.points) {
      const std::string estimate = point.estimated_error ? fmt::format("{:.8g}", *point.estimated_error) : "";
      std::string command = point_command(record, series, point);
      for (std::size_t at = 0; (at = command.find('"', at)) != std::string::npos; at += 2) command.insert(at, 1, '"');
      std::vector<std::string_view> values;
      for (const std::string& name : record.settings.vary) values.push_back(series.configuration.value_of(name));
      text += fmt::format(
          "{},{},{},{:.6g},{:.6g},{},{:.8g},{},{:.8g},{:.8g},{:.8g},{:.8g},{:.6g},{},\"{}\",{:.6g},{},{},{}\n",
          series.configuration.name(), fmt::join(values, ","), point.spp, point.seconds, point.gpu_seconds, point.rays,
          point.relative_rms(), estimate, point.metrics.mse, point.metrics.relmse, point.metrics.mrse, point.flip,
          point.efficiency(), record.study.at_floor(series, point.relative_rms()) ? "yes" : "no", command,
          point.ms_per_frame(), csv_pair(point.direct), csv_pair(point.occlusion), csv_shadows(point));
    }
  return text;
}

std::vector<std::string> study_files(const std::string& folder, const std::vector<Configuration>& grid) {
  std::vector<std::string> names = {"study.csv",    "study.json",      "report.html",    kReferenceFile,
                                    kOcclusionFile, kReferencePicture, kOcclusionPicture};
  for (const Configuration& one : grid) std::ranges::copy(picture_names(one.name("-")), std::back_inserter(names));
  for (std::string& name : names) name = (std::filesystem::path(folder) / name).string();
  return names;
}

void write_study(const StudyRecord& record) {
  const Study& study = record.study;
  std::error_code error;
  std::filesystem::create_directories(in_folder(record, "pictures"), error);
  if (error) throw Error(record.folder, fmt::format("cannot be made ({})", error.message()), "name another folder");
  Attempts attempts;
  attempts.attempt([&] { write_file(in_folder(record, "study.csv"), study_csv(record)); });
  attempts.attempt([&] { write_file(in_folder(record, "study.json"), to_text(study_document(record))); });
  attempts.attempt([&] {
    if (study.reference.file.empty())
      write_reference(record, study.reference, reference_file(record), reference_command(record));
  });
  attempts.attempt([&] {
    if (study.occlusion) write_reference(record, *study.occlusion, occlusion_file(record), occlusion_command(record));
  });
  attempts.attempt([&] { write_pictures(record.folder, study, plan_pictures(study)); });
  attempts.finish();
}

} // namespace wavepath
