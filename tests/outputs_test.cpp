// What a command writes replaces nothing that it reads, and no other file that it writes, and holds what was asked for.
// Needs no Vulkan device.
#include <filesystem>
#include <fstream>
#include <new>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "host/base/error.h"
#include "host/base/failure.h"
#include "host/base/output_files.h"
#include "host/base/print.h"
#include "tests/scene_folder.h"

namespace wavepath::test {
namespace {

namespace fs = std::filesystem;

const std::string kScenes = std::string(WAVEPATH_SOURCE_DIR) + "/scenes/";

class Outputs : public SceneFolder {};

TEST_F(Outputs, ReplaceNoInput) {
  const std::string word = "would overwrite an input";
  for (const char* line :
       {"render scene.gltf -o a.exr --stats scene.gltf", "render scene.gltf -o a.exr --stats ./sub/../scene.gltf",
        "render scene.gltf --env sky.exr -o sky.exr", "render scene.gltf --env sky.exr -o soft.exr",
        "render scene.gltf --env soft.exr -o ./sky.exr", "render scene.gltf --env sky.exr -o way/../sky.exr",
        "render scene.gltf --size 8x4 --reference reference.exr -o reference.exr",
        "render scene.gltf --integrator hybrid --shadows projected --shadow-cookie skin.png -o hard.png",
        "render scene.gltf --checkpoint scene.gltf --resume -o a.exr", "compare sky.exr hard.png --map skin.png",
        "compare sky.exr skin.png --map ./skin.png", "merge sky.exr reference.exr -o sub/../reference.exr",
        "merge sky.exr reference.exr -o a.png -o soft.exr", "bench scene.gltf --json scene.gltf",
        "bench scene.gltf --baseline scene.gltf --json sub/../scene.gltf",
        "view scene.gltf --frames 1 --env sky.exr --screenshot sky.exr",
        "study scene.gltf -o . --vary sampler --env reference.exr"})
    expect_refused(line, word);
}

TEST_F(Outputs, RefuseWhatNoFileNamedWouldShow) {
  expect_refused("render scene.gltf -o a.exr --bits 16", "--bits: is for .png files, and a.exr is none");
  expect_refused("render scene.gltf -o a.jpg --bits 16", "--bits: is for .png files, and a.jpg is none");
  expect_refused("render scene.gltf -o a.png --layers blender", "--layers: is for .exr files");
  expect_refused("render scene.gltf -o a.hdr --compression piz", "--compression: is for .exr files");
  expect_refused("render scene.gltf -o a.png --multi-part", "--multi-part: is for .exr files");
  expect_refused("merge sky.exr reference.exr -o a.png --multi-part", "--multi-part: is for .exr files");
  expect_refused("render scene.gltf -o a.exr --compression lzw", "--compression");
  expect_refused("render scene.gltf -o a.exr --layers nuke", "--layers");
  expect_refused("render scene.gltf -o a.png --bits 12", "--bits");
  expect_refused("render scene.gltf -o a.png --save-every 0", "--save-every");
}

TEST_F(Outputs, ReplaceNoOther) {
  expect_refused("render scene.gltf -o a.exr -o a.exr", "a.exr: is written twice");
  expect_refused("render scene.gltf -o a.exr -o ./a.exr", "./a.exr: is the same file as a.exr");
  expect_refused("render scene.gltf -o sub/a.exr -o way/a.exr", "is the same file as sub/a.exr");
  expect_refused("render scene.gltf -o dangling.exr -o made-later.exr", "is the same file as dangling.exr");
  expect_refused("render scene.gltf -o a.exr --stats sub/../a.exr", "is the same file as a.exr");
  expect_refused("render scene.gltf -o a.exr --stats s.json --checkpoint ./s.json", "is the same file as s.json");
  expect_refused("merge sky.exr reference.exr -o a.exr -o ./a.exr", "is the same file as a.exr");
  RunOptions redirected;
  redirected.in_child = [] { dup2(open("log.json", O_CREAT | O_WRONLY, 0600), STDOUT_FILENO); };
  const Outcome outcome = run({"render", "scene.gltf", "-o", "a.exr", "--json", "--stats", "log.json"}, redirected);
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("log.json: is where stdout goes"), std::string::npos) << outcome.err;
}

// Which names are one file.
TEST_F(Outputs, AreComparedAsFiles) {
  const auto clash = [](const std::string& output, const std::string& input) {
    try {
      refuse_overwriting(std::vector{output}, std::vector{input});
    } catch (const UsageError&) {
      return true;
    }
    return false;
  };
  EXPECT_TRUE(clash(file("soft.exr"), file("sky.exr")));
  EXPECT_TRUE(clash(file("hard.png"), file("skin.png")));
  EXPECT_FALSE(clash(file("sky.exr"), file("reference.exr")));
  EXPECT_FALSE(clash(file("new.exr"), file("sky.exr")));
  EXPECT_FALSE(clash(file("new.exr"), ""));
  EXPECT_FALSE(clash("/dev/null", "/dev/null")) << "nothing is replaced";
  EXPECT_FALSE(clash("/dev/stdout", file("sky.exr")));
  EXPECT_EQ(target_of(file("dangling.exr")), target_of(file("made-later.exr")));
  // Two names that differ in case are two files here, and may be one on the disk of another machine.
  fs::create_directory(file("case"));
  const std::vector<std::string> both = {file("case/a.exr"), file("case/A.exr")};
  std::ofstream(file("case/probe")) << "";
  const bool ignores_case = fs::exists(file("case/PROBE"));
  fs::remove(file("case/probe"));
  if (ignores_case)
    EXPECT_THROW(refuse_overwriting(both, {}), UsageError);
  else
    EXPECT_NO_THROW(refuse_overwriting(both, {}));
  EXPECT_TRUE(fs::is_empty(file("case"))) << "the question leaves no file behind";
}

// A link that leads to nothing yet stays one.
TEST_F(Outputs, FollowLinksThatLeadToNothingYet) {
  const Outcome outcome = run({"compare", "sky.exr", "reference.exr", "--map", "map.png"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  fs::create_symlink("sub/real.png", file("link.png"));
  ASSERT_EQ(run({"compare", "sky.exr", "reference.exr", "--map", "link.png"}).exit_code, 0);
  EXPECT_TRUE(fs::is_symlink(file("link.png")));
  EXPECT_EQ(contents(file("sub/real.png")), contents(file("map.png")));
}

TEST_F(Outputs, AreOfAFormatThatHoldsThem) {
  expect_refused("render scene.gltf --size 65501x8 -o a.jpg",
                 "a.jpg: cannot hold 65501x8 pixels: a side has 65500 at most; choose .png or .exr");
  expect_refused("render scene.gltf --size 8x65536 -o a.exr -o b.JPEG", "b.JPEG: cannot hold 8x65536 pixels");
  expect_refused("view scene.gltf --size 65536x8 --frames 1 --screenshot a.jpg", "a.jpg: cannot hold 65536x8 pixels");
  for (const char* name : {"a.exr", "a.png", "a.hdr"}) EXPECT_NO_THROW(require_format(name, 65536, 65536)) << name;
  EXPECT_NO_THROW(require_format("a.jpg", 65500, 65500));
  EXPECT_THROW(require_format("a.png", 1'000'001, 1), UsageError);
  write_picture(file("sub/long.exr"), grey(65501, 1), {}, {});
  expect_refused("compare sub/long.exr sub/long.exr --map a.jpg", "a.jpg: cannot hold 65501x1 pixels");
}

TEST_F(Outputs, HoldTheChannelsAskedFor) {
  expect_refused("render scene.gltf --aov albedo -o a.png", "--aov: channels go into .exr files, and a.png is none");
  expect_refused("render scene.gltf --aov albedo -o a.png -o b.hdr", "a.png, b.hdr is none");
  expect_refused("render scene.gltf --mergeable -o a.jpg", "--mergeable: sums go into .exr files");
}

TEST_F(Outputs, OverflowIsRefused) {
  for (const char* line :
       {"render scene.gltf --env studio --env-intensity 3e38 -o a.exr",
        "render scene.gltf --env sky --env-intensity 1e30 -o a.exr",
        "render scene.gltf --env white --env-intensity 1.1e30 -o a.exr",
        "render scene.gltf --env 1,1,1e30 --env-intensity 2 -o a.exr",
        "render scene.gltf --env sky.exr --env-intensity 3e30 -o a.exr", "info scene.gltf --env 1e31,0,0"})
    expect_refused(line, "more than 1e30");
}

// Attempts: the first failure is thrown, none keeps the others from being tried, and a reader that left is the least.
TEST(Attempt, TriesAll) {
  Attempts attempts;
  int done = 0;
  EXPECT_FALSE(attempts.attempt([] { throw ReaderGone("stdout", "a", "b"); }));
  EXPECT_TRUE(attempts.attempt([&] { ++done; }));
  EXPECT_FALSE(attempts.attempt([] { throw std::bad_alloc(); }));
  EXPECT_FALSE(attempts.attempt([] { throw Error("c.png", "cannot be written", "d"); }));
  EXPECT_TRUE(attempts.attempt([&] { ++done; }));
  ::testing::internal::CaptureStderr();
  EXPECT_THROW(attempts.finish(), std::bad_alloc);
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "wavepath: warning: c.png: cannot be written; d\n");
  EXPECT_EQ(done, 2);
  EXPECT_NO_THROW(attempts.finish());
}

TEST(Attempt, FailuresOfAnyKindAreALineEach) {
  EXPECT_EQ(failure_text(Error("a", "b", "c")), "a: b; c");
  EXPECT_EQ(failure_text(std::bad_alloc()).find("memory: ran out; "), 0u);
  EXPECT_EQ(failure_text(std::system_error(std::make_error_code(std::errc::resource_unavailable_try_again)))
                .find("threads: no more can be started; "),
            0u);
  EXPECT_EQ(failure_text(std::runtime_error("x")), "wavepath: unexpected error (x); report this");
}

// /dev/full takes nothing: what was asked for is missing, which is a failure. A reader that left has what it wanted.
TEST_F(Outputs, AStdoutThatCannotBeWrittenIsAnError) {
  const std::string box = kScenes + "cornell_box.gltf";
  for (const std::vector<std::string>& words : {std::vector<std::string>{"--help"},
                                                {"--version"},
                                                {"render", "--help"},
                                                {"compare", "sky.exr", "reference.exr"},
                                                {"compare", "sky.exr", "reference.exr", "--json"},
                                                {"info", box},
                                                {"info", box, "--json"}}) {
    SCOPED_TRACE(words.front() + " " + words.back());
    RunOptions full, closed, broken;
    full.in_child = [] { dup2(open("/dev/full", O_WRONLY), STDOUT_FILENO); };
    closed.in_child = [] { close(STDOUT_FILENO); };
    broken.in_child = [] {
      int ends[2];
      if (pipe(ends) != 0) _exit(98);
      dup2(ends[1], STDOUT_FILENO);
      close(ends[0]), close(ends[1]);
    };
    const Outcome outcome = run(words, full);
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_EQ(outcome.err,
              "wavepath: error: stdout: cannot be written (No space left on device); free some space or "
              "write elsewhere\n");
    const Outcome none = run(words, closed);
    EXPECT_EQ(none.exit_code, 1) << none.err;
    EXPECT_NE(none.err.find("stdout: cannot be written"), std::string::npos) << none.err;
    const Outcome gone = run(words, broken);
    EXPECT_EQ(gone.exit_code, 141);
    EXPECT_EQ(gone.err, "");
  }
}

} // namespace
} // namespace wavepath::test
