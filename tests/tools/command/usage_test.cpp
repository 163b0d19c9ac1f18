// Help, version, lists, and what happens to a line that is wrong.
#include <sstream>

#include "tests/tools/command/command_fixture.hpp"

namespace heartservo::test {
namespace {

using Usage = CommandLine;

TEST_F(Usage, EveryCommandHasHelpWithAnExample) {
  const Outcome program = run({"--help"});
  EXPECT_EQ(program.code, 0);
  EXPECT_NE(program.out.find("Example: heartservo "), std::string::npos) << program.out;
  // the commands as the program itself lists them, so that none is forgotten
  std::vector<std::string> commands;
  std::istringstream lines(program.out.substr(program.out.find("\nSubcommands:\n") + 14));
  for (std::string line; std::getline(lines, line) && (line.empty() || line[0] == ' ');)
    if (line.size() > 3 && line[2] != ' ') commands.push_back(line.substr(2, line.find(' ', 2) - 2));
  EXPECT_EQ(commands.size(), 16u) << testing::PrintToString(commands);
  for (const std::string& command : commands) {
    EXPECT_NE(program.out.find("\n  " + command + " "), std::string::npos) << command << " is not in\n" << program.out;
    const Outcome o = run({command, "--help"});
    EXPECT_EQ(o.code, 0);
    EXPECT_EQ(o.err, "");
    EXPECT_NE(o.out.find("heartservo " + command + " "), std::string::npos) << o.out;
    EXPECT_NE(o.out.find("Example"), std::string::npos) << o.out;
  }
}

TEST_F(Usage, Version) {
  const Outcome o = run({"--version"});
  EXPECT_EQ(o.code, 0);
  EXPECT_EQ(o.out.rfind("heartservo ", 0), 0u);
  EXPECT_NE(o.out.find_first_of("0123456789"), std::string::npos);
}

TEST_F(Usage, ListsEnginesWithoutASource) {
  const Outcome servo = run({"servo", "--list"});
  EXPECT_EQ(servo.code, 0);
  for (const char* name :
       {"\ntracker ", "esm ", "landmark_refined ", "constant_acceleration ", "ibvs_feedforward ", "mpc ", "ideal ",
        "trocar "})
    EXPECT_NE(("\n" + servo.out).find(name), std::string::npos) << name << " is not in\n" << servo.out;
  const Outcome track = run({"track", "--list"});
  EXPECT_EQ(track.code, 0);
  EXPECT_EQ(track.out.rfind("esm ", 0), 0u) << track.out;
}

TEST_F(Usage, UnknownWordsAreRefusedWithTheNearest) {
  const std::string pig = scene("pig_2007");
  expect_refused(2, {}, {"--help"});
  expect_refused(2, {"srvo", pig}, {"'srvo'", "did you mean 'servo'"});
  expect_refused(2, {"servo", pig, "--trackr", "esm"}, {"'--trackr'", "did you mean '--tracker'"});
  expect_refused(2, {"servo", pig, "--tracker", "ems"}, {"'ems'", "did you mean 'esm'"});
  expect_refused(2, {"track", pig, "--tracker", "esm,ems"}, {"'ems'", "did you mean 'esm'"});
  expect_refused(2, {"track", pig, "--tracker", "esm,esm"}, {"'esm' is given twice"});
  expect_refused(2, {"servo", pig, "--predictor", "holt"}, {"'holt'", "did you mean 'hold'"});
  expect_refused(2, {"servo", pig, "--controller", "ibsv"}, {"'ibsv'", "did you mean 'ibvs'"});
  expect_refused(2, {"servo", pig, "--robot", "ideel"}, {"'ideel'", "did you mean 'ideal'"});
  expect_refused(2, {"servo", pig, "extra"}, {"'extra'"});
  expect_refused(2, {"servo"}, {"SOURCE"});
  expect_refused(2, {"render"}, {"SCENE"});
  expect_refused(2, {"scene"}, {"--keys"});
  EXPECT_TRUE(fs::is_empty(folder_.path())) << "a refused command must leave nothing behind";
}

TEST_F(Usage, NumbersMustBeNumbersWithinTheirRange) {
  const std::string pig = scene("pig_2007");
  expect_refused(2, {"servo", pig, "--frames", "0"}, {"--frames", "0"});
  expect_refused(2, {"servo", pig, "--frames", "12x"}, {"--frames", "12x"});
  expect_refused(2, {"servo", pig, "--frames", "2000000000"}, {"--frames", "100000 s"});
  expect_refused(2, {"servo", pig, "--seed", "-1"}, {"--seed", "-1"});
  expect_refused(2, {"servo", pig, "--latency-ms", "nan"}, {"--latency-ms", "'nan'"});
  expect_refused(2, {"servo", pig, "--latency-ms", "5000"}, {"--latency-ms", "5000", "1900"});
  expect_refused(2, {"servo", pig, "--settle-s", "-1"}, {"--settle-s", "-1"});
  expect_refused(2, {"servo", pig, "--frames", "50", "--settle-s", "1"}, {"--settle-s 1", "nothing to score"});
  expect_refused(2, {"track", pig, "--frame-rate-hz", "inf"}, {"--frame-rate-hz", "'inf'"});
  expect_refused(2, {"track", pig, "--corners", "1,2,3,4,5,6,7"}, {"--corners", "8"});
}

TEST_F(Usage, StdoutThatTakesNothingIsSaid) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full on this machine";
  const std::string help = std::string(HEARTSERVO_PROGRAM) + " --help ";
  for (const char* where : {">/dev/full", ">&-"}) {
    const Outcome o = run_process({"sh", "-c", help + where}, folder_.path());
    EXPECT_EQ(o.code, 2) << where;
    EXPECT_EQ(o.error_lines(), 1u) << o.err;
    EXPECT_NE(o.err.find("stdout cannot be written"), std::string::npos) << o.err;
  }
}

TEST_F(Usage, AReaderThatLeavesEarlyDoesNoHarm) {
  const std::string servo = std::string(HEARTSERVO_PROGRAM) + " servo " + scene("pig_2007");
  const Outcome o =
      run_process({"sh", "-c", servo + " --frames 3 --quiet --json --out run | head -n 1"}, folder_.path());
  EXPECT_EQ(o.out, "{\n");
  EXPECT_EQ(o.err, "");
  expect_complete("run");
}

}  // namespace
}  // namespace heartservo::test
