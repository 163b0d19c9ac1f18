// `sweep --slurm` as far as it goes without a cluster: what it hands to sbatch, and what it says when that goes wrong.
// A real Slurm is in tests/slurm.
#include "tools/sweep/sweep_slurm.hpp"
#include "tests/tools/command/command_fixture.hpp"

namespace heartservo::test {
namespace {

using nlohmann::json;

class SweepSlurm : public CommandLine {
 protected:
  void SetUp() override {
    fs::create_directories(folder_ / "bin");
    write_text(folder_ / "sweep.yaml", "scene: " + scene("pig_2007") +
                                           "\nset: {duration_s: 0.24, settle_s: 0.1}\naxes:\n  seed: {from: 1, to: 6}\n"
                                           "metrics: [residual.rms_mm]\n");
  }
  void program(const std::string& name, const std::string& body) const {
    write_text(folder_ / ("bin/" + name), "#!/bin/sh\n" + body + "\n");
    fs::permissions(folder_ / ("bin/" + name), fs::perms::owner_all);
  }
  // with the programs of bin/ before all others, or with them alone
  Outcome submit(std::vector<std::string> options, bool alone = false) const {
    std::vector<std::string> command{"env",
                                     "PATH=" + (folder_ / "bin").string() + (alone ? "" : ":/usr/bin:/bin"),
                                     HEARTSERVO_PROGRAM,
                                     "sweep",
                                     "sweep.yaml",
                                     "--out",
                                     "swept"};
    command.insert(command.end(), options.begin(), options.end());
    return run_process(command, folder_.path());
  }
  std::string script(const std::string& name) const { return read_text(folder_ / ("swept/slurm/" + name)); }
};

TEST_F(SweepSlurm, AnArrayAndAMergeThatDependsOnIt) {
  program("sbatch", "echo \"$@\" >>calls; echo \"$(wc -l <calls);mine\"");
  program("squeue", "exit 1");
  const Outcome o = submit({"--tasks", "4", "--jobs", "2", "--slurm=--partition=long --time=10", "--json"});
  ASSERT_EQ(o.code, 0) << o.err;
  const json j = json_of(o);
  EXPECT_EQ(j["array_job"], "1");
  EXPECT_EQ(j["merge_job"], "2");
  EXPECT_EQ(j["tasks"], (json{1, 2, 3, 4}));
  const std::string calls = read_text(folder_ / "calls");
  EXPECT_NE(calls.find("--dependency=afterany:1"), std::string::npos) << calls;
  const std::string share = script("share.sbatch");
  for (const char* line : {"#SBATCH --array=1-4\n", "#SBATCH --requeue\n", "#SBATCH --cpus-per-task=2\n",
                           "#SBATCH --partition=long --time=10\n", "--share \"$SLURM_ARRAY_TASK_ID/4\""})
    EXPECT_NE(share.find(line), std::string::npos) << line << " is not in\n" << share;
  EXPECT_NE(script("merge.sbatch").find("--merge"), std::string::npos);
  // the scripts do what they are for
  for (const char* task : {"1", "2", "3", "4"})
    EXPECT_EQ(run_process({"env", std::string("SLURM_ARRAY_TASK_ID=") + task, "sh", "swept/slurm/share.sbatch"},
                          folder_.path())
                  .code,
              0);
  const Outcome merged = run_process({"sh", "swept/slurm/merge.sbatch"}, folder_.path());
  EXPECT_EQ(merged.code, 0) << merged.err;
  EXPECT_NE(merged.out.find("6 of 6 runs are done"), std::string::npos) << merged.out;
  const Outcome nothing = submit({"--slurm"});
  EXPECT_EQ(nothing.code, 0) << nothing.err;
  EXPECT_EQ(read_text(folder_ / "calls"), calls) << "nothing is left to submit";
}

TEST_F(SweepSlurm, OnlySharesThatAreNotCompleteAreSubmittedAgain) {
  program("sbatch", "echo 7");
  program("squeue", "exit 1");
  ASSERT_EQ(submit({"--tasks", "3", "--slurm", "--quiet"}).code, 0);
  ASSERT_EQ(submit({"--share", "2/3", "--quiet"}).code, 0);
  ASSERT_EQ(submit({"--slurm", "--retry", "--json"}).code, 0);
  EXPECT_NE(script("share.sbatch").find("#SBATCH --array=1,3\n"), std::string::npos) << script("share.sbatch");
  program("squeue", "echo 7_1");
  const Outcome o = submit({"--slurm"});
  EXPECT_EQ(o.code, 2);
  EXPECT_NE(o.err.find("still at this sweep"), std::string::npos) << o.err;
}

TEST_F(SweepSlurm, WhatGoesWrongIsSaidInOneLine) {
  const auto expect = [&](int code, const Outcome& o, const std::string& part) {
    EXPECT_EQ(o.code, code) << o.err;
    EXPECT_EQ(o.error_lines(), 1u) << o.err;
    EXPECT_NE(o.err.find(part), std::string::npos) << o.err;
  };
  fs::create_symlink("/usr/bin/env", folder_ / "bin/env");
  expect(4, submit({"--slurm"}, true), "apt-get install slurm-client");
  program("sbatch", "echo 'sbatch: error: invalid partition specified: nowhere' >&2; echo more >&2; exit 1");
  program("squeue", "exit 1");
  expect(2, submit({"--slurm=--partition=nowhere"}), "invalid partition specified: nowhere; more");
  program("sbatch", "echo hello");
  expect(2, submit({"--slurm"}), "'hello'");
  program("sbatch", "case $* in *dependency*) exit 1;; esac; echo 5");
  expect(2, submit({"--slurm"}), "job 5 is submitted, but not its merge");
  for (const char* option : {"--slurm=--array=1-4", "--slurm=-a1-4", "--slurm=--mem=1G -d afterok:1"})
    expect(2, submit({option}), "is the sweep's own");
  expect(2, submit({"--slurm", "--share", "1/2"}), "--share");
  expect(2, submit({"--tasks", "3"}), "--slurm");
  expect(2, submit({"--slurm", "--tasks", "0"}), "--tasks");
}

TEST(SweepSlurmTasks, NumbersOfThem) {
  EXPECT_EQ(tools::shares_for(1), 1);
  EXPECT_EQ(tools::shares_for(96), 24);
  EXPECT_EQ(tools::shares_for(1000000), 100);
  EXPECT_EQ(tools::task_list({1, 2, 3, 7, 9, 10}), "1-3,7,9-10");
  EXPECT_EQ(tools::task_list({4}), "4");
}

}  // namespace
}  // namespace heartservo::test
