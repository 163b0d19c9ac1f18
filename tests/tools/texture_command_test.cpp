#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <set>

#include "tests/support/analytic_image.hpp"
#include "tests/support/files.hpp"
#include "tests/support/message.hpp"
#include "tools/texture/texture_tasks.hpp"
#include "tracking/settings/errors.hpp"
#include "tracking/texture/feature_bank.hpp"

namespace heartservo::tools {
namespace {

using test::message_of;

class TextureCommand : public testing::Test {
 protected:
  TextureCommand() {
    for (const char* name : {"000.png", "001.png"}) cv::imwrite(folder_ / name, test::analytic_image(120, 90));
  }

  DescribeOptions describe(std::vector<std::string> regions) const {
    DescribeOptions options;
    options.source = folder_.path();
    options.regions = std::move(regions);
    return options;
  }

  std::string csv_problem(const std::string& text) const {
    const std::string file = folder_.write("regions.csv", text);
    const std::string message = message_of<InputError>([&] { read_labelled_regions(file); });
    return message.substr(std::min(message.size(), file.size()));  // without the file's name
  }

  test::TemporaryFolder folder_;
};

TEST_F(TextureCommand, DescribesRegions) {
  const auto result = describe_texture(describe({"10,20,40,40", "50,20,30,60"}));
  ASSERT_EQ(result["regions"].size(), 2u);
  EXPECT_EQ(result["regions"][1]["roi"], (nlohmann::json{50, 20, 30, 60}));
  EXPECT_EQ(result["regions"][0]["vector"].size(), 8u);
  EXPECT_EQ(result["regions"][0]["features"].size(), 8u);
  EXPECT_EQ(result["distances"][0][0], 0);
  EXPECT_GT(result["distances"][0][1], 0.01);
  auto full = describe({"10,20,40,40"});
  full.full = true;
  const auto bank = describe_texture(full);
  EXPECT_EQ(bank["regions"][0]["features"].size(), tracking::kFeatureCount);
  EXPECT_NE(describe_text(bank).find("max_correlation"), std::string::npos);
}

TEST_F(TextureCommand, RefusesRegionsInOneLine) {
  const auto refusal = [&](const std::string& region) {
    return message_of<ConfigError>([&] { describe_texture(describe({region})); });
  };
  EXPECT_NE(refusal("90,20,40,40").find("is not inside the picture of 120 x 90 px"), std::string::npos);
  EXPECT_NE(refusal("-1,20,40,40").find("is not inside"), std::string::npos);
  EXPECT_NE(refusal("2147483647,0,40,40").find("is not inside"), std::string::npos);
  EXPECT_NE(refusal("10,20,11,40").find("too small"), std::string::npos);
  for (const char* bad : {"10,20,40", "10,20,40,40,1", "10,20,40,a", "10;20;40;40", "", "99999999999,0,40,40"})
    EXPECT_NE(refusal(bad).find("expected x,y,width,height"), std::string::npos) << bad;
  auto late = describe({"10,20,40,40"});
  late.frame = 2;
  EXPECT_NE(message_of<ConfigError>([&] { describe_texture(late); }).find("there is no frame 2; it has 2"),
            std::string::npos);
  auto missing = describe({"10,20,40,40"});
  missing.source = "/nowhere";
  EXPECT_THROW(describe_texture(missing), InputError);
  EXPECT_THROW(describe_texture(describe({})), ConfigError);
}

TEST_F(TextureCommand, ReadsLabelledRegions) {
  const std::string file = folder_.write(
      "regions.csv",
      "file,x,y,width,height,class\r\n000.png,1,2,30,20,fat\r\n\r\n 001.png , 0, 0, 12, 12, \"muscle\"\n");
  const auto regions = read_labelled_regions(file);
  ASSERT_EQ(regions.size(), 2u);
  EXPECT_EQ(regions[0].grey.size(), cv::Size(30, 20));
  EXPECT_EQ(regions[1].label, "muscle");
}

TEST_F(TextureCommand, NamesTheLineOfABadCsv) {
  const std::string header = "file,x,y,width,height,class\n";
  EXPECT_EQ(csv_problem("x,y\n"), ":1: expected the header file,x,y,width,height,class");
  EXPECT_EQ(csv_problem(header), ": has a header and no regions");
  EXPECT_EQ(csv_problem(header + "000.png,1,2,30,20\n"), ":2: 5 cells under 6 columns");
  EXPECT_EQ(csv_problem(header + "000.png,1,2,30,20,\n"), ":2: file or class is empty");
  EXPECT_EQ(csv_problem(header + "000.png,1,2.5,30,20,fat\n"), ":2: '2.5' is not a whole number of px");
  EXPECT_NE(
      csv_problem(header + "000.png,1,2,30,20,a\n000.png,100,2,30,20,a\n").find(":3: 000.png: region 100,2,30,20"),
      std::string::npos);
  EXPECT_NE(csv_problem(header + "gone.png,1,2,30,20,a\n").find("gone.png"), std::string::npos);
  EXPECT_NE(message_of<InputError>([] { read_labelled_regions("/nowhere.csv"); }), "nothing was thrown");
}

TEST_F(TextureCommand, RefusesRegionsThatSayNothing) {
  SelectOptions options;
  options.csv = "regions.csv";
  const auto refusal = [&](const std::vector<LabelledRegion>& regions) {
    return message_of<InputError>([&] { select_texture(options, regions); });
  };
  const cv::Mat grey = test::analytic_image(40, 40), flat(40, 40, CV_8UC1, cv::Scalar(90));
  EXPECT_EQ(refusal(std::vector<LabelledRegion>(50, {grey, "fat"})),
            "regions.csv: there is one class only, 'fat'; give two or more");
  std::vector<LabelledRegion> regions(34, {grey, "fat"});
  regions.push_back({flat, "none"});
  EXPECT_EQ(refusal(regions), "regions.csv: class 'none' has fewer than two samples");
  regions.resize(33, {grey, "fat"});
  regions[0].label = "muscle";
  EXPECT_NE(refusal(regions).find("33 samples are too few for 33 features and 2 classes; give 35 or more"),
            std::string::npos);
  regions.assign(50, {flat, "fat"});
  regions.resize(100, {flat, "muscle"});
  EXPECT_NE(refusal(regions).find("33 of 33 features are the same in every sample"), std::string::npos);
  EXPECT_THROW(regions_for({}), ConfigError) << "neither a CSV nor --simulated";
}

TEST(TextureSelect, TellsSimulatedMaterialsApart) {
  SelectOptions options;
  options.simulated = true;
  options.per_class = 20;
  const auto regions = regions_for(options);
  const auto again = regions_for(options);
  ASSERT_EQ(regions.size(), again.size());
  for (std::size_t i = 0; i < regions.size(); ++i)
    ASSERT_EQ(cv::norm(regions[i].grey, again[i].grey, cv::NORM_L1), 0) << "the same seed, the same regions";
  const auto result = select_texture(options, regions);
  std::set<std::string> classes;
  for (const auto& c : result["classes"]) {
    classes.insert(c["name"].get<std::string>());
    EXPECT_EQ(c["samples"], 20);
  }
  EXPECT_EQ(classes, (std::set<std::string>{"fat", "landmark", "muscle", "vessel"}));
  EXPECT_EQ(result["features"].size() + result["constant"].size(), tracking::kFeatureCount);
  EXPECT_EQ(result["chosen"]["features"].size(), 8u);
  EXPECT_GT(result["chosen"]["accuracy"], 0.9);
  EXPECT_LE(result["chosen"]["wilks_lambda"], result["paper"]["wilks_lambda"]) << "chosen for it";
  EXPECT_NE(select_text(result).find("of the paper's eight are among the chosen"), std::string::npos);
  EXPECT_NE(report_html(select_report(result, regions)).find("leave one out"), std::string::npos);
}

}  // namespace
}  // namespace heartservo::tools
