#include "tools/program.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstdio>
#include <cstring>

#include "tools/command.hpp"
#include "tracking/settings/errors.hpp"
#include "tracking/settings/yaml_reader.hpp"

namespace heartservo::tools {

namespace {

int complain(int code, const std::string& what) {
  std::string line = what;
  for (char& c : line)
    if (c == '\n') c = ' ';
  fmt::print(stderr, "heartservo: {}\n", line);
  return code;
}

// The words that `app` understands and that look like `word`: its options or its commands.
std::string suggestion(const CLI::App& app, const std::string& word) {
  std::vector<std::string> names;
  if (word.rfind("-", 0) == 0) {
    for (const CLI::Option* option : app.get_options())
      for (const auto& name : option->get_lnames()) names.push_back("--" + name);
  } else {
    for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
  }
  return did_you_mean(word.substr(0, word.find('=')), names);
}

int parse_error(const CLI::App& program, const CLI::ParseError& e) {
  const CLI::App* app = &program;
  std::string path;  // "texture describe "
  for (auto used = program.get_subcommands(); !used.empty(); used = app->get_subcommands()) {
    app = used.front();
    path += app->get_name() + " ";
  }
  const std::string help = fmt::format("; see 'heartservo {}--help'", path);
  const auto extra = program.remaining(true);
  if (!extra.empty()) {
    const bool is_option = extra.front().rfind("-", 0) == 0;
    return complain(WRONG_USAGE, fmt::format("{} '{}' is not known{}{}",
                                             is_option                           ? "option"
                                             : !app->get_subcommands({}).empty() ? "command"
                                                                                 : "argument",
                                             extra.front(), suggestion(*app, extra.front()), help));
  }
  return complain(WRONG_USAGE, e.what() + help);
}

// What the program printed is only there when the last buffer is out: a full disk shows here.
int finish(int code) {
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return code;
  return complain(WRONG_USAGE, fmt::format("stdout cannot be written: {}", std::strerror(errno)));
}

}  // namespace

int run_program(const std::vector<std::string>& arguments) {
  CLI::App program(
      "heartservo: the motion of a beating heart from an endoscope, and a tool that stands still on it.\n"
      "Research software, not a medical device.");
  program.name("heartservo");
  program.set_version_flag("--version", std::string("heartservo ") + HEARTSERVO_VERSION);
  program.require_subcommand(1);
  program.footer(
      "Example: heartservo servo scenes/pig_2007.yaml\n"
      "Exit codes: 0 done, 2 wrong usage or configuration, 3 unreadable input, 4 device trouble, 5 safety stop");
  const Command commands[] = {
      add_servo_command(program),  add_track_command(program),     add_render_command(program),
      add_scene_command(program),  add_texture_command(program),   add_calibrate_command(program),
      add_camera_command(program), add_predict_command(program),   add_analyse_command(program),
      add_beats_command(program),  add_stabilise_command(program), add_paper_command(program),
      add_report_command(program), add_doctor_command(program),    add_sweep_command(program),
      add_capture_command(program)};
  try {
    program.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));  // CLI11 takes the last one first
    for (const Command& command : commands)
      if (command.app->parsed()) return finish(command.run());
    return WRONG_USAGE;
  } catch (const CLI::Success& e) {  // --help and --version
    return finish(program.exit(e));
  } catch (const CLI::ParseError& e) {
    return parse_error(program, e);
  } catch (const ConfigError& e) {
    return complain(WRONG_USAGE, e.what());
  } catch (const InputError& e) {
    return complain(BAD_INPUT, e.what());
  } catch (const DeviceError& e) {
    return complain(DEVICE_TROUBLE, e.what());
  } catch (const std::system_error& e) {  // fmt::print
    return complain(WRONG_USAGE, fmt::format("stdout cannot be written: {}", e.code().message()));
  } catch (const std::exception& e) {
    return complain(INTERNAL_ERROR, fmt::format("internal error, please report it: {}", e.what()));
  }
}

}  // namespace heartservo::tools
