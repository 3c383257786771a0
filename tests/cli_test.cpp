// The command line without rendering: help, mistakes, exit codes, info and compare. Needs no Vulkan device.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <sstream>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "host/cli/flags.h"
#include "host/cli/progress.h"
#include "host/picture/files/picture_io.h"
#include "host/render/settings/settings_table.h"
#include "tests/run_wavepath.h"
#include "tests/temporary_folder.h"
#include "tests/volume_files.h"

namespace wavepath::test {
namespace {

std::string scene_file(const std::string& name) { return std::string(WAVEPATH_SOURCE_DIR "/scenes/") + name; }

Outcome run_wavepath(std::vector<std::string> arguments, const RunOptions& options = {}) {
  arguments.insert(arguments.begin(), WAVEPATH_BINARY);
  return run_program(std::move(arguments), options);
}

// A mistake gives its exit code, one line on stderr that holds `text`, and nothing on stdout.
void expect_error(const std::vector<std::string>& arguments, int exit_code, const std::string& text) {
  const Outcome outcome = run_wavepath(arguments);
  EXPECT_EQ(outcome.exit_code, exit_code) << outcome.err;
  EXPECT_EQ(outcome.err.rfind("wavepath: error: ", 0), 0u) << outcome.err;
  EXPECT_NE(outcome.err.find(text), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("; "), std::string::npos) << "no remedy: " << outcome.err;
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  EXPECT_EQ(outcome.out, "");
}

// Without line breaks and indentation.
std::string flowing(const std::string& text) {
  std::istringstream words(text);
  std::string line;
  for (std::string word; words >> word;) line += word + " ";
  return line;
}

const std::string kBox = scene_file("cornell_box.gltf");

// Lines of a help text that begin a flag.
std::size_t flags_in(const std::string& help) {
  const std::regex flag("\\n  (-[a-z], |    )--");
  return static_cast<std::size_t>(std::distance(std::sregex_iterator(help.begin(), help.end(), flag), {}));
}

bool names_flag(const std::string& help, std::string_view name) {
  return std::regex_search(help, std::regex(fmt::format("\n      --{}[ \n]", name)));
}

TEST(Help, ShowsWhatUsersNeedAndAllOfItWhenAsked) {
  const Outcome usual = run_wavepath({"render", "--help"}), all = run_wavepath({"render", "--help-all"});
  EXPECT_EQ(all.exit_code, 0);
  EXPECT_EQ(all.err, "");
  EXPECT_GE(flags_in(usual.out), 50u);
  EXPECT_LE(flags_in(usual.out), 60u);
  std::size_t advanced = 0;
  for (const Setting& row : settings_table()) {
    if (!(row.offered & kByRender)) continue;
    EXPECT_TRUE(names_flag(all.out, row.name)) << row.name;
    EXPECT_EQ(names_flag(usual.out, row.name), !row.advanced) << row.name;
    advanced += row.advanced;
  }
  EXPECT_GE(flags_in(all.out), flags_in(usual.out) + advanced);
  EXPECT_NE(usual.out.find(fmt::format("'wavepath render --help-all' shows {} more flags",
                                       flags_in(all.out) - flags_in(usual.out))),
            std::string::npos);
  EXPECT_NE(all.out.find("'wavepath render --help'"), std::string::npos);
}

TEST(Help, OfOtherCommandsFollowsTheSameRows) {
  for (const char* command : {"view", "serve", "bench", "study", "info"}) {
    const Outcome usual = run_wavepath({command, "--help"}), all = run_wavepath({command, "--help-all"});
    EXPECT_LT(flags_in(usual.out), flags_in(all.out)) << command;
    for (const Setting& row : settings_table()) {
      if (row.name == "shadows" && command == std::string("study")) continue; // a switch of its own
      EXPECT_EQ(names_flag(usual.out, row.name), !row.advanced && names_flag(all.out, row.name))
          << command << " " << row.name;
    }
  }
  for (const char* command : {"compare", "merge", "selftest"}) { // without flags for experts
    const Outcome usual = run_wavepath({command, "--help"}), all = run_wavepath({command, "--help-all"});
    EXPECT_EQ(all.exit_code, 0) << command;
    EXPECT_EQ(usual.out, all.out) << command;
    EXPECT_EQ(usual.out.find("--help-all\n"), std::string::npos) << command;
  }
}

// All flags for experts in one command line, each with its default: the scene is what is wrong.
TEST(Usage, FlagsThatHelpLeavesOutAreTaken) {
  std::vector<std::string> words = {"render", "none.gltf", "--bvh", "auto", "--origin", "0,0,0"};
  std::size_t taken = 0;
  for (const Setting& row : settings_table()) {
    const std::string value = text_of(row, {});
    if (!row.advanced || value.empty()) continue;
    words.push_back(fmt::format("--{}={}", row.name, value));
    ++taken;
  }
  EXPECT_GT(taken, 30u);
  expect_error(words, 1, "none.gltf: ");
}

TEST(Help, DocumentsEveryFlag) {
  const Outcome help = run_wavepath({"render", "--help-all"});
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_EQ(help.err, "");
  for (const char* flag : {"SCENE",
                           "-o, --output FILE",
                           "--size WxH",
                           "--camera NAME|INDEX",
                           "--eye X,Y,Z",
                           "--look-at X,Y,Z",
                           "--up X,Y,Z",
                           "--yfov DEG",
                           "--env FILE|R,G,B",
                           "--env-intensity X",
                           "--env-rotation DEG",
                           "--spp N",
                           "--time SECONDS",
                           "--target-error E",
                           "--max-depth N",
                           "--integrator",
                           "--sampler independent|stratified|sobol",
                           "--hemisphere cosine|uniform",
                           "--direct mis|nee|bsdf",
                           "--seed N",
                           "--samples A:B",
                           "--filter box|gaussian|blackman-harris",
                           "--aov LIST",
                           "--exposure EV",
                           "--tonemap none|aces|agx|neutral",
                           "--stats FILE.json",
                           "--reference FILE.exr",
                           "--strict",
                           "--device NAME|INDEX",
                           "--specialize on|off",
                           "-q",
                           "-v",
                           "--json",
                           "--half",
                           "--animation NAME|INDEX",
                           "--at SECONDS"})
    EXPECT_NE(help.out.find(flag), std::string::npos) << flag;
  for (const char* initial : {"[default: 1280x720]", "[default: 8]", "[default: sobol]", "[default: mis]",
                              "[default: cosine]", "[default: neutral]", "SCENE-stem.exr]"})
    EXPECT_NE(flowing(help.out).find(initial), std::string::npos) << initial;
  for (std::size_t first = 0; first < help.out.size(); first = help.out.find('\n', first) + 1)
    EXPECT_LE(help.out.find('\n', first) - first, 100u) << help.out.substr(first, 110);
}

TEST(Help, ListsCommandsAndVersion) {
  const Outcome help = run_wavepath({"--help"}), version = run_wavepath({"--version"});
  for (const char* command : {"render", "info", "compare"}) EXPECT_NE(help.out.find(command), std::string::npos);
  EXPECT_EQ(version.exit_code, 0);
  EXPECT_EQ(version.out, "wavepath " WAVEPATH_VERSION "\n");
}

TEST(Usage, UnknownNamesSuggestTheNearest) {
  expect_error({"render", kBox, "--ssp", "4"}, 2, "--ssp: no such flag of 'wavepath render'; did you mean --spp?");
  expect_error({"render", kBox, "--samplr=sobol"}, 2, "did you mean --sampler?");
  expect_error({"render", "--zzzzzzzz"}, 2, "--zzzzzzzz: no such flag");
  expect_error({"rendr", kBox}, 2, "rendr: no such command; did you mean render?");
  expect_error({"render", kBox, "--sampler", "sobl"}, 2, "did you mean sobol?");
  expect_error({"render", kBox, "--aov", "albedo,nromal"}, 2, "did you mean normal?");
  expect_error({"--spp", "4", "render", kBox}, 2, "stands before the command");
}

TEST(Usage, WhatAnIntegratorCannotDoIsRefused) {
  const auto refused = [](std::vector<std::string> flags, const std::string& why) {
    flags.insert(flags.begin(), {"render", kBox});
    expect_error(flags, 2, why);
  };
  refused({"--integrator", "hybird"}, "did you mean hybrid?");
  refused({"--branching", "choice"},
          "--branching: is not supported by --integrator path; use --integrator whitted, or leave it out");
  refused({"--denoise", "--strict"}, "--denoise: is biased, which --strict refuses; leave out --denoise");
  refused({"--clamp", "10", "--strict"}, "--clamp: is biased, which --strict refuses; leave it out");
  refused({"--clamp", "10", "--integrator", "bidirectional"},
          "--clamp: is not supported by --integrator bidirectional");
  refused({"--clamp", "-1"}, "--clamp");
  refused({"--sun-angle", "181"}, "--sun-angle");
  refused({"--sun-angle", "1e-9"}, "--sun-angle: '1e-9' is too small");
  refused({"--lamp-radius", "-1"}, "--lamp-radius");
  refused({"--textures", "hardware", "--strict"}, "--textures hardware: is biased, which --strict refuses");
  refused({"--denoise", "oidn", "--integrator", "hybrid"},
          "--denoise oidn: cannot filter the frames of --integrator hybrid");
  refused({"--aov", "ao"}, "--aov ao: is not supported by --integrator path; use --integrator hybrid or ao");
  refused({"--integrator", "hybrid", "--adaptive"},
          "--adaptive: is not supported by --integrator hybrid; use --integrator path");
  refused({"--integrator", "hybrid", "--strict"}, "--integrator hybrid: is biased, which --strict refuses");
  refused({"--integrator", "ao", "--strict", "--denoise"}, "leave out --denoise");
  refused({"--integrator", "bidirectional", "--strict", "--techniques", "hit,light,connect,splat,merge"},
          "--strict: refuses merging");
  refused({"--integrator", "ao", "--denoise", "--mergeable"}, "--denoise: makes every sample depend on those before");
  refused({"--integrator", "ao", "--pixel", "1,1", "--sample", "0"},
          "--pixel: is not supported by --integrator ao; use --integrator path");
  refused({"--integrator", "hybrid", "--shadow-samples", "0"}, "--shadow-samples");
  refused({"--integrator", "hybrid", "--ambient", "1,-1,1"}, "'1,-1,1' is negative");
  refused({"--integrator", "hybrid", "--ambient", "1,1,1e300"}, "'1,1,1e300' is too large");
}

TEST(Usage, AlphaThatCannotBeToldIsRefused) {
  const auto refused = [](std::vector<std::string> flags, const std::string& why, int exit_code = 2) {
    flags.insert(flags.begin(), {"render", kBox});
    expect_error(flags, exit_code, why);
  };
  refused({"--integrator", "whitted", "--transparent"},
          "--transparent: is not supported by --integrator whitted; use --integrator path");
  refused({"--integrator", "hybrid", "--catcher", "ground"}, "--catcher: is not known to --integrator hybrid");
  refused({"--integrator", "bidirectional", "--catcher", "ground"},
          "--catcher: is not known to --integrator bidirectional");
  refused({"--integrator", "bidirectional", "--aov", "shadow"}, "--aov shadow: is not supported");
  refused({"--integrator", "hybrid", "--aov", "environment"}, "--aov environment: is not supported");
  refused({"--catcher", ""}, "--catcher");
  refused({"--transparent", "--reuse"}, "--reuse: shares light between pixels");
  refused({"--catcher", "ground", "--direct", "nee", "--integrator", "path"}, "--catcher: compares light");
  refused({"--catcher", "no such node"}, "--catcher: no node no such node shows triangles");
}

TEST(Usage, CamerasThatCannotBeAreRefused) {
  const auto refused = [](std::vector<std::string> flags, const std::string& why) {
    flags.insert(flags.begin(), {"render", kBox});
    expect_error(flags, 2, why);
  };
  refused({"--projection", "fisheyes"}, "did you mean fisheye?");
  refused({"--projection", "fisheye", "--fov", "361"}, "--fov: '361' is more than there is");
  refused({"--fov", "90"}, "--fov: belongs to --projection fisheye");
  refused({"--projection", "fisheye", "--yfov", "90"}, "--yfov: belongs to --projection perspective");
  refused({"--projection", "perspective", "--ymag", "2"}, "--ymag: belongs to --projection orthographic");
  refused({"--ymag", "0"}, "--ymag");
  refused({"--shift", "1"}, "write it as X,Y");
  refused({"--shift", "nan,0"}, "--shift");
  refused({"--projection", "equirectangular", "--shift", "1,0"}, "--shift: has no meaning");
  refused({"--projection", "equirectangular", "--intrinsics", "1,1,0,0"}, "--intrinsics: has no meaning");
  for (const char* k : {"0,800,640,360", "800,0,640,360", "-800,800,640,360"})
    refused({"--intrinsics", k}, "is a singular matrix, or mirrors");
  refused({"--intrinsics", "800,800,640"}, "is not four numbers");
  refused({"--intrinsics", "800,800,640,inf"}, "is not four numbers");
  refused({"--intrinsics", "800,800,640,360", "--yfov", "40"}, "--intrinsics: does not go with --yfov");
  refused({"--intrinsics", "800,800,640,360", "--shift", "0,0"}, "--intrinsics: does not go with --shift");
  refused({"--clip", "1"}, "write it as NEAR,FAR");
  refused({"--clip", "2,1"}, "leaves nothing between its planes");
  refused({"--clip", "inf,inf"}, "--clip");
  refused({"--clip", "-1,2"}, "--clip");
  refused({"--stereo", "-0.1"}, "--stereo");
  refused({"--stereo", "0.065", "--size", "101x50"}, "--stereo: cannot halve a picture 101 pixels wide");
  refused({"--stereo", "0.065", "--projection", "equirectangular", "--size", "100x51"}, "51 pixels high");
  refused({"--stereo", "0.065", "--projection", "orthographic"}, "--stereo: would show both eyes the same");
  refused({"--projection", "fisheye", "--aperture", "0.1"}, "--aperture: blurs about a plane of focus");
  refused({"--velocity", "0,0"}, "--velocity");
  refused({"--velocity", "0,0,nan"}, "--velocity");
  refused({"--velocity", "0,-1,0"}, "--velocity: '0,-1,0' is not slower than light");
  refused({"--velocity", "0.6,0.6,0.6"}, "is not slower than light");
  refused({"--velocity", "0,0,0.9999999"}, "is too near the speed of light");
  refused({"--velocity", "0,0,0.5", "--projection", "orthographic"}, "--velocity: is that of an eye");
  refused({"--velocity", "0,0,0.5", "--stereo", "0.1"}, "--velocity: does not go with --stereo");
  refused({"--velocity", "0,0,0.5", "--aperture", "0.1"}, "--aperture: blurs about a plane of focus");
  refused({"--velocity", "0,0,0.5", "--integrator", "hybrid"}, "--velocity: is not known to --integrator hybrid");
}

// With and without a window in the build, with and without a screen: no scene is read before the refusal.
TEST(Usage, ViewNeedsAScreen) {
  const std::string broken = scene_file("README.md"); // no glTF
  const RunOptions no_screen{.in_child = [] {
    for (const char* name : {"DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"}) unsetenv(name);
  }};
  const Outcome outcome = run_wavepath({"view", broken}, no_screen);
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_EQ(outcome.err.rfind("wavepath: error: view: ", 0), 0u) << outcome.err;
  EXPECT_NE(outcome.err.find("'wavepath render'"), std::string::npos) << outcome.err;
  expect_error({"view", scene_file("missing.gltf")}, 1, "does not exist");
  expect_error({"view", kBox, "--screenshot", "a.png"}, 2, "--screenshot: does not say when; add --frames N");
  expect_error({"view", kBox, "--frames", "9", "--spp", "4"}, 2, "--frames: 9 is more than --spp 4");
  expect_error({"view", kBox, "--frames", "9", "--screenshot", "a.txt"}, 2, "no extension that names a picture format");
  expect_error({"view", kBox, "--frames", "9", "--screenshot", "nowhere/a.png"}, 1, "nowhere");
  expect_error({"view", kBox, "--aov", "albedo,node"}, 2, "--aov node: is found once a picture is finished");
  expect_error({"view", kBox, "--show", "albdo"}, 2, "did you mean albedo?");
}

// A variable that leads the Vulkan loader astray is named with its value, whichever command finds no driver.
TEST(Usage, ABogusListOfDriversIsNamed) {
  for (const char* stem : {"ICD_FILENAMES", "DRIVER_FILES"}) {
    const TemporaryFolder folder;
    const std::string prefix = "VK_", name = prefix + stem;
    const RunOptions astray{.in_child = [&] {
      for (const char* other : {"ICD_FILENAMES", "DRIVER_FILES", "ADD_DRIVER_FILES"})
        unsetenv((prefix + other).c_str());
      setenv(name.c_str(), "/nowhere/driver.json", 1);
    }};
    const std::string words = name + " is '/nowhere/driver.json', which hides the drivers";
    const Outcome render = run_wavepath({"render", kBox, "-o", folder.file("a.exr")}, astray);
    EXPECT_EQ(render.exit_code, 1);
    EXPECT_NE(render.err.find("wavepath: error: Vulkan: there is no driver; " + words), std::string::npos)
        << render.err;
    const Outcome info = run_wavepath({"info"}, astray);
    EXPECT_EQ(info.exit_code, 0);
    EXPECT_NE(info.out.find("no Vulkan device: " + words), std::string::npos) << info.out;
  }
}

TEST(Usage, BadValues) {
  expect_error({"render", kBox, "--size", "0x0"}, 2, "--size: '0' is not");
  expect_error({"render", kBox, "--size", "1e9x1e9"}, 2, "--size: '1e9' is not");
  expect_error({"render", kBox, "--size", "1000000000x1000000000"}, 2, "from 1 to 65536");
  expect_error({"render", kBox, "--size", "640"}, 2, "WIDTHxHEIGHT");
  expect_error({"render", kBox, "--spp", "0"}, 2, "--spp: '0'");
  expect_error({"render", kBox, "--spp", "-3"}, 2, "--spp: '-3'");
  expect_error({"render", kBox, "--spp", "99999999999999999999999"}, 2, "--spp: '9");
  expect_error({"render", kBox, "--samples", "8:4"}, 2, "empty range");
  expect_error({"render", kBox, "--samples", "0:128", "--spp", "64"}, 2, "ends beyond --spp 64");
  expect_error({"render", kBox, "--time", "nan"}, 2, "--time: 'nan'");
  expect_error({"render", kBox, "--target-error", "0"}, 2, "--target-error: '0'");
  expect_error({"render", kBox, "--env", "1,nan,1"}, 2, "--env: '1,nan,1'");
  expect_error({"render", kBox, "--env", "1,-1,1"}, 2, "is negative");
  expect_error({"render", kBox, "--eye", "1,2"}, 2, "X,Y,Z");
  expect_error({"render", kBox, "--yfov", "180"}, 2, "too wide");
  expect_error({"render", kBox, "--exposure", "inf"}, 2, "--exposure");
}

TEST(Usage, VolumesThatCannotBeAreRefused) {
  const TemporaryFolder folder;
  const std::string cloud = folder.file("cloud.nvdb"), grid = folder.file("grid.vdb");
  const auto refused = [&](const std::vector<std::string>& flags, const std::string& why, int exit_code = 2) {
    std::vector<std::string> line = {"info", kBox, "--volume", cloud};
    line.insert(line.end(), flags.begin(), flags.end());
    expect_error(line, exit_code, why);
  };
  refused({}, "cloud.nvdb: cannot be read; check that it exists", 1);
  refused({"--volume", kBox}, "is no NanoVDB file; give a .nvdb", 1);
  std::ofstream(grid, std::ios::binary) << std::string(" BDV\0\0\0\0", 8) << std::string(64, ' ');
  refused({"--volume", grid}, "grid.vdb: is a file of OpenVDB; convert it by nanovdb_convert", 1);
  refused({"--volume", ""}, "--volume: '' names nothing");
  refused({"--volume-at", "1,2"}, "--volume-at: '1,2' is not three numbers; write it as X,Y,Z or X,Y,Z,SIZE");
  refused({"--volume-at", "1,2,3,0"}, "has no size that a volume can have");
  refused({"--volume-at", "1,2,1e16"}, "is too far away");
  refused({"--volume-density", "-1"}, "--volume-density: '-1'");
  refused({"--volume-albedo", "1,1,1.5"}, "--volume-albedo: '1,1,1.5' is not within 0 and 1");
  refused({"--volume-anisotropy", "1"}, "--volume-anisotropy: '1'");
  refused({"--volume-emission", "nan"}, "--volume-emission: 'nan'");
  refused({"--volume-temperature", "1,2,3"}, "--volume-temperature");
  expect_error({"render", kBox, "--volume-density", "2"}, 2, "--volume-density: is about a volume, and none is given");
}

TEST(Usage, MissingOrExcessArguments) {
  expect_error({}, 2, "no command is given");
  expect_error({"render"}, 2, "SCENE is required");
  expect_error({"render", kBox, "-o"}, 2, "--output");
  expect_error({"render", kBox, "other.gltf"}, 2, "other.gltf: is one argument too many");
  expect_error({"render", kBox, "-o", "a.tiff"}, 2, "end it in .exr, .hdr, .png or .jpg");
}

TEST(Files, AreCheckedBeforeAnythingIsLoaded) {
  const TemporaryFolder folder;
  const std::string nonsense = folder.file("nonsense.gltf"); // would fail to load
  std::ofstream(nonsense) << "{}";
  expect_error({"render", folder.file("absent.gltf")}, 1, "absent.gltf: does not exist");
  expect_error({"render", folder.path().string()}, 1, "is a folder");
  expect_error({"render", nonsense, "-o", folder.file("no/such/a.exr")}, 1, "does not exist; create it first");
  expect_error({"render", nonsense, "-o", "/proc/a.exr"}, 1, "/proc/a.exr");
  expect_error({"render", nonsense, "-o", folder.file("a.exr"), "--stats", folder.file("no/s.json")}, 1,
               "does not exist; create it first");
  std::ofstream(folder.file("r.exr")) << "no picture";
  expect_error({"render", nonsense, "-o", folder.file("a.exr"), "--reference", folder.file("r.exr")}, 1,
               "r.exr: cannot be opened as an image");
  expect_error({"render", nonsense, "-o", folder.file("r.exr"), "--reference", folder.file("r.exr")}, 2,
               "would overwrite an input");
  EXPECT_FALSE(std::filesystem::exists(folder.file("a.exr")));
}

TEST(Info, TellsWhatASceneHolds) {
  const Outcome json = run_wavepath({"info", kBox, "--json"});
  ASSERT_EQ(json.exit_code, 0) << json.err;
  const auto about = nlohmann::json::parse(json.out);
  EXPECT_EQ(about["triangles"], 36);
  EXPECT_EQ(about["lights"]["emissive_triangles"], 2);
  EXPECT_EQ(about["lights"]["environment"], false);
  EXPECT_GT(about["bytes"]["total"].get<int>(), 36 * 48);
  EXPECT_FALSE(about["left_out"].empty());
  for (const auto& entry : about["left_out"]) {
    EXPECT_TRUE(entry["what"].is_string() && entry["why"].is_string() && entry["bytes"].is_number_unsigned());
  }
  const Outcome text = run_wavepath({"info", kBox});
  EXPECT_NE(text.out.find("triangles   36 seen"), std::string::npos) << text.out;
}

TEST(Info, TellsOfAVolume) {
  const TemporaryFolder folder;
  const std::string cloud = folder.file("cloud.nvdb");
  test::GridSpec spec;
  spec.voxel = 0.5;
  test::write_grids(cloud, nanovdb::io::Codec::BLOSC,
                    test::build_grid([](const test::Coord& p) { return static_cast<float>(1 + p[0]); },
                                     {test::Coord(0), test::Coord(15, 7, 7)}, spec));
  const std::vector<std::string> flags = {"info",
                                          kBox,
                                          "--volume",
                                          cloud,
                                          "--volume-at",
                                          "0,0,0,2",
                                          "--volume-albedo",
                                          "0.75,0.75,0.75",
                                          "--volume-density",
                                          "4"};
  std::vector<std::string> asks_json = flags;
  asks_json.emplace_back("--json");
  const Outcome json = run_wavepath(asks_json), text = run_wavepath(flags);
  ASSERT_EQ(json.exit_code, 0) << json.err;
  const auto volume = nlohmann::json::parse(json.out)["volume"];
  EXPECT_EQ(volume["file"], cloud);
  EXPECT_EQ(volume["box"], nlohmann::json::parse("[[-1.0, -0.5, -0.5], [1.0, 0.5, 0.5]]"));
  EXPECT_EQ(volume["scattering"], nlohmann::json::parse("[3.0, 3.0, 3.0]"));
  EXPECT_EQ(volume["absorption"], nlohmann::json::parse("[1.0, 1.0, 1.0]"));
  ASSERT_EQ(volume["grids"].size(), 1u);
  const auto& grid = volume["grids"][0];
  EXPECT_EQ(grid["name"], "density");
  EXPECT_EQ(grid["box_voxels"], nlohmann::json::parse("[16, 8, 8]"));
  EXPECT_EQ(grid["stored_bricks"], 2);
  EXPECT_EQ(grid["largest"], 16.0);
  EXPECT_NE(text.out.find("16 x 8 x 8 voxels in 2 bricks, 2 of them stored"), std::string::npos) << text.out;
  EXPECT_NE(text.out.find("scatters    3, 3, 3 /m"), std::string::npos) << text.out;
  EXPECT_EQ(nlohmann::json::parse(run_wavepath({"info", kBox, "--json"}).out)["volume"], nullptr);
}

TEST(Usage, FlagsOfARenderAreRefusedByName) {
  for (const char* flag : {"--frames", "--turntable", "--fps", "--layers", "--save-every"})
    expect_error({"info", kBox, flag, "1"}, 2, std::string(flag) + ": is a flag of 'wavepath render'");
  for (const char* flag : {"--turntable", "--fps", "--seed-per-frame"})
    expect_error({"view", kBox, flag, "1"}, 2, std::string(flag) + ": is a flag of 'wavepath render'");
  expect_error({"view", kBox, "--frames", "0:24"}, 2, "--frames: counts samples in a window");
  expect_error({"view", kBox, "--layers", "nuke"}, 2, "--layers");
}

// K of a camera of the file and of a render, and flags that change it.
TEST(Info, TellsCameras) {
  using Json = nlohmann::json;
  const auto about = [](const std::vector<std::string>& flags) {
    std::vector<std::string> arguments = {"info", kBox, "--json", "--size", "200x100"};
    arguments.insert(arguments.end(), flags.begin(), flags.end());
    const Outcome outcome = run_wavepath(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return Json::parse(outcome.out);
  };
  const Json plain = about({}), file = plain["cameras"][0];
  EXPECT_EQ(file["world_from_camera"], Json({-1, 0, 0, .278, 0, 1, 0, .273, 0, 0, -1, -.8, 0, 0, 0, 1}));
  const double half = std::tan(0.5 * file["yfov"].get<double>() * 3.14159265358979 / 180.0);
  const Json k = file["view"]["intrinsics"];
  EXPECT_NEAR(k[0].get<double>(), 50.0 / half, 1e-9);
  EXPECT_NEAR(k[1].get<double>(), 50.0 / half, 1e-9);
  EXPECT_EQ(Json({k[2], k[3]}), Json({100, 50}));
  EXPECT_NEAR(file["view"]["fov"][1].get<double>(), file["yfov"].get<double>(), 1e-9);
  EXPECT_EQ(file["view"], plain["camera"]);
  EXPECT_TRUE(file.contains("znear") && file.contains("zfar"));

  const Json shifted = about({"--shift", "0.25,0", "--eye", "0,0,9"});
  EXPECT_EQ(shifted["camera"]["intrinsics"][2], 50);
  EXPECT_EQ(shifted["camera"]["position"], Json({0, 0, 9}));
  EXPECT_EQ(shifted["cameras"][0]["view"]["intrinsics"][2], 50);
  EXPECT_EQ(shifted["cameras"][0]["view"]["position"], plain["camera"]["position"]) << "a camera of the file stays";
  const Json given = about({"--intrinsics", "80,90,30,40"});
  EXPECT_NEAR(given["camera"]["intrinsics"][1].get<double>(), 90.0, 1e-9);
  const Json sphere = about({"--projection", "equirectangular", "--stereo", "0.06"})["camera"];
  EXPECT_EQ(sphere["fov"], Json({360, 180}));
  EXPECT_TRUE(sphere["intrinsics"].is_null());
  EXPECT_EQ(sphere["stereo"], 0.06);

  const Outcome text = run_wavepath({"info", kBox, "--size", "200x100", "--intrinsics", "80,90,30,40"});
  for (const char* words : {"camera 0 'camera' at 200x100", "--intrinsics 80, 90, 30, 40",
                            "matrix, by rows:", "perspective from 0.278, 0.273, -0.8 along 0, 0, 1"})
    EXPECT_NE(text.out.find(words), std::string::npos) << words << "\n" << text.out;
  expect_error({"info", kBox, "--projection", "orthographic", "--stereo", "1"}, 2, "would show both eyes the same");
  expect_error({"info", kBox, "--stereo", "1", "--size", "63x48"}, 2, "cannot halve a picture");
}

TEST(Info, TellsWhatARenderTakes) {
  using Json = nlohmann::json;
  const auto renders = [](const std::string& scene, const std::vector<std::string>& flags) {
    std::vector<std::string> arguments = {"info", scene, "--json", "--size", "64x48"};
    arguments.insert(arguments.end(), flags.begin(), flags.end());
    const Outcome outcome = run_wavepath(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return Json::parse(outcome.out)["renders"];
  };
  const auto only = [&](const std::string& scene, const std::vector<std::string>& flags) {
    const Json all = renders(scene, flags);
    EXPECT_EQ(all.size(), 1u);
    return all[0];
  };
  const Json path = only(kBox, {"--integrator", "path", "--reuse", "off"});
  EXPECT_EQ(path["flags"], "path --reuse off");
  EXPECT_EQ(path["size"], Json({64, 48}));
  for (const char* item : {"film of splats", "photons", "guiding field", "learned lights", "learned sky"})
    EXPECT_FALSE(path["bytes"].contains(item)) << item;
  EXPECT_EQ(path["path_bytes"].size(), 2u) << path["path_bytes"]; // with the total
  EXPECT_GT(only(kBox, {"--reuse", "on"})["path_bytes"]["records for neighbours"], 0);
  EXPECT_GT(only(kBox, {"--guide"})["bytes"]["guiding field"], 1 << 20);

  const std::string bulb = scene_file("caustics/bulb_point.glb"), lit = scene_file("furnace_lambert.gltf");
  const std::vector<std::string> both = {"--integrator", "bidirectional", "--max-depth", "5"};
  const Json dull = only(kBox, both), smooth = only(bulb, both);
  EXPECT_EQ(dull["path_bytes"]["light vertices"], 4 * 64);
  EXPECT_GT(dull["bytes"]["film of splats"], 0);
  EXPECT_FALSE(dull["bytes"].contains("photons")) << "no surface is smooth";
  EXPECT_GT(smooth["bytes"]["photons"], 0);
  EXPECT_GT(only(lit, {"--integrator", "path"})["bytes"]["learned sky"], 0);
  std::uint64_t sum = 0;
  for (const auto& [name, bytes] : smooth["bytes"].items())
    if (name != "total") sum += bytes.get<std::uint64_t>();
  EXPECT_EQ(smooth["bytes"]["total"], sum);

  const Json candidates = renders(bulb, {});
  ASSERT_EQ(candidates.size(), 3u) << "those of --integrator auto";
  EXPECT_EQ(candidates[1]["flags"], "path --guide");
  const Outcome text = run_wavepath({"info", kBox, "--integrator", "bidirectional"});
  for (const char* words :
       {"\n  bidirectional\n    at 1280x720 at most ", "\n    film of splats ", "\n    light vertices "})
    EXPECT_NE(text.out.find(words), std::string::npos) << words << "\n" << text.out;
  expect_error({"info", kBox, "--integrator", "hybrid", "--guide"}, 2, "is not supported by --integrator hybrid");
}

TEST(Info, TellsWhatLightsTheSceneByRule) {
  const auto lights = [](const char* scene, const std::vector<std::string>& extra = {}) {
    std::vector<std::string> arguments = {"info", scene_file(scene), "--json"};
    arguments.insert(arguments.end(), extra.begin(), extra.end());
    return nlohmann::json::parse(run_wavepath(arguments).out)["lights"];
  };
  const auto starts_with = [](const nlohmann::json& rule, const std::string& words) {
    return rule.get<std::string>().rfind(words, 0) == 0;
  };
  EXPECT_TRUE(lights("furnace_lambert.gltf")["environment"]);
  EXPECT_TRUE(starts_with(lights("furnace_lambert.gltf")["by_rule"], "--env studio"));
  EXPECT_FALSE(lights("cornell_box.gltf")["environment"]);
  EXPECT_TRUE(starts_with(lights("cornell_box.gltf")["by_rule"], "as authored"));
  EXPECT_FALSE(lights("rooms/glazed_room.glb")["environment"]);
  for (const char* black : {"0,0,0", "black"}) {
    EXPECT_FALSE(lights("furnace_lambert.gltf", {"--env", black})["environment"]);
    EXPECT_EQ(lights("furnace_lambert.gltf", {"--env", black})["by_rule"], "");
  }
  expect_error({"info", kBox, "--env", "studoi"}, 2, "nor studio, sky, black or white");
}

// A file with variants of materials and with an image-based light.
std::string variants_file(const TemporaryFolder& folder) {
  constexpr const char* kPixel =
      "data:image/"
      "png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAIAAACQd1PeAAAADElEQVR42mNwaDgAAAKEAYEYanSHAAAAAElFTkSuQmCC";
  const std::string box = scene_file("furnace_lambert.gltf");
  auto root = nlohmann::json::parse(std::ifstream(box));
  root.erase("cameras");
  for (auto& node : root["nodes"]) node.erase("camera");
  root["extensions"]["KHR_materials_variants"]["variants"] = {{{"name", "red"}}, {{"name", "dark blue"}}};
  auto& images = root["images"] = nlohmann::json::array();
  nlohmann::json level = nlohmann::json::array();
  for (int face = 0; face < 6; ++face) images.push_back({{"uri", kPixel}}), level.push_back(face);
  root["extensions"]["EXT_lights_image_based"]["lights"] = {{{"specularImages", {level}}}};
  root["scenes"][0]["extensions"]["EXT_lights_image_based"]["light"] = 0;
  std::ofstream(folder.file("variants.gltf")) << root;
  return folder.file("variants.gltf");
}

TEST(Info, TellsVariantsAndRefusesUnknownOnes) {
  const TemporaryFolder folder;
  const std::string file = variants_file(folder);
  const auto about = nlohmann::json::parse(run_wavepath({"info", file, "--json", "--variant", "red"}).out);
  EXPECT_EQ(about["variants"], (std::vector<std::string>{"red", "dark blue"}));
  EXPECT_NE(run_wavepath({"info", file}).out.find("variants    red, dark blue\n"), std::string::npos);
  for (const char* command : {"info", "render", "study", "serve"}) {
    std::vector<std::string> arguments = {command, file, "--variant", "blue"};
    if (std::string(command) == "study") arguments.insert(arguments.end(), {"-o", folder.file("study")});
    const Outcome outcome = run_wavepath(arguments);
    EXPECT_NE(outcome.exit_code, 0) << command;
    EXPECT_NE(outcome.err.find("has no variant 'blue'; choose one of 'red', 'dark blue'"), std::string::npos)
        << command << ": " << outcome.err;
  }
  expect_error({"info", kBox, "--variant", "red"}, 1, "has no variant 'red'; leave the option out: it has no variants");
}

TEST(Info, TellsTheImageBasedLightOfAFile) {
  const TemporaryFolder folder;
  const std::string file = variants_file(folder);
  const auto lights = [&](const std::vector<std::string>& flags) {
    std::vector<std::string> arguments = {"info", file, "--json"};
    arguments.insert(arguments.end(), flags.begin(), flags.end());
    return nlohmann::json::parse(run_wavepath(arguments).out)["lights"];
  };
  EXPECT_EQ(lights({})["by_rule"], "as authored, by the image-based light of the file (--env replaces it)");
  EXPECT_TRUE(lights({})["environment"]);
  EXPECT_FALSE(lights({"--env-intensity", "0"})["environment"]);
  EXPECT_FALSE(lights({"--env", "black"})["environment"]);
  EXPECT_EQ(lights({"--env", "white"})["by_rule"], "");
}

class CompareTest : public ::testing::Test {
protected:
  void SetUp() override {
    Picture picture{32, 16, {}};
    for (const char* name : {"R", "G", "B", "A"}) picture.channels.push_back({name, std::vector<float>(512, 0.5f)});
    write_picture(reference_, picture, {}, {});
    picture.channels[1].values[7] = 0.75f;
    write_picture(image_, picture, {}, {});
    picture.channels[1].values[8] = std::numeric_limits<float>::quiet_NaN();
    write_picture(broken_, picture, {}, {});
  }
  TemporaryFolder folder_;
  std::string image_ = folder_.file("image.exr"), reference_ = folder_.file("reference.exr"),
              broken_ = folder_.file("broken.exr");
};

TEST_F(CompareTest, Measures) {
  const Outcome outcome = run_wavepath({"compare", image_, reference_, "--json", "--map", folder_.file("map.png")});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_NEAR(json["mse"], 0.0625 / 1536, 1e-12);
  EXPECT_NEAR(json["relmse"], 0.0625 / 0.26 / 1536, 1e-9);
  EXPECT_NEAR(json["mrse"], 0.0625 / (0.51 * 0.51) / 1536, 1e-9);
  EXPECT_EQ(json["max"], 0.25);
  EXPECT_EQ(json["nonfinite"]["image"], 0);
  EXPECT_GT(json["flip"].get<double>(), 0.0);
  EXPECT_NEAR(json["mean_ratio"][1], 1.0 + 0.5 / 512, 1e-9);
  EXPECT_EQ(read_picture(folder_.file("map.png")).width, 32u);
  EXPECT_NE(run_wavepath({"compare", image_, reference_}).out.find("relmse"), std::string::npos);
}

TEST_F(CompareTest, Checks) {
  EXPECT_EQ(run_wavepath({"compare", image_, reference_, "--max", "mse=0.001", "--max", "flip=0.5"}).exit_code, 0);
  const Outcome outcome = run_wavepath({"compare", image_, reference_, "--max", "mse=0.001", "--max", "max=0.1"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.err.find("max is 0.25, more than 0.1"), std::string::npos) << outcome.err;
  expect_error({"compare", image_, reference_, "--max", "msee=1"}, 2, "did you mean mse?");
  expect_error({"compare", image_, reference_, "--max", "mse"}, 2, "METRIC=VALUE");
}

TEST_F(CompareTest, NonFiniteImagesFail) {
  const Outcome outcome = run_wavepath({"compare", broken_, reference_, "--json"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_EQ(nlohmann::json::parse(outcome.out)["nonfinite"]["image"], 1);
  EXPECT_NE(outcome.err.find("not finite"), std::string::npos);
}

TEST(Suggestions, AreNearOrAbsent) {
  const std::vector<std::string> names = {"--output", "--spp", "--sampler", "--samples"};
  EXPECT_EQ(nearest_name("--out", names), "--output");
  EXPECT_EQ(nearest_name("--psp", names), "--spp");
  EXPECT_EQ(nearest_name("--quaternion", names), "");
}

TEST(ProgressText, TheFirstLimitReachedTellsWhatIsLeft) {
  const Progress half{32, 64, 0.5, 10.0, 3.5, {0.04, {0.03, 0.05}}};
  EXPECT_EQ(progress_text(half, 0.0, 0.0, 0), " 50 %  32/64 spp  10.0 s elapsed, 10.0 s left  3.50 Mrays/s  error 4 %");
  EXPECT_NE(progress_text(half, 12.0, 0.0, 0).find("2.0 s left"), std::string::npos);
  EXPECT_NE(progress_text(half, 0.0, 0.032, 0).find("5.6 s left"), std::string::npos); // 10 s * ((0.04 / 0.032)^2 - 1)
  EXPECT_NE(progress_text(half, 0.0, 0.0, 10).find("[#####.....]"), std::string::npos);
  EXPECT_NE(progress_text({0, 64, 0.0, 0.0, 0.0, {}}, 0.0, 0.0, 0).find("0/64 spp"), std::string::npos);
}

} // namespace
} // namespace wavepath::test
