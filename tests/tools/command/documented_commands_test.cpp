// Every command line that the documentation and --help show, run in a folder laid out like the project.
#include <algorithm>
#include <regex>
#include <sstream>

#include "sim/scene/scene.hpp"
#include "tests/tools/command/command_fixture.hpp"

namespace heartservo::test {
namespace {

struct Line {
  std::string where, text;
};

// Lines in ``` fences that begin with heartservo; a '\' at the end goes on in the next line.
std::vector<Line> fenced_lines(const fs::path& file) {
  std::vector<Line> lines;
  std::istringstream in(read_text(file));
  std::string text;
  bool fenced = false, goes_on = false;
  static const std::regex prompt("^\\s*(\\$ )?((\\./)?build/release/)?heartservo ");
  for (int number = 1; std::getline(in, text); ++number) {
    if (text.find("```") != std::string::npos) {
      fenced = !fenced;
      goes_on = false;
      continue;
    }
    if (!fenced) continue;
    const bool begins = std::regex_search(text, prompt);
    if (begins && !goes_on)
      lines.push_back(
          {file.filename().string() + ":" + std::to_string(number), std::regex_replace(text, prompt, "heartservo ")});
    else if (goes_on)
      lines.back().text += text;
    goes_on = (begins || goes_on) && !text.empty() && text.back() == '\\';
    if (goes_on) lines.back().text.pop_back();
  }
  return lines;
}

std::vector<Line> help_lines(const std::string& command, const std::string& help) {
  std::vector<Line> lines;
  std::istringstream in(help);
  std::string text;
  bool examples = false;
  while (std::getline(in, text)) {
    examples |= text.rfind("Example", 0) == 0;
    const auto at = text.find("heartservo ");
    const bool starts = at != std::string::npos && (text.substr(0, at).find_first_not_of(' ') == std::string::npos ||
                                                    text.rfind("Example: ", 0) == 0);
    if (examples && starts) lines.push_back({command + " --help", text.substr(at)});
  }
  return lines;
}

class DocumentedCommands : public CommandLine {
 protected:
  void SetUp() override {
    fs::create_directories(project_);
    fs::copy(HEARTSERVO_SOURCE_DIR "/scenes", project_ / "scenes", fs::copy_options::recursive);
    fs::create_directories(folder_ / "shared");
    if (fs::exists(recorded_data())) fs::create_directory_symlink(recorded_data(), folder_ / "shared/data");
    // what the examples call their frames
    ASSERT_EQ(run({"render", scene("pig_2007"), "--frames", "25", "--quiet", "--out", "project/rendered"}).code, 0);
    fs::create_directory_symlink("rendered/frames", project_ / "frames");
    fs::create_directories(project_ / "recorded");
    fs::create_directory_symlink("../rendered/frames", project_ / "recorded/frames");
  }

  // "" or why the line cannot be run here.
  std::string why_not(const std::string& line) const {
    static const std::regex placeholder("(^|[ =,:])[A-Z][A-Z_]+([ =,/:]|$)");
    if (line.find("...") != std::string::npos || line.find("…") != std::string::npos) return "has an ellipsis";
    if (std::regex_search(line, placeholder)) return "has a placeholder";
    std::istringstream words(line);
    std::string word, before, command;
    bool before_out = false;
    words >> word >> command;
    if (command == "paper" || command == "sweep") return "takes too long for a unit test";
    static const std::regex window(" --(show|select)( |$)");
    if (std::regex_search(line, window)) return "opens a window; live_window_test.cpp has a screen for it";
    for (; words >> word; before = word) {
      if (word[0] == '#' || word[0] == '>') break;
      if (word[0] == '-' || before == "--out" || before == "--into") continue;
      if (word.rfind("v4l2:", 0) == 0) word = word.substr(5);
      const bool is_path = word.find('/') != std::string::npos || fs::path(word).extension().string().size() > 3;
      const bool is_number = word.find_first_not_of("0123456789.,-+e") == std::string::npos;
      if (is_number || !is_path || word.find('*') != std::string::npos || word.find('%') != std::string::npos) continue;
      if (before_out) continue;
      before_out = line.rfind("heartservo camera convert ", 0) == 0;  // its second file is written
      if (!fs::exists(project_ / word)) return word + " is not here";
      if (fs::path(word).extension() != ".yaml" ||
          !fs::path(word).parent_path().filename().string().starts_with("scenes"))
        continue;
      const auto loaded = sim::load_scene(project_ / word);
      if (loaded.is_recorded() && !fs::exists(sim::resolve(loaded, loaded.recording.source)))
        return loaded.recording.source + " is not here; set HEARTSERVO_DATA to the recorded data";
    }
    return "";
  }

  // The line with few frames and a run folder of its own.
  static std::string shortened(const std::string& line) {
    static const std::regex run("^heartservo (servo|track|render|stabilise)( |$)");
    if (!std::regex_search(line, run)) return line;
    static const std::regex own("\\s--(frames|out|settle-s)[ =]\\S+");
    const std::string bare = std::regex_replace(line, own, "");
    const auto end = std::min(bare.find_first_of(">|#&;"), bare.size());
    return bare.substr(0, end) + " --frames 12 --out documented" + (end < bare.size() ? " " : "") + bare.substr(end);
  }

  void expect_works(const std::vector<Line>& lines) const {
    for (const auto& line : lines) {
      if (const std::string why = why_not(line.text); !why.empty()) {
        std::printf("not run: %s: %s: %s\n", line.where.c_str(), line.text.c_str(), why.c_str());
        continue;
      }
      const std::string path = fs::path(HEARTSERVO_PROGRAM).parent_path();
      const std::string text = "PATH='" + path + "':$PATH; export PATH; " + shortened(line.text);
      const Outcome o = run_process({"sh", "-c", text}, project_);
      EXPECT_EQ(o.code, 0) << line.where << ": " << line.text << "\n" << o.err;
      EXPECT_FALSE(o.timed_out) << line.where << ": " << line.text;
    }
  }

  fs::path project_ = folder_ / "project";
};

std::vector<std::string> pages() {
  std::vector<std::string> pages{"README.md", "scenes/README.md"};
  if (fs::exists(HEARTSERVO_SOURCE_DIR "/docs"))
    for (const auto& entry : fs::directory_iterator(HEARTSERVO_SOURCE_DIR "/docs"))
      if (entry.path().extension() == ".md") pages.push_back("docs/" + entry.path().filename().string());
  std::sort(pages.begin(), pages.end());
  return pages;
}

class DocumentedPage : public DocumentedCommands, public testing::WithParamInterface<std::string> {};

TEST_P(DocumentedPage, ItsCommandsWork) { expect_works(fenced_lines(fs::path(HEARTSERVO_SOURCE_DIR) / GetParam())); }

INSTANTIATE_TEST_SUITE_P(Pages, DocumentedPage, testing::ValuesIn(pages()), [](const auto& page) {
  std::string name = page.param;
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  return name;
});

TEST_F(DocumentedCommands, PagesShowCommands) {
  std::size_t count = 0;
  for (const auto& page : pages()) count += fenced_lines(fs::path(HEARTSERVO_SOURCE_DIR) / page).size();
  EXPECT_GE(count, 20u);
}

class DocumentedHelp : public DocumentedCommands, public testing::WithParamInterface<std::string> {};

TEST_P(DocumentedHelp, ItsExamplesWork) {
  const std::string& command = GetParam();
  using Arguments = std::vector<std::string>;
  const auto help = run(command == "heartservo" ? Arguments{"--help"} : Arguments{command, "--help"}).out;
  const auto lines = help_lines(command, help);
  EXPECT_FALSE(lines.empty()) << help;
  expect_works(lines);
}

INSTANTIATE_TEST_SUITE_P(Commands, DocumentedHelp,
                         testing::Values("heartservo", "servo", "track", "render", "scene", "calibrate", "camera",
                                         "analyse", "beats", "stabilise", "paper", "report", "doctor", "capture",
                                         "texture", "predict", "sweep"),
                         [](const auto& command) { return command.param; });

TEST_F(DocumentedCommands, AWrongLineIsNoticed) {
  EXPECT_EQ(why_not("heartservo servo scenes/pig_2007.yaml --trackr esm"), "");
  EXPECT_NE(why_not("heartservo servo FRAMES --roi 1,2,3,4"), "");
  EXPECT_NE(why_not("heartservo servo /nowhere/frames"), "");
  EXPECT_EQ(shortened("heartservo servo a.yaml --out b --frames 3 # why"),
            "heartservo servo a.yaml  --frames 12 --out documented # why");
  const auto page = folder_ / "page.md";
  write_text(page, "heartservo no\n```sh\n$ heartservo servo a \\\n  --json\nls\n```\n");
  const auto lines = fenced_lines(page);
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(lines[0].text, "heartservo servo a   --json");
}

}  // namespace
}  // namespace heartservo::test
