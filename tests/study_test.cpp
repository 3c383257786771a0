// wavepath study: its arithmetic on known power laws, and the command as a user runs it. Nothing here judges a time.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <set>

#include <nlohmann/json.hpp>

#include "host/integrators/hybrid/kind.h"
#include "host/integrators/hybrid/shadows/catalogue.h"
#include "host/integrators/path/kind.h"
#include "host/picture/files/picture_io.h"
#include "host/render/settings/shadow_settings.h"
#include "host/study/tables.h"
#include "tests/run_wavepath.h"
#include "tests/temporary_folder.h"
#include "tests/vulkan_device.h"

namespace wavepath::test {
namespace {

using Json = nlohmann::json;
namespace fs = std::filesystem;

const std::string kCornell = WAVEPATH_SOURCE_DIR "/scenes/cornell_box.gltf";

std::vector<Measured> power_law(double factor, double slope, int octaves) {
  std::vector<Measured> points;
  for (int i = 0; i <= octaves; ++i) points.push_back({std::exp2(i), factor * std::pow(std::exp2(i), slope)});
  return points;
}

TEST(Fit, FindsAPowerLaw) {
  const auto fit = fit_power(power_law(3.0, -0.75, 7));
  ASSERT_TRUE(fit);
  EXPECT_EQ(fit->points, 5);
  EXPECT_NEAR(fit->slope, -0.75, 1e-12);
  EXPECT_NEAR(fit->intercept, std::log(3.0), 1e-12);
  EXPECT_NEAR(fit->ci95[0], -0.75, 1e-12);
  EXPECT_NEAR(fit->ci95[1], -0.75, 1e-12);
}

TEST(Fit, TakesTheLastFourOctavesOnly) {
  std::vector<Measured> points = power_law(1.0, -0.5, 8);
  points[0].y = points[1].y = points[2].y = points[3].y = 100.0;
  EXPECT_NEAR(fit_power(points)->slope, -0.5, 1e-12);
}

// By hand: logarithms (0, 0), (1, 1), (2, 0) have slope 0, residuals squared 2/3 with one degree of freedom, sxx 2.
TEST(Fit, IntervalIsStudents) {
  const double e = std::exp(1.0);
  const auto fit = fit_power({{1.0, 1.0}, {e, e}, {e * e, 1.0}});
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->slope, 0.0, 1e-12);
  EXPECT_NEAR(fit->ci95[1], 12.706205 * std::sqrt(2.0 / 3.0 / 2.0), 1e-9);
  EXPECT_NEAR(fit->ci95[0], -fit->ci95[1], 1e-12);
  EXPECT_NEAR(fit->scatter, 12.706205 * std::sqrt(2.0 / 3.0), 1e-9);
}

TEST(Fit, WantsThreePoints) { EXPECT_FALSE(fit_power(power_law(1.0, -0.5, 1))); }

TEST(ValueAt, IsStraightOnLogarithmicAxesAndNeverOutside) {
  const std::vector<Measured> points = power_law(2.0, -0.5, 4);
  EXPECT_NEAR(*value_at(points, 3.0), 2.0 / std::sqrt(3.0), 1e-12);
  EXPECT_DOUBLE_EQ(*value_at(points, 1.0), 2.0);
  EXPECT_DOUBLE_EQ(*value_at(points, 16.0), 0.5);
  EXPECT_FALSE(value_at(points, 0.99));
  EXPECT_FALSE(value_at(points, 16.01));
}

TEST(TimeTo, InterpolatesAndExtrapolatesOneOctave) {
  const std::vector<Measured> points = power_law(2.0, -0.5, 4); // from 2 at 1 to 0.5 at 16
  const auto expect = [&](double level, Reach how, double x) {
    const TimeTo time = time_to(points, level);
    EXPECT_EQ(time.how, how) << level;
    EXPECT_NEAR(time.x, x, 1e-9) << level;
  };
  expect(1.25, Reach::interpolated, 2.56);
  expect(2.5, Reach::at_most, 1.0);
  expect(0.4, Reach::extrapolated, 25.0);
  expect(0.35, Reach::not_reached, 0.0); // 32.65 is more than an octave past 16
}

// A configuration whose relative RMS error is `factor` / sqrt(spp), at `seconds_per_sample`.
Series make_series(const char* sampler, double factor, double seconds_per_sample, int octaves) {
  Series series{{{{"sampler", sampler}}, {}}, {}, {}};
  for (int i = 0; i <= octaves; ++i) {
    StudyPoint point;
    point.spp = 1u << i;
    point.seconds = seconds_per_sample * point.spp;
    point.metrics.relmse = factor * factor / point.spp;
    point.metrics.mse = 2.0 * point.metrics.relmse;
    series.points.push_back(point);
  }
  return series;
}

Study make_study() {
  Study study;
  study.reference.error = 0.01;
  study.series.push_back(make_series("independent", 1.0, 1.0, 6)); // ends at 64 s with 0.125
  study.series.push_back(make_series("sobol", 0.5, 0.5, 6));       // ends at 32 s with 0.0625
  return study;
}

TEST(Tables, EqualTimeIsTheLongestThatAllHave) {
  const EqualTime table = equal_time(make_study());
  EXPECT_DOUBLE_EQ(table.seconds, 32.0);
  ASSERT_TRUE(table.rows[0] && table.rows[1]);
  EXPECT_NEAR(table.rows[0]->relative_rms, std::sqrt(1.0 / 32.0), 1e-12);
  EXPECT_NEAR(table.rows[1]->relative_rms, 0.0625, 1e-12);
  EXPECT_DOUBLE_EQ(*table.rows[0]->ratio, 1.0);
  EXPECT_NEAR(*table.rows[1]->ratio, 0.0625 * std::sqrt(32.0), 1e-12);
  EXPECT_NEAR(table.rows[1]->efficiency, 1.0 / (2.0 * 0.0625 * 0.0625 * 32.0), 1e-9);
  EXPECT_TRUE(table.rows[1]->as_good_as_best);
  EXPECT_FALSE(table.rows[0]->as_good_as_best); // exact power laws have no scatter
}

TEST(Tables, EqualErrorTellsHowMuchFaster) {
  const std::vector<EqualError> tables = equal_error(make_study());
  ASSERT_FALSE(tables.empty());
  bool found = false;
  for (const EqualError& table : tables) {
    if (std::abs(table.relative_rms - 0.2) > 1e-9) continue;
    found = true;
    EXPECT_NEAR(table.rows[0].time.x, 25.0, 1e-9);
    EXPECT_NEAR(table.rows[1].time.x, 3.125, 1e-9); // (0.5 / 0.2)^2 samples of half a second
    EXPECT_NEAR(*table.rows[1].speedup, 8.0, 1e-9);
  }
  EXPECT_TRUE(found);
}

TEST(Tables, WhatIsMostlyTheReferencesErrorIsFlaggedAndNotFitted) {
  Study study = make_study();
  study.reference.error = 0.1; // floor 0.3
  EXPECT_TRUE(equal_time(study).rows[1]->at_floor);
  const std::vector<Measured> left = above_floor(study, study.series[0], error_by_spp(study.series[0]));
  for (const Measured& point : left) EXPECT_GE(point.y, 0.3);
  EXPECT_EQ(left.size(), 4u); // 1, 2, 4 and 8 samples
}

// A hybrid configuration: noise of `factor` / sqrt(spp) above a bias.
Series make_hybrid(double bias, double factor, int octaves) {
  Series series = make_series("sobol", factor, 0.5, octaves);
  series.configuration.settings.integrator = &kHybrid;
  for (StudyPoint& point : series.points) point.metrics.relmse += bias * bias;
  return series;
}

TEST(Tables, ABiasIsALevelAndNoPowerLaw) {
  Study study = make_study();
  study.series.push_back(make_hybrid(0.2, 0.5, 8));
  const Series& hybrid = study.series.back();
  ASSERT_TRUE(levels_off(hybrid));
  EXPECT_NEAR(*levels_off(hybrid), 0.2, 0.005);
  EXPECT_FALSE(fit_of(study, hybrid, error_by_seconds(hybrid)));
  EXPECT_FALSE(levels_off(make_hybrid(0.2, 0.5, 2))) << "two octaves that still fall";
  EXPECT_FALSE(levels_off(make_hybrid(0.0, 0.5, 8)));
  EXPECT_FALSE(levels_off(make_series("sobol", 0.0, 0.5, 1)));
  Series path = make_hybrid(0.2, 0.5, 8);
  path.configuration.settings.integrator = &kPath;
  EXPECT_FALSE(levels_off(path))
      << "an unbiased method does not level off; light that is rarely found only looks like it";
  // A power law through its last points would promise 0.2 within an octave; the bias says that this never comes.
  EXPECT_EQ(time_to(error_by_seconds(hybrid), 0.2).how, Reach::extrapolated);
  bool found = false;
  for (const EqualError& table : equal_error(study)) {
    if (std::abs(table.relative_rms - 0.2) > 1e-9) continue;
    found = true;
    EXPECT_EQ(table.rows[2].time.how, Reach::not_reached);
  }
  EXPECT_TRUE(found);
}

TEST(Tables, OcclusionIsNotRankedAmongPicturesOfLight) {
  Study study = make_study();
  study.series.push_back(make_series("sobol", 0.001, 0.001, 6));
  study.series.back().configuration.settings.integrator = &kAo;
  study.occlusion.emplace().error = 0.5;
  EXPECT_TRUE(study.at_floor(study.series[2], 0.2)) << "measured against a reference of its own";
  EXPECT_FALSE(study.at_floor(study.series[0], 0.2));
  const EqualTime table = equal_time(study);
  EXPECT_DOUBLE_EQ(table.seconds, 32.0);
  EXPECT_FALSE(table.rows[2]);
  EXPECT_TRUE(table.rows[1]->as_good_as_best);
  for (const EqualError& level : equal_error(study)) EXPECT_EQ(level.rows[2].time.how, Reach::not_reached);
}

TEST(Tables, AFrameIsASampleOfEveryPixel) {
  StudyPoint point;
  point.spp = 8;
  point.seconds = 0.4;
  EXPECT_DOUBLE_EQ(point.ms_per_frame(), 50.0);
}

TEST(Grid, HoldsEveryCombinationThePlainestFirst) {
  const std::vector<Configuration> grid = make_grid({"sampler", "hemisphere", "direct"}, {});
  std::set<std::string> names;
  for (const Configuration& configuration : grid) names.insert(configuration.name());
  EXPECT_EQ(names.size(), 18u);
  EXPECT_EQ(grid.front().name(), "independent uniform bsdf");
  EXPECT_EQ(grid.front().settings.direct, gpu::kDirectBsdf);
  EXPECT_EQ(grid.back().flags(), "--sampler sobol --hemisphere cosine --direct mis");
  EXPECT_EQ(grid.back().settings.hemisphere, gpu::kHemisphereCosine);
}

// Paths know of no occlusion rays, and pictures of occlusion of no light: no configuration is there
// twice under two names.
TEST(Grid, LeavesOutWhatChangesNothing) {
  const std::vector<Configuration> grid =
      make_grid({"denoise", "integrator", "shadow-samples", "ao-samples", "direct"}, {});
  std::set<std::string> names, flags;
  std::size_t path = 0, hybrid = 0, ao = 0;
  for (const Configuration& one : grid) {
    names.insert(one.name());
    flags.insert(one.flags());
    path += one.settings.integrator == &kPath;
    hybrid += one.settings.integrator == &kHybrid;
    ao += one.settings.integrator == &kAo;
    EXPECT_TRUE(one.settings.integrator == &kHybrid || one.settings.shadow_samples == 1);
  }
  EXPECT_EQ(path, 3u * 2u);             // direct, denoise
  EXPECT_EQ(hybrid, 3u * 3u * 3u * 2u); // of everything
  EXPECT_EQ(ao, 3u * 2u);               // ao-samples, denoise
  EXPECT_EQ(names.size(), grid.size());
  EXPECT_EQ(flags.size(), grid.size());
  EXPECT_EQ(grid.front().name(), "path bsdf");
  EXPECT_EQ(grid.front().flags(), "--integrator path --direct bsdf");
  EXPECT_EQ(grid.front().value_of("ao-samples"), "");
  const auto last_ao =
      std::find_if(grid.rbegin(), grid.rend(), [](const auto& c) { return c.settings.integrator == &kAo; });
  EXPECT_EQ(last_ao->name(), "denoise ao 16 ao");
  EXPECT_EQ(last_ao->flags(), "--denoise --integrator ao --ao-samples 16");
}

class StudyCommand : public ProgramTest {
protected:
  Outcome study(const std::vector<std::string>& extra, const RunOptions& options = {}) {
    std::vector<std::string> arguments = {WAVEPATH_BINARY, "study", scene_};
    arguments.insert(arguments.end(), extra.begin(), extra.end());
    return run_program(arguments, options);
  }
  void refuses(const std::vector<std::string>& extra, int exit_code, const std::string& why) {
    const Outcome outcome = study(extra);
    EXPECT_EQ(outcome.exit_code, exit_code) << outcome.err;
    EXPECT_NE(outcome.err.find(why), std::string::npos) << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    EXPECT_FALSE(fs::exists(out_));
  }
  std::string read(const std::string& name) const {
    std::ifstream file(fs::path(out_) / name);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  // Runs a command of the document in its folder.
  Outcome repeat(const std::string& command) const {
    std::vector<std::string> words;
    for (std::istringstream line(command); line;) {
      std::string word;
      if (line >> word) words.push_back(word);
    }
    EXPECT_EQ(words.front(), "wavepath");
    words.front() = WAVEPATH_BINARY;
    words.insert(words.end(), {"--json", "-q"});
    RunOptions options;
    options.folder = folder_.path().string();
    return run_program(words, options);
  }

  // The command that a row gives renders the picture that the row measured.
  void expect_repeatable(const Json& point) const {
    const Outcome outcome = repeat(point["command"]);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const Json last = Json::parse(outcome.out)["checkpoints"].back();
    for (const char* key : {"mse", "relmse", "mrse", "flip"})
      EXPECT_DOUBLE_EQ(last[key].get<double>(), point[key].get<double>()) << key;
  }

  std::string scene_ = kCornell;
  TemporaryFolder folder_;
  std::string out_ = folder_.file("study");
};

TEST_F(StudyCommand, LeavesDocumentTableAndPage) {
  const Outcome outcome = study({"-o", out_, "--size", "32x32", "--budget", "4"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.out, "");
  const Json json = Json::parse(read("study.json"));
  for (const char* key : {"wavepath", "scene", "command", "date", "filter"}) EXPECT_TRUE(json[key].is_string()) << key;
  EXPECT_EQ(json["size"], Json({32, 32}));
  EXPECT_EQ(json["vary"], Json({"sampler", "direct"}));
  EXPECT_FALSE(json["interrupted"]);
  EXPECT_GT(json["reference"]["relative_rms"].get<double>(), 0.0);
  EXPECT_GT(json["equal_time"]["seconds"].get<double>(), 0.0);
  EXPECT_EQ(json["equal_time"]["rows"].size(), 9u);
  ASSERT_EQ(json["configurations"].size(), 9u);

  const std::string csv = read("study.csv"), page = read("report.html");
  std::ptrdiff_t rows = 1;
  for (const Json& configuration : json["configurations"]) {
    const Json& points = configuration["points"];
    ASSERT_GE(points.size(), 1u);
    rows += static_cast<std::ptrdiff_t>(points.size());
    EXPECT_NE(page.find(configuration["name"].get<std::string>()), std::string::npos);
    // Three points make a slope. Those do not count that the reference's own noise hides.
    const auto counted = std::ranges::count_if(points, [](const Json& point) { return !point["at_floor"]; });
    EXPECT_EQ(configuration["slope"]["spp"].is_null(), counted < 3);
    for (std::size_t i = 0; i < points.size(); ++i) {
      EXPECT_EQ(points[i]["spp"], 1 << i);
      for (const char* key : {"seconds", "mse", "relmse", "mrse", "flip", "efficiency"})
        EXPECT_GT(points[i][key].get<double>(), 0.0) << key;
      EXPECT_NEAR(points[i]["relative_rms"].get<double>(), std::sqrt(points[i]["relmse"].get<double>()), 1e-12);
    }
  }
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), rows);
  EXPECT_EQ(page.find("http:"), std::string::npos);
  EXPECT_EQ(page.find("https:"), std::string::npos);
  EXPECT_TRUE(page.starts_with("<!DOCTYPE html>") && page.ends_with("</html>\n"));
  for (const auto& entry : fs::directory_iterator(out_))
    EXPECT_NE(entry.path().filename().string()[0], '.') << entry.path(); // no temporary file is left
}

// Every technique that suits the scene is scored after as many samples as all others; the rest are named with the
// reason. Of a sun traced shadows are the truth, and so are those that equal them: the truth is that of the very points
// that a picture sees, so that edges within pixels are no error.
TEST_F(StudyCommand, ScoresShadowTechniques) {
  const Outcome outcome = run_program({WAVEPATH_BINARY, "study", WAVEPATH_SOURCE_DIR "/scenes/furnace_lambert.gltf",
                                       "--sun", "30,50", "--env", "black", "-o", out_, "--size", "24x24", "--budget",
                                       "4", "--vary", "shadows", "--max-depth", "1"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const Json json = Json::parse(read("study.json"));
  EXPECT_EQ(json["configurations"].size() + json["unfit"].size(), kShadowTechniques.names().size());
  EXPECT_EQ(json["configurations"][0]["name"], "traced");
  const std::size_t points = json["configurations"][0]["points"].size();
  for (const Json& configuration : json["configurations"]) {
    SCOPED_TRACE(configuration["name"].get<std::string>());
    ASSERT_EQ(configuration["points"].size(), points);
    const Json& shadows = configuration["points"].back()["shadows"];
    EXPECT_GE(shadows["relative_rms"].get<double>(), 0.0);
    EXPECT_LT(shadows["falsely_lit"].get<double>() + shadows["falsely_dark"].get<double>(), 0.5);
    EXPECT_TRUE(shadows["look_up_ms"]["median"].is_number());
    EXPECT_NE(configuration["points"].back()["command"].get<std::string>().find("--integrator hybrid"),
              std::string::npos);
    EXPECT_NE(configuration["points"].back()["command"].get<std::string>().find("--shadow-samples 1 "),
              std::string::npos);
    const std::string name = configuration["name"];
    const double error = shadows["relative_rms"];
    EXPECT_TRUE(name == "traced" || name == "izb" ? error < 1e-6 : error >= 0.0) << error; // light is rounded
    EXPECT_TRUE(name != "lightmap" || error > 1e-3) << error;
    if (name == "traced") continue;
    EXPECT_EQ(shadows["covered"], "1 sun");
    EXPECT_GT(shadows["bytes"].get<double>(), 0.0);
  }
  for (const Json& one : json["unfit"]) EXPECT_NE(one["why"].get<std::string>(), "");
  EXPECT_NE(read("report.html").find("falsely<br>lit"), std::string::npos);
  EXPECT_NE(read("study.csv").find("edge_displacement_pixels"), std::string::npos);
}

// What can be known of the errors: the hybrid's direct light is the path tracer's, and its occlusion rays are those of
// the picture of occlusion, by the same random numbers.
TEST_F(StudyCommand, TellsWhatTheHybridLoses) {
  const Outcome outcome = study({"-o", out_, "--size", "32x32", "--budget", "6", "--vary", "integrator,denoise"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const Json json = Json::parse(read("study.json"));
  std::map<std::string, Json> first;
  for (const Json& configuration : json["configurations"]) {
    ASSERT_FALSE(configuration["points"].empty());
    for (const Json& point : configuration["points"]) {
      EXPECT_GT(point["ms_per_frame"].get<double>(), 0.0);
      EXPECT_EQ(point["full"].is_null(), configuration["shows"] == "ao");
      const Json& integrator = configuration["flags"]["integrator"];
      const bool tells_direct = integrator != "bidirectional" && integrator != "radiosity"; // these lack the channel
      EXPECT_EQ(point["direct"].is_null(), configuration["shows"] == "ao" || !tells_direct);
      EXPECT_EQ(point["ao"].is_null(), integrator != "hybrid" && integrator != "ao");
    }
    first[configuration["name"]] = configuration["points"][0];
  }
  EXPECT_EQ(first.size(), 12u); // path, bidirectional, whitted, radiosity, hybrid and ao, with and without filter
  const auto mse = [&](const char* name, const char* signal) { return first[name][signal]["mse"].get<double>(); };
  EXPECT_LT(mse("hybrid", "ao"), 2.0 * mse("ao", "ao")); // what sees nothing is no error in either
  EXPECT_LT(mse("hybrid", "direct"), 2.0 * mse("path", "direct"));
  EXPECT_GT(json["first_hits"]["rasterized_ms"].get<double>(), 0.0);
  EXPECT_GT(json["first_hits"]["traced_ms"].get<double>(), 0.0);
  EXPECT_NE(read("report.html").find("What the approximation costs"), std::string::npos);
  EXPECT_TRUE(fs::exists(out_ + "/ao-reference.exr") && fs::exists(out_ + "/pictures/ao-reference.png"));
}

TEST_F(StudyCommand, RowsCanBeRepeated) {
  ASSERT_EQ(study({"-o", out_, "--size", "32x32", "--budget", "1", "--vary", "sampler", "--yfov", "30"}).exit_code, 0);
  expect_repeatable(Json::parse(read("study.json"))["configurations"][1]["points"].back());
}

// Pictures as large as those of studies are by default, under a sky: every pilot of `render` would be made.
TEST_F(StudyCommand, RowsAndReferencesOfTheUsualSizeCanBeRepeated) {
  ASSERT_EQ(study({"-o", out_, "--size", "256x256", "--max-depth", "3", "--budget", "8", "--vary", "sampler", "--env",
                   "0.5,0.6,0.7"})
                .exit_code,
            0);
  const Json json = Json::parse(read("study.json"));
  expect_repeatable(json["configurations"][1]["points"].back());
  const std::string kept = folder_.file("kept.exr"), reference = json["reference"]["file"];
  fs::copy_file(reference, kept);
  ASSERT_EQ(repeat(json["reference"]["command"]).exit_code, 0);
  EXPECT_EQ(run_program({WAVEPATH_BINARY, "compare", reference, kept, "--max", "mse=0"}).exit_code, 0);
}

// Each way to filter textures has a packed scene of its own; the reference has exact ones, whatever the flag says.
TEST_F(StudyCommand, VariesHowTexturesAreFiltered) {
  scene_ = WAVEPATH_SOURCE_DIR "/scenes/showcase.glb";
  const Outcome outcome =
      study({"-o", out_, "--size", "32x24", "--budget", "2", "--vary", "textures", "--textures", "hardware"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const Json json = Json::parse(read("study.json"));
  ASSERT_EQ(json["configurations"].size(), 2u);
  EXPECT_EQ(json["configurations"][0]["name"], "exact");
  EXPECT_EQ(json["configurations"][1]["name"], "hardware");
  for (const Json& configuration : json["configurations"]) expect_repeatable(configuration["points"].back());
  const std::string kept = folder_.file("kept.exr"), reference = json["reference"]["file"];
  fs::copy_file(reference, kept);
  const std::string command = json["reference"]["command"];
  EXPECT_EQ(command.find("hardware"), std::string::npos) << command;
  ASSERT_EQ(repeat(command).exit_code, 0);
  EXPECT_EQ(run_program({WAVEPATH_BINARY, "compare", reference, kept, "--max", "mse=0"}).exit_code, 0);
}

TEST_F(StudyCommand, TakesAReferenceThatIsThere) {
  const std::string reference = folder_.file("reference.exr");
  ASSERT_EQ(run_program({WAVEPATH_BINARY, "render", kCornell, "--size", "32x24", "--spp", "256", "--filter", "gaussian",
                         "-q", "-o", reference})
                .exit_code,
            0);
  const Outcome outcome =
      study({"-o", out_, "--size", "32x24", "--budget", "1", "--vary", "hemisphere", "--reference", reference});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const Json json = Json::parse(read("study.json"));
  EXPECT_TRUE(json["reference"]["given"]);
  EXPECT_EQ(json["filter"], "gaussian");
  EXPECT_GT(json["reference"]["relative_rms"].get<double>(), 0.0);
  EXPECT_EQ(json["configurations"].size(), 2u);
}

// A view of nothing: there is no error, and so neither slope nor an error at which it levels off.
TEST_F(StudyCommand, BearsAPictureWithoutError) {
  const Outcome outcome = study({"-o", out_, "--size", "8x8", "--budget", "0.5", "--vary", "sampler", "--eye",
                                 "0,0,-99", "--look-at", "0,0,-100"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const Json json = Json::parse(read("study.json"));
  EXPECT_EQ(json["configurations"][0]["points"][0]["mse"], 0.0);
  EXPECT_TRUE(json["configurations"][0]["slope"]["seconds"].is_null());
  EXPECT_NE(read("report.html").find("nothing to compare"), std::string::npos);
}

TEST_F(StudyCommand, RefusesWhatCannotBe) {
  refuses({"-o", out_, "--vary", "sampler,colour"}, 2, "'colour'");
  refuses({"-o", out_, "--vary", "branching,ao-samples"}, 2, "vary the integrator as well");
  refuses({"-o", out_, "--budget", "0"}, 2, "--budget");
  refuses({"-o", out_, "--size", "32"}, 2, "WIDTHxHEIGHT");
  refuses({"-o", out_, "--reference", folder_.file("none.exr")}, 1, "does not exist");
  refuses({"-o", folder_.file("missing/study")}, 1, "does not exist");
  const std::string reference = folder_.file("wide.exr");
  Picture picture{4, 2, {}};
  for (const char* name : {"R", "G", "B"}) picture.channels.push_back({name, std::vector<float>(8, 0.5f)});
  write_picture(reference, picture, {}, {});
  refuses({"-o", out_, "--reference", reference}, 2, "--size 4x2");
  const std::string text = folder_.file("text.exr");
  std::ofstream(text) << "no picture";
  refuses({"-o", out_, "--reference", text}, 1, text);
}

TEST_F(StudyCommand, WithoutPythonTheNumbersAreThere) {
  RunOptions options;
  options.in_child = [] { setenv("PYTHONHOME", "/nonexistent", 1); }; // no Python starts
  const Outcome outcome = study({"-o", out_, "--size", "16x16", "--budget", "1", "--vary", "hemisphere"}, options);
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.err.find("report.html"), std::string::npos) << outcome.err;
  EXPECT_TRUE(fs::exists(out_ + "/study.json") && fs::exists(out_ + "/study.csv"));
  EXPECT_FALSE(fs::exists(out_ + "/report.html"));
}

} // namespace
} // namespace wavepath::test
