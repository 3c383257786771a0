// Output files appear whole or not at all: when the process is killed, the disk is full, or the target cannot be
// written.
#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <gtest/gtest.h>

#include "host/base/atomic_file.h"
#include "host/base/error.h"
#include "host/base/memory.h"
#include "tests/temporary_folder.h"

namespace wavepath::test {
namespace {

namespace fs = std::filesystem;

std::string contents(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

std::size_t files_in(const fs::path& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

// Runs `action` in a child process; its wait status.
int in_child(const std::function<void()>& action) {
  const pid_t child = fork();
  if (child == 0) {
    action();
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return status;
}

std::string message_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

class AtomicFileTest : public ::testing::Test {
protected:
  TemporaryFolder folder_;
  std::string target_ = folder_.file("target");
};

TEST_F(AtomicFileTest, ReplacesTheTargetOnlyOnCommit) {
  write_file(target_, "old");
  {
    AtomicFile file(target_);
    file.write("new", 3);
    EXPECT_EQ(contents(target_), "old");
    file.seek(0);
    file.write("N", 1);
    EXPECT_EQ(file.position(), 1u);
    file.commit();
  }
  EXPECT_EQ(contents(target_), "New");
  EXPECT_EQ(files_in(folder_.path()), 1u);
}

TEST_F(AtomicFileTest, LeavesNothingWithoutCommit) {
  { AtomicFile(target_).write("half", 4); }
  EXPECT_EQ(files_in(folder_.path()), 0u);
}

TEST_F(AtomicFileTest, AKilledProcessLeavesTheOldFile) {
  write_file(target_, "old");
  const int status = in_child([&] {
    AtomicFile file(target_);
    file.write("half a pic", 10);
    raise(SIGKILL);
  });
  ASSERT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(contents(target_), "old");
}

TEST_F(AtomicFileTest, AFullDiskIsAnErrorThatLeavesTheOldFile) {
  write_file(target_, "old");
  const int status = in_child([&] {
    signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{1000, 1000};
    setrlimit(RLIMIT_FSIZE, &limit);
    const std::string message = message_of([&] { write_file(target_, std::string(2000, 'x')); });
    _exit(message.find("cannot write") != std::string::npos ? 7 : 8);
  });
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 7);
  EXPECT_EQ(contents(target_), "old");
  EXPECT_EQ(files_in(folder_.path()), 1u);
}

TEST_F(AtomicFileTest, DevicesAreWrittenDirectlyAndStayDevices) {
  write_file("/dev/null", "anything");
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  EXPECT_NE(message_of([] { write_file("/dev/full", "x"); }).find("/dev/full: cannot write"), std::string::npos);
  EXPECT_TRUE(fs::is_character_file("/dev/full"));
}

TEST_F(AtomicFileTest, FollowsLinks) {
  const fs::path link = folder_.file("link");
  write_file(target_, "old");
  fs::create_symlink(target_, link);
  write_file(link, "new");
  EXPECT_TRUE(fs::is_symlink(link));
  EXPECT_EQ(contents(target_), "new");
}

TEST_F(AtomicFileTest, HopelessTargetsAreRefusedInWords) {
  EXPECT_NE(message_of([&] { require_writable(folder_.file("no/such/file")); }).find("does not exist; create it first"),
            std::string::npos);
  EXPECT_NE(message_of([&] { require_writable(folder_.path().string()); }).find("is a folder"), std::string::npos);
  EXPECT_NE(message_of([&] { require_writable(""); }).find("is empty"), std::string::npos);
  write_file(target_, "a file");
  EXPECT_NE(message_of([&] { require_writable(target_ + "/below"); }).find("is not a folder"), std::string::npos);
  EXPECT_NE(message_of([&] { require_writable("/proc/self/new"); }), "no error");
  require_writable(target_);
  EXPECT_EQ(contents(target_), "a file");
  EXPECT_EQ(files_in(folder_.path()), 1u);
}

TEST_F(AtomicFileTest, ReadOnlyTargetsAreRefused) {
  write_file(target_, "old");
  fs::permissions(target_, fs::perms::owner_read);
  fs::permissions(folder_.path(), fs::perms::all); // the file's own permissions are what is judged
  const int status = in_child([&] {
    constexpr uid_t kNobody = 65534; // root may write everywhere
    if (geteuid() == 0 && setresuid(kNobody, kNobody, kNobody) != 0) _exit(9);
    const std::string message = message_of([&] { require_writable(target_); });
    _exit(message.find("cannot be written") != std::string::npos ? 7 : 8);
  });
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 7);
}

TEST(Memory, IsRefusedInNumbers) {
  EXPECT_GT(available_memory(), 1u << 20);
  require_memory("here", "a little", 1, "nothing");
  const std::string message =
      message_of([] { require_memory("scene.gltf", "loading it", std::uint64_t{1} << 60, "use less"); });
  EXPECT_NE(message.find("scene.gltf: loading it takes 1.0 EiB of memory, and "), std::string::npos) << message;
  EXPECT_NE(message.find("; use less"), std::string::npos);
}

TEST(Memory, HonoursTheAddressSpaceLimit) {
#if defined(__SANITIZE_ADDRESS__)
  GTEST_SKIP() << "AddressSanitizer reserves more address space than any limit leaves";
#endif
  const std::uint64_t least = std::uint64_t{1} << 30;
  if (available_memory() < 2 * least) GTEST_SKIP() << "too little memory for the limit to matter";
  const int status = in_child([] {
    const rlimit limit{rlim_t{least}, rlim_t{least}};
    setrlimit(RLIMIT_AS, &limit);
    _exit(available_memory() <= least ? 7 : 8);
  });
  EXPECT_EQ(WEXITSTATUS(status), 7);
}

TEST(Memory, SizesReadWell) {
  EXPECT_EQ(to_size_text(0), "0 bytes");
  EXPECT_EQ(to_size_text(1023), "1023 bytes");
  EXPECT_EQ(to_size_text(1536), "1.5 KiB");
  EXPECT_EQ(to_size_text(std::uint64_t{3} << 30), "3.0 GiB");
}

} // namespace
} // namespace wavepath::test
