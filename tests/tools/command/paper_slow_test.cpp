// The paper in one command, a few frames of each experiment.
#include "tests/tools/command/command_fixture.hpp"

namespace heartservo::test {
namespace {

using PaperCommand = CommandLine;

TEST_F(PaperCommand, HasEveryTableAndFigure) {
#ifdef HEARTSERVO_SANITIZED
  GTEST_SKIP() << "takes too long under sanitizers; its experiments are tested one by one";
#endif
  const Outcome o = run({"paper", "--short", "--out", "paper"});
  ASSERT_EQ(o.code, 0) << o.err;
  EXPECT_NE(o.err.find("[1/6]"), std::string::npos) << "progress";
  const std::string page = read_text(folder_ / "paper/paper.html");
  for (const char* part : {"Depth on a rail", "Table 3", "Table 4", "Table 5", "Fig. 4", "Fig. 6", "Fig. 7", "Fig. 8",
                           "track scenes/depth_rail.yaml", "left out: give --data"})
    EXPECT_NE(page.find(part), std::string::npos) << part;
  const auto moved = summary_of("paper/table5")["trackers"][3]["displacement_px"];
  EXPECT_GT(moved["y"]["peak_to_peak"], 15) << "Fig. 6 is a vertical translation";
  EXPECT_LT(moved["x"]["peak_to_peak"], 0.1);
  const auto summary = summary_of("paper");
  EXPECT_EQ(summary["tables"].size(), 7u);
  EXPECT_LT(summary["depth_std_mm"]["landmark_dense"].get<double>(), 0.34);
  for (const char* run : {"depth", "sequence", "motion1", "motion2", "table5", "figure7", "figure8"})
    expect_complete(std::string("paper/") + run);
}

TEST_F(PaperCommand, RefusesADataFolderThatIsNotThere) {
  expect_refused(2, {"paper", "--data", "nowhere"}, {"--data", "nowhere"});
}

}  // namespace
}  // namespace heartservo::test
