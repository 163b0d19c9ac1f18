#include "tracking/settings/document.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/tracking/settings/example_options.hpp"

namespace heartservo::test {
namespace {

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(Markdown, ShowsAllThereIsToAKey) {
  const std::string text = to_markdown(ExampleOptions{});
  EXPECT_TRUE(has(text, "| `frames` | whole number |  | `1900` | 1 to 1000000 | how many |\n")) << text;
  EXPECT_TRUE(has(text, "| `rate_hz` | number | Hz | `60` | ≥ 1 | frames a second |\n")) << text;
  EXPECT_TRUE(has(text, "| `limit_m` | number | m |  |  | how far |\n")) << text;
  EXPECT_TRUE(has(text, "| `noise` | true or false |  | `true` |  | with noise |\n")) << text;
  EXPECT_TRUE(has(text, "| `gains` | list of numbers |  | `[1, 0.5]` |  | one per axis |\n")) << text;
  EXPECT_TRUE(has(text, "| `engine` | name |  |  | fast, slow | what drives it |\n")) << text;
  EXPECT_TRUE(has(text, "`\"pig \\| 2007\"`")) << "a bar in a value must not end the cell:\n" << text;
}

TEST(Markdown, WritesNestedKeysInFull) {
  const std::string text = to_markdown(ExampleOptions{});
  EXPECT_TRUE(has(text, "### `loop`\n\nThe closed loop.\n\n| Key |")) << text;
  EXPECT_TRUE(has(text, "| `loop.tracker` | name |  | `esm` | esm, ssd, optical_flow | who follows the target |\n"));
  EXPECT_TRUE(has(text, "| `loop.offset_m` | list of 3 numbers | m | `[0, 0, 0.01]` |  | desired offset |\n")) << text;
  EXPECT_TRUE(has(text, "### `landmarks[]`\n\nPoints on the heart.\n")) << text;
  EXPECT_TRUE(has(text, "| `landmarks[].x_m` | number | m | `0.001` | -0.1 to 0.1 | where it is |\n")) << text;
}

TEST(Markdown, LeavesTheOptionsAlone) {
  ExampleOptions options;
  options.landmarks.resize(3);
  const auto fields = [&](FieldVisitor& visitor) { options.fields(visitor); };
  const std::string text = markdown_of(fields);
  json_schema_of(fields, "");
  EXPECT_EQ(options.landmarks.size(), 3u);
  EXPECT_EQ(text.find("landmarks[].x_m"), text.rfind("landmarks[].x_m")) << "one row for a key of a list";
}

TEST(JsonSchema, TypesRangesAndDefaults) {
  const auto schema = nlohmann::json::parse(to_json_schema(ExampleOptions{}, "A scene"));
  EXPECT_EQ(schema["$schema"], "https://json-schema.org/draft/2020-12/schema");
  EXPECT_EQ(schema["title"], "A scene");
  EXPECT_EQ(schema["additionalProperties"], false);
  const auto& keys = schema["properties"];
  EXPECT_EQ(keys.size(), 9u);
  EXPECT_EQ(keys["frames"], nlohmann::json::parse(R"({"description":"how many","type":"integer","minimum":1.0,
      "maximum":1000000.0,"default":1900})"));
  EXPECT_EQ(keys["rate_hz"]["description"], "frames a second [Hz]");
  EXPECT_FALSE(keys["rate_hz"].contains("maximum"));
  EXPECT_FALSE(keys["limit_m"].contains("default"));
  EXPECT_EQ(keys["noise"]["type"], "boolean");
  EXPECT_EQ(keys["gains"]["type"], "array");
  EXPECT_EQ(keys["gains"]["default"], nlohmann::json::parse("[1, 0.5]"));
  EXPECT_EQ(keys["engine"]["enum"], nlohmann::json::parse(R"(["fast", "slow"])"));
  EXPECT_FALSE(keys["engine"].contains("default"));
}

TEST(JsonSchema, NestsGroupsAndLists) {
  const auto keys = nlohmann::json::parse(to_json_schema(ExampleOptions{}, ""))["properties"];
  EXPECT_EQ(keys["loop"]["description"], "The closed loop.");
  EXPECT_EQ(keys["loop"]["additionalProperties"], false);
  EXPECT_EQ(keys["loop"]["properties"]["offset_m"]["minItems"], 3);
  EXPECT_EQ(keys["loop"]["properties"]["offset_m"]["maxItems"], 3);
  EXPECT_EQ(keys["loop"]["properties"]["tracker"]["default"], "esm");
  EXPECT_EQ(keys["landmarks"]["type"], "array");
  EXPECT_EQ(keys["landmarks"]["description"], "Points on the heart.");
  EXPECT_EQ(keys["landmarks"]["items"]["properties"]["x_m"]["maximum"], 0.1);
  EXPECT_EQ(keys["landmarks"]["items"]["additionalProperties"], false);
}

}  // namespace
}  // namespace heartservo::test
