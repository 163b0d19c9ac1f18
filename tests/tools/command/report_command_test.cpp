// `report`, `doctor`, and the film and pictures of a run.
#include <fmt/format.h>

#include "tests/tools/command/command_fixture.hpp"

namespace heartservo::test {
namespace {

using nlohmann::json;
using ReportCommand = CommandLine;

TEST_F(ReportCommand, OneRunAndTwoSideBySide) {
  for (const char* law : {"ibvs", "mpc"})
    ASSERT_EQ(
        run({"servo", scene("pig_2007"), "--frames", "40", "--controller", law, "--no-video", "--quiet", "--out", law})
            .code,
        0);
  const Outcome one = run({"report", "mpc", "--out", "one.html"});
  EXPECT_EQ(one.code, 0) << one.err;
  EXPECT_NE(one.out.find("report: "), std::string::npos);
  const std::string page = read_text(folder_ / "one.html");
  EXPECT_NE(page.find("Motion of the heart and what is left of it"), std::string::npos);
  EXPECT_NE(page.find("<img"), std::string::npos) << "the run's pictures";
  EXPECT_EQ(read_text(folder_ / "mpc/report.html").substr(0, 600), page.substr(0, 600)) << "as the run made it";

  EXPECT_EQ(run({"report", "ibvs", "mpc/", "--out", "both.html", "--quiet"}).out, "");
  const std::string both = read_text(folder_ / "both.html");
  const double least = std::min(summary_of("ibvs")["residual"]["rms_mm"].get<double>(),
                                summary_of("mpc")["residual"]["rms_mm"].get<double>());
  EXPECT_NE(both.find(fmt::format("{:.3f} <small>mm RMS residual", least)), std::string::npos);
  EXPECT_NE(both.find("ibvs/residual/norm_m"), std::string::npos);
  EXPECT_NE(both.find("What differs"), std::string::npos);
}

TEST_F(ReportCommand, OtherCommandsAndRunsWithoutFrames) {
  ASSERT_EQ(run({"track", sequence("frames", 5), "--roi", "40,30,50,40", "--quiet", "--out", "tracked"}).code, 0);
  EXPECT_EQ(run({"report", "tracked", "--quiet"}).code, 0);
  EXPECT_NE(read_text(folder_ / "report.html").find("Vertical displacement"), std::string::npos);
  write_text(folder_ / "tracked/frames.csv", "time_s,track/quality\n");
  const Outcome empty = run({"report", "tracked"});
  EXPECT_EQ(empty.code, 0) << empty.err;
  EXPECT_NE(empty.out.find("without frames"), std::string::npos);
  EXPECT_EQ(run({"report", "tracked", "tracked"}).code, 0);
}

TEST_F(ReportCommand, ForeignAndUnfinishedFoldersAreRefused) {
  expect_refused(3, {"report", "nowhere"}, {"nowhere", "folder of a run"});
  fs::create_directory(folder_ / "foreign");
  expect_refused(3, {"report", "foreign"}, {"foreign", "not a run of heartservo"});
  write_text(folder_ / "foreign/incomplete", "");
  expect_refused(3, {"report", "foreign"}, {"not finished"});
  fs::remove(folder_ / "foreign/incomplete");
  write_text(folder_ / "foreign/config.yaml", "a: 1");
  write_text(folder_ / "foreign/summary.json", "{");
  expect_refused(3, {"report", "foreign"}, {"summary.json", "not JSON"});
  write_text(folder_ / "foreign/summary.json", "{}");
  expect_refused(3, {"report", "foreign"}, {"does not say which command"});
  write_text(folder_ / "foreign/summary.json", "{\"command\": \"track\"}");
  fs::create_directory(folder_ / "other");
  write_text(folder_ / "other/config.yaml", "a: 1");
  write_text(folder_ / "other/summary.json", "{\"command\": \"servo\"}");
  expect_refused(2, {"report", "foreign", "other"}, {"nothing to compare"});
  expect_refused(2, {"report"}, {"run is required"});
}

TEST_F(ReportCommand, RunsOfOthersOrWithoutFramesAreSaidInOneLine) {
  fs::create_directory(folder_ / "run");
  write_text(folder_ / "run/config.yaml", "a: 1");
  write_text(folder_ / "run/summary.json", "{\"command\": \"servo\"}");
  write_text(folder_ / "run/frames.csv", "time_s,x\n0,1\n1,2\n");
  expect_refused(3, {"report", "run"}, {"run: frames.csv or summary.json", "no column", "run it again"});
  write_text(folder_ / "run/frames.csv", "time_s,x\n0,1\n1,2,3\n");
  expect_refused(3, {"report", "run"}, {"frames.csv:3", "3 cells under 2 columns"});
  write_text(folder_ / "run/frames.csv", "");
  const Outcome empty = run({"report", "run"});
  EXPECT_EQ(empty.code, 0) << empty.err;
  EXPECT_NE(empty.out.find("without frames"), std::string::npos) << empty.out;
  write_text(folder_ / "run/summary.json", "[1]");
  expect_refused(3, {"report", "run"}, {"does not say which command"});
  fs::create_directories(folder_ / "cut.partial");
  write_text(folder_ / "cut.partial/incomplete", "");
  expect_refused(3, {"report", "cut.partial"}, {"not finished"});
}

TEST_F(ReportCommand, AServoRunHasAShortFilmAndItsStillView) {
  ASSERT_EQ(run({"servo", scene("pig_2007"), "--frames", "60", "--settle-s", "0.2", "--quiet", "--out", "run"}).code,
            0);
  EXPECT_GT(fs::file_size(folder_ / "run/video.webm"), 1000u);
  EXPECT_NE(read_text(folder_ / "run/report.html").find("<video"), std::string::npos);
  const json still = summary_of("run")["still_view"];
  EXPECT_EQ(still["frames"], 7) << "from 0.2 s to 0.48 s, 25 a second";
  EXPECT_GT(still["reduction_percent"].get<double>(), 90);
  ASSERT_EQ(run({"servo", scene("pig_2007"), "--frames", "60", "--no-video", "--quiet", "--out", "plain"}).code, 0);
  EXPECT_FALSE(fs::exists(folder_ / "plain/video.webm"));
  EXPECT_EQ(read_text(folder_ / "plain/report.html").find("<video"), std::string::npos);
}

TEST_F(ReportCommand, TheDoctorLooksAtEverything) {
  const Outcome plain = run({"doctor"});
  EXPECT_EQ(plain.code, 0) << plain.err;
  for (const char* subject : {"versions", "processor", "memory", "disk", "scenes", "cameras", "display", "real time"})
    EXPECT_NE(plain.out.find(subject), std::string::npos) << subject;
  const json findings = json_of(run({"doctor", "--json"}))["findings"];
  for (const json& f : findings) {
    EXPECT_FALSE(f["found"].get<std::string>().empty()) << f;
    EXPECT_EQ(f["state"] == "ok", f["fix"].get<std::string>().empty()) << f << " every lack has its fix";
  }
}

TEST_F(ReportCommand, ShippedScenesAreFoundFromAnywhere) {
  EXPECT_EQ(run({"scene", "scenes/pig_2007.yaml"}).code, 0);
  expect_refused(3, {"scene", "scenes/pig_2008.yaml"}, {"pig_2008"});
}

}  // namespace
}  // namespace heartservo::test
