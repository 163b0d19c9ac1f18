#include "tools/run_folder.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/message.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tools {
namespace {

namespace fs = std::filesystem;
using test::message_of;
using test::read_text;
using test::write_text;

class RunFolderTest : public testing::Test {
 protected:
  void make_run(const fs::path& path, const std::string& summary) {
    RunFolder run(path);
    run.write("config.yaml", "seed: 1\n");
    run.write("summary.json", summary);
    run.finish();
  }
  std::string refusal(const fs::path& path) {
    return message_of<ConfigError>([&] { RunFolder run(path); });
  }

  test::TemporaryFolder temporary_;
  const fs::path root_ = fs::canonical(temporary_.path());
  const fs::path path_ = root_ / "runs" / "demo";
  const fs::path partial_ = root_ / "runs" / "demo.partial";
};

TEST_F(RunFolderTest, AppearsUnderItsNameOnlyWhenFinished) {
  RunFolder run(path_ / "");
  EXPECT_EQ(run.path(), path_);
  run.write("summary.json", "{}");
  EXPECT_EQ(run.file("summary.json"), partial_ / "summary.json");
  EXPECT_TRUE(fs::exists(partial_ / "incomplete"));
  EXPECT_FALSE(fs::exists(path_));
  run.finish();
  EXPECT_EQ(run.file("summary.json"), path_ / "summary.json");
  EXPECT_EQ(read_text(path_ / "summary.json"), "{}");
  EXPECT_FALSE(fs::exists(path_ / "incomplete"));
  EXPECT_FALSE(fs::exists(partial_));
}

TEST_F(RunFolderTest, LeavesNothingWhenNothingWasWritten) {
  { RunFolder run(path_); }
  EXPECT_FALSE(fs::exists(path_));
  EXPECT_FALSE(fs::exists(partial_));
}

TEST_F(RunFolderTest, KeepsUnfinishedWorkWithItsMark) {
  { RunFolder(path_).write("frames.csv", "time_s\n"); }
  EXPECT_FALSE(fs::exists(path_));
  EXPECT_TRUE(fs::exists(partial_ / "incomplete"));
  EXPECT_EQ(read_text(partial_ / "frames.csv"), "time_s\n");
}

TEST_F(RunFolderTest, ReplacesTheLeftOverOfACrash) {
  { RunFolder(path_).write("frames.csv", "old\n"); }
  RunFolder run(path_);
  EXPECT_FALSE(fs::exists(partial_ / "frames.csv"));
}

TEST_F(RunFolderTest, KeepsOutOfAFolderThatAnotherProcessWrites) {
  int made[2], done[2];
  ASSERT_EQ(::pipe(made) + ::pipe(done), 0);
  const pid_t other = ::fork();
  if (other == 0) {
    RunFolder run(path_);
    char c = 'x';
    (void)!::write(made[1], &c, 1);
    (void)!::read(done[0], &c, 1);
    ::_exit(0);  // as a crash would: no destructor
  }
  char c = 'x';
  ASSERT_EQ(::read(made[0], &c, 1), 1);
  EXPECT_NE(refusal(path_).find("demo.partial: another heartservo is writing this run"), std::string::npos);
  ASSERT_EQ(::write(done[1], &c, 1), 1);
  ::waitpid(other, nullptr, 0);
  EXPECT_EQ(refusal(path_), "nothing was thrown") << "its lock ended with it";
}

TEST_F(RunFolderTest, ReplacesARun) {
  make_run(path_, "{\"run\":1}");
  write_text(path_ / "old.csv", "");
  make_run(path_, "{\"run\":2}");
  EXPECT_EQ(read_text(path_ / "summary.json"), "{\"run\":2}");
  EXPECT_FALSE(fs::exists(path_ / "old.csv"));
  EXPECT_EQ(std::distance(fs::directory_iterator(path_.parent_path()), fs::directory_iterator()), 1)
      << "nothing beside";
}

TEST_F(RunFolderTest, KeepsTheOldRunUntilTheNewOneIsFinished) {
  make_run(path_, "{\"run\":1}");
  { RunFolder(path_).write("summary.json", "{\"run\":2}"); }
  EXPECT_EQ(read_text(path_ / "summary.json"), "{\"run\":1}");
}

TEST_F(RunFolderTest, ReplacesAnEmptyFolder) {
  fs::create_directories(path_);
  make_run(path_, "{}");
  EXPECT_TRUE(is_run_folder(path_));
}

TEST_F(RunFolderTest, RefusesToReplaceAnythingElse) {
  fs::create_directories(path_);
  write_text(path_ / "thesis.tex", "years of work");
  EXPECT_EQ(refusal(path_), path_.string() +
                                ": exists and is not a run of heartservo; nothing was changed, choose "
                                "another name with --out");
  EXPECT_FALSE(fs::exists(partial_));
  write_text(root_ / "file", "");
  EXPECT_EQ(refusal(root_ / "file"), (root_ / "file").string() +
                                         ": exists and is not a folder; choose another name "
                                         "with --out");
  fs::create_directories(partial_);
  write_text(partial_ / "thesis.tex", "a copy");
  fs::remove_all(path_);
  EXPECT_NE(refusal(path_).find("demo.partial: exists and is not an unfinished run"), std::string::npos);
  EXPECT_EQ(read_text(partial_ / "thesis.tex"), "a copy");
}

TEST_F(RunFolderTest, FinishRefusesWhenTheNameWasTakenMeanwhile) {
  RunFolder run(path_);
  run.write("summary.json", "{}");
  fs::create_directories(path_);
  write_text(path_ / "thesis.tex", "years of work");
  const std::string message = message_of<ConfigError>([&] { run.finish(); });
  EXPECT_NE(message.find("the run is kept in " + partial_.string()), std::string::npos) << message;
  EXPECT_TRUE(fs::exists(path_ / "thesis.tex"));
  EXPECT_TRUE(fs::exists(partial_ / "summary.json"));
  EXPECT_TRUE(fs::exists(partial_ / "incomplete"));
}

TEST_F(RunFolderTest, NamesAPlaceThatCannotBeWritten) {
  EXPECT_EQ(refusal("/proc/heartservo/demo").find("/proc/heartservo: cannot be made: "), 0u);
  write_text(root_ / "file", "");
  EXPECT_EQ(refusal(root_ / "file" / "demo").find(root_.string() + "/file"), 0u);
  EXPECT_EQ(refusal("/dev/shm").find("/dev/shm: is a mount point"), 0u);
  EXPECT_EQ(refusal("/"), "/: cannot be a run folder; name a folder inside it");
  EXPECT_EQ(refusal(""), "the run folder has no name; name one with --out");
}

TEST_F(RunFolderTest, FollowsALinkToItsFolder) {
  make_run(path_, "{\"run\":1}");
  fs::create_directory_symlink(path_, root_ / "latest");
  make_run(root_ / "latest", "{\"run\":2}");
  EXPECT_TRUE(fs::is_symlink(root_ / "latest"));
  EXPECT_EQ(read_text(path_ / "summary.json"), "{\"run\":2}");
}

TEST_F(RunFolderTest, DefaultNameCarriesCommandStemAndTime) {
  std::tm local{};
  local.tm_year = 126, local.tm_mon = 1, local.tm_mday = 3, local.tm_hour = 4, local.tm_min = 5, local.tm_sec = 6;
  local.tm_isdst = -1;
  const auto now = std::chrono::system_clock::from_time_t(std::mktime(&local));
  EXPECT_EQ(default_run_path("servo", "pig_2007", now, root_), root_ / "servo-pig_2007-20260203-040506");
  EXPECT_EQ(default_run_path("capture", "v4l2:/dev/video0", now, root_),
            root_ / "capture-v4l2__dev_video0-20260203-040506");
  EXPECT_EQ(default_run_path("track", "../..", now, root_), root_ / "track-20260203-040506");
  fs::create_directory(root_ / "servo-pig_2007-20260203-040506");
  EXPECT_EQ(default_run_path("servo", "pig_2007", now, root_), root_ / "servo-pig_2007-20260203-040506-2");
  fs::create_directory(root_ / "servo-pig_2007-20260203-040506-2.partial");
  EXPECT_EQ(default_run_path("servo", "pig_2007", now, root_), root_ / "servo-pig_2007-20260203-040506-3");
}

}  // namespace
}  // namespace heartservo::tools
