// heartservo texture: the texture vector of regions, and the selection of its features.
#include <fmt/format.h>

#include "tools/command.hpp"
#include "tools/run_folder.hpp"
#include "tools/texture/texture_tasks.hpp"

namespace heartservo::tools {

namespace {

struct TextureCommandOptions {
  DescribeOptions describe;
  SelectOptions select;
  std::string out;
  bool json = false, quiet = false;
};

void add_texture_options(CLI::App& app, tracking::TextureSettings& texture, TextureCommandOptions& o) {
  app.add_option("--levels", texture.levels, "grey levels of the matrices (default 32)")
      ->check(CLI::Range(2, tracking::kMaxLevels));
  app.add_option("--distance", texture.distance, "px between the pixels of a co-occurrence (default 1)")
      ->check(CLI::Range(1, 64));
  app.add_option("--range", texture.range, "levels divide grey 0 to 255 (full) or the region's own range (own)")
      ->check(CLI::IsMember({"full", "own"}));
  app.add_flag("--json", o.json, "print the result as JSON and nothing else");
  app.add_flag("--quiet", o.quiet, "no table");
}

int run_describe(const TextureCommandOptions& o) {
  const auto description = describe_texture(o.describe);
  if (o.json)
    fmt::print("{}\n", description.dump(2));
  else if (!o.quiet)
    fmt::print("{}", describe_text(description));
  return DONE;
}

std::string select_config(const TextureCommandOptions& o) {
  const SelectOptions& s = o.select;
  std::string text = fmt::format("# heartservo {} texture select: the resolved configuration\n", HEARTSERVO_VERSION);
  text += s.simulated ? fmt::format("simulated: true\nseed: {}\nper_class: {}\n", s.seed, s.per_class)
                      : "csv: " + nlohmann::json(std::filesystem::absolute(s.csv).string()).dump() + "\n";
  return text + fmt::format("count: {}\nmax_correlation: {}\nlevels: {}\ndistance: {}\nrange: {}\n", s.count,
                            s.max_correlation, s.texture.levels, s.texture.distance, s.texture.range);
}

int run_select(const TextureCommandOptions& o) {
  const auto regions = regions_for(o.select);
  const auto selection = select_texture(o.select, regions);
  std::string where;
  if (!o.out.empty()) {
    RunFolder folder(o.out);
    Report report = select_report(selection, regions);
    report.config_yaml = select_config(o);
    folder.write("config.yaml", report.config_yaml);
    folder.write("summary.json", selection.dump(2) + "\n");
    write_report(report, folder.file("report.html"));
    folder.finish();
    where = "report: " + folder.file("report.html").string() + "\n";
  }
  if (o.json)
    fmt::print("{}\n", selection.dump(2));
  else if (!o.quiet)
    fmt::print("{}{}", select_text(selection), where);
  return DONE;
}

}  // namespace

Command add_texture_command(CLI::App& program) {
  auto options = std::make_shared<TextureCommandOptions>();
  TextureCommandOptions& o = *options;
  CLI::App* app = program.add_subcommand("texture", "texture vector of regions; selection of its features");
  app->require_subcommand(1);
  app->footer(
      "Examples:\n  heartservo texture describe frames/ --roi 212,130,50,50\n"
      "  heartservo texture select --simulated");

  CLI::App* describe = app->add_subcommand("describe", "the paper's eight features of regions, or all of them");
  describe->add_option("source", o.describe.source, "image folder, printf pattern, picture, video or scene (.yaml)");
  describe->add_option("--roi", o.describe.regions, "region x,y,width,height in px; may be repeated")
      ->type_name("X,Y,W,H")
      ->allow_extra_args(false);
  describe->add_option("--frame", o.describe.frame, "number of the frame, from 0")->check(CLI::Range(0, 2000000000));
  describe->add_flag("--full", o.describe.full, "all features as defined, beside the eight");
  add_texture_options(*describe, o.describe.texture, o);
  describe->footer("Example: heartservo texture describe frames/ --roi 212,130,50,50 --roi 178,212,50,50");

  CLI::App* select = app->add_subcommand("select", "rank the features by how they tell classes of regions apart");
  select->add_option("csv", o.select.csv, "regions: file,x,y,width,height,class; files relative to the CSV");
  select->add_flag("--simulated", o.select.simulated, "regions of the simulated heart: muscle, fat, vessel, landmark");
  select->add_option("--seed", o.select.seed, "seed of the simulated regions")->check(CLI::Range(0, 2000000000));
  select->add_option("--per-class", o.select.per_class, "simulated regions of each class (default 60)")
      ->check(CLI::Range(10, 1000));
  select->add_option("--count", o.select.count, "features to choose (default 8)")->check(CLI::Range(1, 33));
  select->add_option("--max-correlation", o.select.max_correlation, "pass over features more alike (default 0.95)")
      ->check(CLI::Range(0.1, 1.0));
  select->add_option("--out", o.out, "run folder with a report (default: none)")->type_name("DIR");
  add_texture_options(*select, o.select.texture, o);
  select->footer("Examples:\n  heartservo texture select --simulated\n  heartservo texture select regions.csv --json");

  return {app, [options, describe] { return describe->parsed() ? run_describe(*options) : run_select(*options); }};
}

}  // namespace heartservo::tools
