#include "tools/track_tables.hpp"

#include <gtest/gtest.h>

namespace heartservo::tools {
namespace {

using nlohmann::json;

json lane(const std::string& name, json error_px, json failure = nullptr) {
  return {{"name", name},
          {"lost_frames", 1},
          {"uncertain_frames", 2},
          {"relocks", 3},
          {"wrong_ok_frames", error_px.is_null() ? json() : json(4)},
          {"wrong_over_px", error_px.is_null() ? json() : json{{"corners", 5}}},
          {"error_px", error_px},
          {"point_error_px", nullptr},
          {"first_failure", failure},
          {"ms", {{"p50", 0.5}, {"p99", 0.75}}},
          {"displacement_px", {{"x", {{"peak_to_peak", 10}}}, {"y", nullptr}}}};
}

json error(double mean, double std) { return {{"mean", mean}, {"std", std}, {"max", 1}}; }

bool has(const std::vector<std::string>& cells, const std::string& cell) {
  return std::find(cells.begin(), cells.end(), cell) != cells.end();
}

TEST(TrackTables, ShowOnlyWhatIsKnown) {
  json summary{{"trackers", {lane("esm", nullptr)}}, {"point", nullptr}};
  const ReportTable bare = tracker_table(summary);
  EXPECT_FALSE(has(bare.header, "error px"));
  EXPECT_FALSE(has(bare.header, "wrong OK"));
  EXPECT_EQ(bare.rows[0], (std::vector<std::string>{"esm", "1", "2", "3", "0.500", "0.750", "10.0", "-"}));
  summary["trackers"] = {lane("esm", error(0.25, 0.125)), lane("ssd", nullptr)};
  const ReportTable known = tracker_table(summary);
  EXPECT_TRUE(has(known.header, "wrong OK"));
  EXPECT_TRUE(has(known.header, "error px"));
  EXPECT_FALSE(has(known.header, "point px"));
  EXPECT_TRUE(has(known.rows[0], "0.250"));
  EXPECT_EQ(known.rows[1].size(), known.header.size()) << "a tracker that was never there";
  EXPECT_NE(known.note.find("corners over 5 px"), std::string::npos) << known.note;
}

TEST(TrackTables, ShowThePointWithItsBound) {
  json esm = lane("esm", nullptr);
  esm["wrong_ok_frames"] = 0;
  esm["wrong_over_px"] = {{"point", 8}};
  esm["point_error_px"] = {{"median", 0.5}, {"p95", 1.5}, {"max", 2.5}, {"mean", 0.6}, {"with_lost", {{"p95", 3.5}}}};
  json summary{{"trackers", {esm}}, {"point", "C"}};
  const ReportTable table = tracker_table(summary);
  EXPECT_TRUE(has(table.header, "point px"));
  for (const char* cell : {"0.500", "1.500", "2.500", "3.500"}) EXPECT_TRUE(has(table.rows[0], cell)) << cell;
  EXPECT_NE(table.note.find("of the point C"), std::string::npos) << table.note;
  EXPECT_NE(table.note.find("point over 8 px"), std::string::npos) << table.note;
  esm["error_px"] = error(1, 1);
  summary = {{"trackers", {esm}}, {"point", "target"}};
  EXPECT_TRUE(has(tracker_table(summary).header, "centre px")) << "simulated: the centre is as well known as corners";
}

TEST(TrackTables, Table5StandsBesideThePrintedOne) {
  const PaperTable paper =
      paper_table_5({lane("esm", error(0.0125, 0.0025)), lane("optical_flow", error(0.5, 0.25))}, 2, 0);
  ASSERT_EQ(paper.table.rows.size(), 5u);
  const std::vector<std::vector<std::string>> expected{{"Correlation", "0.00", "0.00", "-", "-"},
                                                       {"SSD", "0.04", "0.19", "-", "-"},
                                                       {"Optical flow", "0.90", "0.73", "0.500", "0.250"},
                                                       {"Composite", "0.00", "0.00", "-", "-"},
                                                       {"ESM", "0.00", "0.00", "0.013", "0.003"}};
  EXPECT_EQ(std::vector(paper.table.rows.begin(), paper.table.rows.end() - 1),
            std::vector(expected.begin(), expected.end() - 1));
  EXPECT_EQ(paper.table.rows[4][0], "ESM");
  EXPECT_NE(paper.table.note.find("Ours differ because"), std::string::npos);
  EXPECT_NE(paper.table.note.find("noise of 2 grey levels"), std::string::npos) << paper.table.note;
  EXPECT_EQ(paper_table_5({}, 0, 0).table.note.find("noise"), std::string::npos);
  EXPECT_NE(paper_table_5({}, 0, 3).table.note.find("3 moving speculars"), std::string::npos);
  const json& row = paper.summary["rows"][1];
  EXPECT_EQ(row["tracker"], "ssd");
  EXPECT_EQ(row["paper_px"], (json{{"mean", 0.04}, {"std", 0.19}}));
  EXPECT_TRUE(row["here_px"].is_null());
  EXPECT_EQ(paper.summary["rows"][4]["here_px"]["mean"], 0.0125);
}

TEST(TrackTables, Figure7SaysWhoLosesThePatternAndWhen) {
  const PaperTable paper = paper_figure_7(
      {lane("esm", error(0.25, 0)), lane("ssd", error(7, 1), {{"sequence", 4}, {"time_s", 0.04}, {"reason", "lost"}}),
       lane("correlation", error(7, 1), {{"sequence", 9}, {"time_s", 0.09}, {"reason", "off"}})},
      16);
  ASSERT_EQ(paper.table.rows.size(), 5u);
  EXPECT_EQ(paper.table.rows[0],
            (std::vector<std::string>{"Correlation", "diverges", "over 5 px off in frame 10, at 0.090 s"}));
  EXPECT_EQ(paper.table.rows[1], (std::vector<std::string>{"SSD", "loses the pattern", "lost in frame 5, at 0.040 s"}));
  EXPECT_EQ(paper.table.rows[3][2], "not run");
  EXPECT_EQ(paper.table.rows[4], (std::vector<std::string>{"ESM", "not said", "holds, 0.250 px mean"}));
  EXPECT_NE(paper.table.note.find("16 moving speculars"), std::string::npos);
  EXPECT_EQ(paper.summary["rows"][1]["first_failure"]["sequence"], 4);
  EXPECT_TRUE(paper.summary["rows"][4]["first_failure"].is_null());
  EXPECT_EQ(paper.summary["rows"][3]["run"], false);
}

TEST(TrackTables, StandInTheTerminalInColumns) {
  const ReportTable table{"t", {"tracker", "px", "what"}, {{"a", "1.5", "x"}, {"longer", "10.25", ""}}, "A note."};
  EXPECT_EQ(terminal_text(table, false), "tracker     px  what\na          1.5  x\nlonger   10.25\n");
  EXPECT_EQ(terminal_text(table, true), terminal_text(table, false) + "\nA note.\n");
  ReportTable wordy = table;
  for (int i = 0; i < 60; ++i) wordy.note += " word";
  const std::string text = terminal_text(wordy, true);
  for (std::size_t at = 0, end; (end = text.find('\n', at)) != std::string::npos; at = end + 1)
    EXPECT_LE(end - at, 100u);
}

}  // namespace
}  // namespace heartservo::tools
