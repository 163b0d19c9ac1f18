#include "tools/report/report.hpp"

#include <gtest/gtest.h>

#include <regex>

#include "tests/support/message.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/tools/synthetic_report.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tools {
namespace {

using test::message_of;

// The page without the insides of its scripts, style sheets and pictures: std::regex overflows the stack on their size.
std::string markup_only(const std::string& page) {
  std::string result;
  for (std::size_t from = 0; from < page.size();) {
    std::size_t inside = page.size(), end = page.size();
    for (const auto& [open, close] : {std::pair{"<script", "</script>"}, {"<style", "</style>"}, {"base64,", "\""}}) {
      const std::size_t at = page.find(open, from);
      if (at >= inside) continue;
      inside = *open == '<' ? page.find('>', at) + 1 : at;
      end = page.find(close, inside);
    }
    result += page.substr(from, inside - from);
    from = end;
  }
  return result;
}

class ReportTest : public testing::Test {
 protected:
  bool has(const std::string& part) const { return html_.find(part) != std::string::npos; }
  std::size_t count(const std::string& part) const {
    std::size_t n = 0;
    for (auto at = html_.find(part); at != std::string::npos; at = html_.find(part, at + 1)) ++n;
    return n;
  }
  // The JSON inside <script ... id="ID">.
  nlohmann::json json_of(const std::string& id) const {
    const std::string open = "<script type=\"application/json\" id=\"" + id + "\">";
    const auto from = html_.find(open) + open.size();
    return nlohmann::json::parse(html_.substr(from, html_.find("</script>", from) - from));
  }

  const TimeTable table_ = test::synthetic_table(1500);
  const Report report_ = test::synthetic_report(table_);
  std::string html_ = report_html(report_);
};

TEST_F(ReportTest, AnswersFirst) {
  EXPECT_TRUE(has("<p class=\"number\">0.41 <small>mm RMS residual</small></p>"));
  const auto plot = html_.find("id=\"plot0\""), picture = html_.find("<img "), others = html_.find("id=\"plot1\"");
  EXPECT_LT(html_.find(report_.headline), plot);
  EXPECT_LT(plot, picture);
  EXPECT_LT(picture, others);
  EXPECT_TRUE(has("Ended by Ctrl-C after 25 s of 60 s"));
}

TEST_F(ReportTest, AChapterHasItsTablesPlotsAndPicturesTogether) {
  Report report = report_;
  report.plots[0].chapter = report.plots[2].chapter = report.pictures[0].chapter = report.tables[1].chapter = "Fig. 7";
  report.tables[0].chapter = report.plots[1].chapter = "Table <5>";
  html_ = report_html(report);
  const auto at = [&](const std::string& part) {
    EXPECT_EQ(count(part), 1u) << part;
    return html_.find(part);
  };
  const std::vector<std::size_t> order{at("<a href=\"#chapter0\">Table &lt;5&gt;</a>"),
                                       at("<a href=\"#chapter1\">Fig. 7</a>"),
                                       at("<h2>Table &lt;5&gt;</h2>"),
                                       at("1900 at 60 Hz"),
                                       at("id=\"plot1\""),
                                       at("<h2>Fig. 7</h2>"),
                                       at("After 2 s of settling."),
                                       at("id=\"plot0\""),
                                       at("id=\"plot2\""),
                                       at("alt=\"Endoscope, first frame"),
                                       at("id=\"plot3\""),
                                       at("alt=\"Last frame\"")};
  EXPECT_TRUE(std::is_sorted(order.begin(), order.end()));
  EXPECT_EQ(json_of("data")["plots"].size(), 5u);
}

TEST_F(ReportTest, NeedsNothingFromOutside) {
  // attributes and style references that make a browser fetch something, in the page without its script bodies
  const std::string page = markup_only(html_);
  const std::regex reference("(src|href|action|poster)\\s*=\\s*[\"']?\\s*([a-z]*:?)|url\\(([^)]*)\\)|@import");
  std::size_t found = 0;
  for (std::sregex_iterator it(page.begin(), page.end(), reference), end; it != end; ++it, ++found)
    EXPECT_EQ((*it)[2].str().rfind("data:", 0), 0u) << it->str().substr(0, 80);
  EXPECT_EQ(found, 3u) << "the two pictures and the icon";
  EXPECT_FALSE(has("sourceMappingURL"));
  EXPECT_FALSE(has("url(")) << "a style sheet that fetches something";
  EXPECT_FALSE(has("@import"));
  EXPECT_TRUE(has("default-src 'none'")) << "and the browser is told so";
}

TEST_F(ReportTest, CarriesEveryRow) {
  const auto data = json_of("data");
  const auto& columns = data["tables"][0];
  ASSERT_EQ(columns["time_s"].size(), 1500u);
  ASSERT_EQ(columns["heart/z_m"].size(), 1500u);
  EXPECT_NEAR(columns["heart/z_m"][700].get<double>(), table_.column("heart/z_m")[700], 1e-8);
  EXPECT_NEAR(columns["time_s"][1499].get<double>(), table_.time_s()[1499], 1e-7);
  EXPECT_TRUE(columns["tracking/error_px"][1400 - 1].is_null()) << "no value";
  EXPECT_FALSE(columns.contains("tip/z_m")) << "only what is drawn";
  EXPECT_EQ(data["plots"].size(), 5u);
  EXPECT_EQ(data["plots"][0]["scale"], 1000);
  EXPECT_EQ(data["states"][0]["column"], "tracking/state");
}

TEST_F(ReportTest, EscapesWhatComesFromOutside) {
  EXPECT_TRUE(has("note: &quot;&lt;/script&gt;&lt;b&gt;&amp;&quot;"));
  EXPECT_EQ(json_of("summary"), report_.summary) << "</script> in a value must not end the element";
  EXPECT_EQ(count("<script"), count("</script>"));
  Report evil = report_;
  evil.title = "<img src=x onerror=alert(1)>";
  evil.plots[0].series[0].label = "</script><script>alert(1)</script>";
  evil.tables[0].rows[0][1] = "<b>\xff</b>";
  const std::string html = report_html(evil);
  EXPECT_EQ(html.find("<img src=x"), std::string::npos);
  EXPECT_EQ(html.find("<script>alert"), std::string::npos);
  EXPECT_EQ(html.find("<b>\xff"), std::string::npos);
}

TEST_F(ReportTest, IsWellFormed) {
  // every element that is opened is closed, in order
  const std::string page = markup_only(html_);
  std::vector<std::string> open;
  const std::regex tag("<(/?)([a-z][a-z0-9]*)[^>]*>");
  for (std::sregex_iterator it(page.begin(), page.end(), tag), end; it != end; ++it) {
    const std::string name = (*it)[2];
    if (name == "meta" || name == "link" || name == "img") continue;
    if ((*it)[1].length() == 0) {
      open.push_back(name);
    } else {
      ASSERT_FALSE(open.empty()) << "</" << name << ">";
      EXPECT_EQ(open.back(), name);
      open.pop_back();
    }
  }
  EXPECT_TRUE(open.empty());
  EXPECT_EQ(page.find("{{"), std::string::npos) << "a place of the template that was not filled";
  for (const char* id : {"plot0", "plot4", "legend0", "strip0", "shares0", "data", "hint"})
    EXPECT_EQ(count("id=\"" + std::string(id) + "\""), 1u) << id;
}

TEST_F(ReportTest, HasAStripForEveryTrackerAndTruthBelowLogarithmicErrors) {
  Report several = report_;
  several.states = {{"esm", "tracking/state"}, {"<ssd>", "tracking/state"}};
  several.plots[3].log_from = 0.001;
  several.plots[3].series.insert(several.plots[3].series.begin(), {"truth", "residual/norm_m", true});
  html_ = report_html(several);
  const auto data = json_of("data");
  ASSERT_EQ(data["states"].size(), 2u);
  EXPECT_EQ(data["states"][1]["label"], "<ssd>");
  EXPECT_EQ(data["plots"][3]["log_from"], 0.001);
  EXPECT_EQ(data["plots"][0]["log_from"], 0);
  EXPECT_EQ(data["plots"][3]["series"][0]["truth"], true);
  EXPECT_EQ(data["plots"][3]["series"][1]["truth"], false);
  for (const char* id : {"strip0", "strip1", "shares0", "shares1"})
    EXPECT_EQ(count("id=\"" + std::string(id) + "\""), 1u);
  EXPECT_TRUE(has("aria-label=\"State of &lt;ssd&gt; over time\""));
}

TEST_F(ReportTest, SaysWhatTheColoursOfAPictureMean) {
  EXPECT_FALSE(has("<i style=\"color")) << "no keys, no legend";
  Report keyed = report_;
  keyed.pictures[0].keys = {{"region", {233, 180, 86}, PictureKey::Mark::LINE},
                            {"lost", {0, 94, 213}, PictureKey::Mark::DASHES},
                            {"<glare>", {66, 228, 240}, PictureKey::Mark::AREA}};
  const std::string html = report_html(keyed);
  EXPECT_NE(html.find("<i style=\"color:#56b4e9\"></i>region"), std::string::npos) << "BGR in, RGB out";
  EXPECT_NE(html.find("<i class=\"dashes\" style=\"color:#d55e00\"></i>lost"), std::string::npos);
  EXPECT_NE(html.find("<i class=\"area\" style=\"color:#f0e442\"></i>&lt;glare&gt;"), std::string::npos);
}

TEST_F(ReportTest, AlignsColumnsOfNumbers) {
  EXPECT_TRUE(has("<td class=\"n\">0.37</td>"));
  EXPECT_TRUE(has("<td>1900 at 60 Hz</td>"));
}

TEST_F(ReportTest, CanBeAlmostEmpty) {
  Report bare;
  bare.title = "analyse motion.csv";
  bare.headline = "The heart beats at 78 per minute.";
  const std::string html = report_html(bare);
  EXPECT_NE(html.find("The heart beats at 78 per minute."), std::string::npos);
  EXPECT_EQ(html.find("<img"), std::string::npos);
  EXPECT_EQ(html.find("id=\"plot0\""), std::string::npos);
}

TEST_F(ReportTest, ReducesLargePictures) {
  Report large = report_;
  large.pictures = {{"wide", cv::Mat(100, 2560, CV_8UC1, cv::Scalar(90))}};
  EXPECT_NE(report_html(large).find("width=\"1280\" height=\"50\""), std::string::npos);
}

TEST_F(ReportTest, RefusesWhatItCannotShow) {
  Report bad = report_;
  bad.plots[0].series[0].column = "hart/z_m";
  EXPECT_NE(message_of<std::invalid_argument>([&] { report_html(bad); }).find("heart/z_m"), std::string::npos);
  bad = report_;
  bad.pictures[0].bgr = cv::Mat();
  EXPECT_NE(message_of<std::invalid_argument>([&] { report_html(bad); }), "nothing was thrown");
  bad = report_;
  bad.table = nullptr;
  EXPECT_NE(message_of<std::invalid_argument>([&] { report_html(bad); }), "nothing was thrown");
  EXPECT_EQ(
      message_of<ConfigError>([&] { write_report(report_, "/nowhere/report.html"); }).find("/nowhere/report.html: "),
      0u);
}

TEST_F(ReportTest, WritesThePage) {
  const test::TemporaryFolder folder;
  write_report(report_, folder / "report.html");
  EXPECT_EQ(test::read_text(folder / "report.html"), html_);
}

}  // namespace
}  // namespace heartservo::tools
