// The real window on a virtual display, driven by real events: what it shows, how it reacts to input, and that its
// pictures have the bits of `wavepath render`.
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "host/picture/files/picture_io.h"
#include "tests/moving_lamps.h"
#include "tests/run_wavepath.h"
#include "tests/temporary_folder.h"
#include "tests/virtual_display.h"
#include "tests/vulkan_device.h"

namespace wavepath::test {
namespace {

const std::string kCornell = std::string(WAVEPATH_SOURCE_DIR) + "/scenes/cornell_box.gltf";

std::string contents(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// A process of `wavepath view`.
class View {
public:
  View(const VirtualDisplay& display, const std::string& folder, std::vector<std::string> flags,
       const std::string& scene = kCornell)
      : display_(display), out_(folder + "/out"), err_(folder + "/err") {
    flags.insert(flags.begin(), {WAVEPATH_BINARY, "view", scene});
    std::vector<char*> pointers;
    for (std::string& flag : flags) pointers.push_back(flag.data());
    pointers.push_back(nullptr);
    child_ = fork();
    if (child_ != 0) return;
    dup2(open(out_.c_str(), O_CREAT | O_WRONLY | O_TRUNC, 0600), STDOUT_FILENO);
    dup2(open(err_.c_str(), O_CREAT | O_WRONLY | O_TRUNC, 0600), STDERR_FILENO);
    setenv("DISPLAY", display.name().c_str(), 1);
    unsetenv("WAYLAND_DISPLAY");
    if (chdir(folder.c_str()) == 0) execv(pointers[0], pointers.data());
    _exit(99);
  }
  ~View() {
    if (child_ > 0) {
      kill(child_, SIGKILL);
      waitpid(child_, nullptr, 0);
    }
  }
  View(View&&) = delete;

  std::string out() const { return contents(out_); }
  std::string err() const { return contents(err_); }
  pid_t process() const { return child_; }

  // Waits until the condition holds; a minute is far more than any of them needs.
  template <class Condition>
  bool until(Condition&& condition) const {
    for (int i = 0; i < 1200; ++i) {
      if (condition()) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    ADD_FAILURE() << "title '" << title() << "', stderr '" << err() << "'";
    return false;
  }
  std::string window() const {
    std::istringstream ids(display_.xdotool({"search", "--name", "wavepath"}).out);
    std::string id;
    ids >> id;
    return id;
  }
  std::string title() const { return display_.xdotool({"search", "--name", "wavepath", "getwindowname"}).out; }
  bool done() const {
    return until([&] { return title().find("done") != std::string::npos; });
  }
  // Begins anew and is done again: the event was seen, and all that follows from it is on screen.
  void act(const std::vector<std::string>& events) const {
    const std::string before = copied();
    display_.xdotool(events);
    until([&] { return copied() != before; });
    done();
  }
  // The line that the key C copies.
  std::string copied() const {
    const std::string before = out();
    display_.xdotool({"key", "c"});
    until([&] { return out().size() > before.size() && out().back() == '\n'; });
    const std::string lines = out();
    return lines.substr(lines.rfind('\n', lines.size() - 2) + 1);
  }
  // What the key X saves; `name` is the next that is free.
  Picture saved(const std::string& path) const {
    display_.xdotool({"key", "x"});
    until([&] { return std::filesystem::exists(path); });
    return read_picture(path);
  }
  int close() {
    display_.xdotool({"key", "ctrl+q"});
    return wait();
  }
  int wait() {
    int status = 0;
    waitpid(child_, &status, 0);
    child_ = -1;
    // What lights the scene, and nothing else: validation messages count.
    EXPECT_EQ(err().find("wavepath: light: "), 0u) << err();
    EXPECT_EQ(err().find('\n'), err().size() - 1) << err();
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }

private:
  const VirtualDisplay& display_;
  std::string out_, err_;
  pid_t child_ = -1;
};

void expect_same_bits(const Picture& a, const Picture& b) {
  ASSERT_EQ(a.width, b.width);
  ASSERT_EQ(a.height, b.height);
  for (const char* name : {"R", "G", "B", "A"}) {
    ASSERT_TRUE(find_channel(a, name) && find_channel(b, name));
    EXPECT_EQ(find_channel(a, name)->values, find_channel(b, name)->values) << name;
  }
}

class Window : public ProgramTest {
protected:
  void SetUp() override {
    ProgramTest::SetUp();
    if (IsSkipped() || HasFatalFailure()) return;
    if (!installed("Xvfb") || !installed("xdotool"))
      GTEST_SKIP() << "needs a virtual display and its hand: install xvfb and xdotool";
    display_ = std::make_unique<VirtualDisplay>();
  }
  std::string path(const std::string& name) const { return folder_.file(name); }
  std::unique_ptr<View> view(const std::vector<std::string>& flags, const std::string& scene = kCornell) const {
    return std::make_unique<View>(*display_, folder_.path().string(), flags, scene);
  }
  void render(std::vector<std::string> flags) const {
    flags.insert(flags.begin(), {WAVEPATH_BINARY, "render", kCornell, "-q"});
    const Outcome outcome = run_program(flags, {.folder = folder_.path().string()});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  }
  // Runs a line that the window copied.
  Picture rendered(std::string line) const {
    const std::string program = "wavepath";
    EXPECT_EQ(line.substr(0, program.size()), program);
    line = WAVEPATH_BINARY + line.substr(program.size(), line.size() - program.size() - 1) + " -q -o copy.exr";
    const Outcome outcome = run_program({"/bin/sh", "-c", line}, {.folder = folder_.path().string()});
    EXPECT_EQ(outcome.exit_code, 0) << line << outcome.err;
    return read_picture(path("copy.exr"));
  }

  TemporaryFolder folder_;
  std::unique_ptr<VirtualDisplay> display_;
};

TEST(NoWindow, SaysWhatToDoWithoutADisplay) {
  for (const std::string display : {"", ":54321"}) {
    RunOptions options;
    options.in_child = [&] {
      unsetenv("WAYLAND_DISPLAY");
      setenv("DISPLAY", display.c_str(), 1);
    };
    const Outcome outcome = run_program({WAVEPATH_BINARY, "view", kCornell}, options);
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_EQ(outcome.err.find("wavepath: error: view: "), 0u) << outcome.err;
    EXPECT_NE(outcome.err.find("use 'wavepath render', or a virtual display"), std::string::npos) << outcome.err;
  }
}

TEST(NoWindow, RefusesToCompareWithoutShadowTechniques) {
  for (const std::vector<std::string>& flags :
       {std::vector<std::string>{"--split", "0.5"}, {"--show", "shadow-error"}}) {
    std::vector<std::string> line = {WAVEPATH_BINARY, "view", kCornell};
    line.insert(line.end(), flags.begin(), flags.end());
    const Outcome outcome = run_program(line);
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_NE(outcome.err.find("add --integrator hybrid"), std::string::npos) << outcome.err;
  }
}

TEST_F(Window, RunsAScriptAndSavesThePictureOfRender) {
  for (const std::string name : {"shot.exr", "shot.png"})
    EXPECT_EQ(view({"--size", "96x64", "--frames", "8", "--screenshot", name})->wait(), 0);
  render({"--size", "96x64", "--spp", "8", "-o", "whole.exr", "-o", "whole.png"});
  expect_same_bits(read_picture(path("shot.exr")), read_picture(path("whole.exr")));
  EXPECT_EQ(contents(path("shot.png")), contents(path("whole.png")));
}

TEST_F(Window, ShowsThePicture) {
  const auto window = view({"--size", "360x240", "--spp", "4"});
  window->done();
  display_->xdotool({"key", "h"}); // hides the panel
  render({"--size", "360x240", "--spp", "4", "--adaptive", "off", "--reuse", "off", "-o", "whole.png"});
  const Picture whole = read_picture(path("whole.png"));
  // Values of the file are linear; on screen they are encoded.
  const auto differing = [&] {
    const std::vector<glm::u8vec3> screen = display_->pixels(whole.width, whole.height);
    std::size_t count = 0;
    for (std::size_t i = 0; i < screen.size(); ++i)
      for (int c = 0; c < 3; ++c) {
        const float expected = 255.0f * to_srgb(whole.channels[static_cast<std::size_t>(c)].values[i]);
        count += std::abs(expected - static_cast<float>(screen[i][c])) > 2.0f;
      }
    return count;
  };
  EXPECT_TRUE(window->until([&] { return differing() == 0; })) << differing();
  display_->xdotool({"key", "Tab"}); // and shows it again
  EXPECT_TRUE(window->until([&] { return differing() > 1000; }));
  EXPECT_EQ(window->close(), 0);
}

TEST_F(Window, FollowsTheHandAndCopiesWhereItIs) {
  const auto window = view({"--size", "120x90", "--spp", "4"});
  window->done();
  display_->xdotool({"key", "h"});
  EXPECT_EQ(window->copied().find("--eye"), std::string::npos);
  const std::string initial = window->copied();
  const std::vector<std::vector<std::string>> acts = {
      {"mousemove", "60", "70", "keydown", "ctrl", "click", "1", "keyup", "ctrl"},          // focus
      {"mousemove", "60", "45", "mousedown", "1", "mousemove", "80", "50", "mouseup", "1"}, // orbit
      {"mousedown", "2", "mousemove", "70", "40", "mouseup", "2"},                          // pan
      {"mousedown", "3", "mousemove", "75", "42", "mouseup", "3"},                          // look
      {"click", "4"},                                                                       // nearer
      {"keydown", "w", "sleep", "0.2", "keyup", "w"},
      {"key", "Home"},
  };
  int number = 0;
  for (const auto& act : acts) {
    SCOPED_TRACE(act.front());
    window->act(act);
    const std::string line = window->copied();
    EXPECT_NE(line.find("--eye"), std::string::npos);
    const Picture shown = window->saved(path(fmt::format("cornell_box-{:04}.exr", ++number)));
    expect_same_bits(shown, rendered(line));
  }
  window->act({"key", "r"});
  EXPECT_EQ(window->copied(), initial);
  EXPECT_EQ(window->close(), 0);
}

// What `render` would else find out by pilots, or train: the line says all of it.
TEST_F(Window, CopiesLinesThatRepeatWhateverLightsTheScene) {
  const std::string showcase = WAVEPATH_SOURCE_DIR "/scenes/showcase.glb";
  const TempFolder scenes;
  const std::string lamps = moving_box_under_lamps(scenes, 40);
  const std::vector<std::pair<std::string, std::vector<std::string>>> cases = {
      {showcase, {"--env", "studio"}},
      {showcase, {"--env", "0.5,0.6,0.7"}},
      {lamps, {}},
      {lamps, {"--animation", "slide", "--at", "0.5"}},
      {lamps, {"--lights", "learned"}},
      {kCornell, {"--lights", "tree"}},                        // of few lights, of which auto makes none
      {showcase, {"--env", "0.5,0.6,0.7", "--direct", "nee"}}, // which looks for a sky of one colour
      {kCornell, {"--aov", "variance"}},                       // whose samples are split between two replicates
      {kCornell, {"--light-groups", "each"}},
      {kCornell, {"--half", "--layers", "blender"}}, // which files say that are saved
      {kCornell, {"--projection", "fisheye", "--fov", "150", "--shift", "0.1,0"}},
  };
  int number = 0;
  for (const auto& [scene, flags] : cases) {
    SCOPED_TRACE(number);
    std::vector<std::string> all = {"--size", "192x176", "--spp", "4", "--max-depth", "2"};
    all.insert(all.end(), flags.begin(), flags.end());
    const auto window = view(all, scene);
    window->done();
    const std::string line = window->copied();
    const std::string file = path(std::filesystem::path(scene).stem().string() + "-0001.exr");
    expect_same_bits(window->saved(file), rendered(line));
    std::filesystem::remove(file);
    ++number;
  }
}

// Red, green and blue of the columns from `first` on, up to `end`, have the same bits.
void expect_same_columns(const Picture& a, const Picture& b, std::size_t first, std::size_t end) {
  ASSERT_EQ(a.width, b.width);
  for (const char* name : {"R", "G", "B"}) {
    const std::vector<float>&ours = find_channel(a, name)->values, &theirs = find_channel(b, name)->values;
    std::size_t differing = 0;
    for (std::size_t i = 0; i < ours.size(); ++i)
      differing += i % a.width >= first && i % a.width < end && ours[i] != theirs[i];
    EXPECT_EQ(differing, 0u) << name;
  }
}

TEST_F(Window, SplitsThePictureAgainstTheTruth) {
  const std::vector<std::string> hybrid = {"--integrator", "hybrid", "--size",      "96x64",
                                           "--spp",        "2",      "--max-depth", "1"};
  const auto with = [&](std::vector<std::string> flags) {
    flags.insert(flags.begin(), hybrid.begin(), hybrid.end());
    return flags;
  };
  render(with({"--shadows", "map", "--shadow-size", "64", "-o", "map.exr"}));
  render(with({"--direct", "nee", "-o", "traced.exr"}));
  const Picture technique = read_picture(path("map.exr")), truth = read_picture(path("traced.exr"));

  const auto scripted = [&](const std::vector<std::string>& more) {
    std::vector<std::string> flags = with({"--shadows", "map", "--shadow-size", "64", "--frames", "2"});
    flags.insert(flags.end(), more.begin(), more.end());
    EXPECT_EQ(view(flags)->wait(), 0);
    return read_picture(path("shot.exr"));
  };
  const Picture split = scripted({"--split", "0.25", "--screenshot", "shot.exr"});
  expect_same_columns(split, technique, 0, 24);
  expect_same_columns(split, truth, 24, 96);

  // The error view has both colours, as a map of 64 texels errs both ways.
  const Picture map_of_errors = scripted({"--show", "shadow-error", "--screenshot", "shot.exr"});
  const std::vector<float>&red = find_channel(map_of_errors, "R")->values,
        &blue = find_channel(map_of_errors, "B")->values;
  std::size_t orange = 0, bluish = 0;
  for (std::size_t i = 0; i < red.size(); ++i) orange += red[i] > blue[i] + 0.25f, bluish += blue[i] > red[i] + 0.25f;
  EXPECT_GT(orange, 4u);
  EXPECT_GT(bluish, 4u);
  EXPECT_LT(orange + bluish, red.size() / 4);

  // The divider follows the hand; the camera does not.
  const auto window = view(with({"--shadows", "map", "--shadow-size", "64", "--split", "0.75"}));
  window->done();
  display_->xdotool({"key", "h"});
  window->copied(); // the panel is gone: what is dragged in the frame that hides it is dragged on the panel
  display_->xdotool(
      {"mousemove", "72", "30", "mousedown", "1", "mousemove", "40", "34", "mousemove", "24", "32", "mouseup", "1"});
  EXPECT_EQ(window->copied().find("--eye"), std::string::npos);
  const Picture dragged = window->saved(path("cornell_box-0001.exr"));
  expect_same_columns(dragged, technique, 0, 24);
  expect_same_columns(dragged, truth, 24, 96);
  EXPECT_EQ(window->close(), 0);
}

TEST_F(Window, FollowsItsSize) {
  const auto window = view({"--size", "120x90", "--spp", "4"});
  window->done();
  window->act({"windowsize", window->window(), "200", "150"});
  const Picture larger = window->saved(path("cornell_box-0001.exr"));
  EXPECT_EQ(larger.width, 200u);
  EXPECT_EQ(larger.height, 150u);
  expect_same_bits(larger, rendered(window->copied()));
  for (int i = 0; i < 20; ++i)
    display_->xdotool(
        {"windowsize", window->window(), std::to_string(60 + 17 * i % 200), std::to_string(300 - 13 * i)});
  window->act({"windowsize", window->window(), "64", "48"});
  EXPECT_EQ(window->saved(path("cornell_box-0002.exr")).width, 64u);
  EXPECT_EQ(window->close(), 0);
}

// What is saved while the window changes its size, or the camera moves, has the size that the window comes to: neither
// the one before, nor that of a coarse picture. A scripted window's has the size asked for, whatever becomes of it.
TEST_F(Window, SavesWholePicturesWhileItChanges) {
  const auto window = view({"--size", "120x90", "--spp", "64"});
  window->until([&] { return window->title().find(" spp") != std::string::npos; });
  int number = 0;
  const auto next = [&] { return path(fmt::format("cornell_box-{:04}.exr", ++number)); };
  for (const auto& [width, height] : {std::pair{200u, 150u}, {64u, 48u}, {320u, 200u}}) {
    display_->xdotool({"windowsize", window->window(), std::to_string(width), std::to_string(height), "key", "x"});
    const std::string name = next();
    window->until([&] { return std::filesystem::exists(name); });
    EXPECT_EQ(read_picture(name).width, width);
    EXPECT_EQ(read_picture(name).height, height);
  }
  display_->xdotool({"mousemove", "60", "45", "mousedown", "1", "mousemove", "80", "50", "key", "x", "mousemove", "90",
                     "60", "mouseup", "1"});
  const std::string name = next();
  window->until([&] { return std::filesystem::exists(name); });
  EXPECT_EQ(read_picture(name).width, 320u);
  EXPECT_EQ(window->close(), 0);

  const auto scripted = view({"--size", "120x90", "--frames", "32", "--screenshot", "shot.exr"});
  window->until([&] { return !scripted->window().empty(); });
  for (int i = 1; i < 6; ++i)
    display_->xdotool({"windowsize", scripted->window(), std::to_string(120 + 30 * i), std::to_string(90 + 20 * i)});
  EXPECT_EQ(scripted->wait(), 0);
  EXPECT_EQ(read_picture(path("shot.exr")).width, 120u);
  EXPECT_EQ(read_picture(path("shot.exr")).height, 90u);
}

double processor_seconds(pid_t process) {
  std::istringstream fields(contents(fmt::format("/proc/{}/stat", process)));
  std::string field;
  double ticks = 0.0;
  for (int i = 1; i <= 15 && fields >> field; ++i)
    if (i >= 14) ticks += std::stod(field); // user, system
  return ticks / static_cast<double>(sysconf(_SC_CLK_TCK));
}

// Of a core; the least of some seconds, as what was begun before may take a while where the machine is busy.
double busy_fraction_at_rest(pid_t process) {
  double least = 1e9;
  for (int i = 0; i < 4 && !(least < 0.3); ++i) {
    std::this_thread::sleep_for(std::chrono::seconds(1));
    const double before = processor_seconds(process);
    std::this_thread::sleep_for(std::chrono::seconds(2));
    least = std::min(least, (processor_seconds(process) - before) / 2.0);
  }
  return least;
}

// A loop that does not sleep takes a whole core, all the time; the bound leaves room for all but that.
TEST_F(Window, SleepsWhenIdleAndWhenUnseen) {
  const auto window = view({"--size", "120x90", "--spp", "100000"});
  window->until([&] { return window->title().find(" spp") != std::string::npos; });
  const std::string id = window->window();
  display_->xdotool({"windowunmap", "--sync", id});
  const double unseen = busy_fraction_at_rest(window->process());
  EXPECT_LT(unseen, 0.3);
  display_->xdotool({"windowmap", "--sync", id, "windowfocus", "--sync", id});
  const std::string title = window->title();
  window->until([&] { return window->title() != title; }); // goes on
  EXPECT_EQ(window->close(), 0);

  const auto finished = view({"--size", "120x90", "--spp", "2"});
  finished->done();
  const double idle = busy_fraction_at_rest(finished->process());
  EXPECT_LT(idle, 0.3);
  fmt::print("share of a core: unseen {:.3f}, idle {:.3f}\n", unseen, idle);
  EXPECT_EQ(finished->close(), 0);
}

} // namespace
} // namespace wavepath::test
