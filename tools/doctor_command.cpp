// heartservo doctor: what this machine has and lacks, and how to mend each lack.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "tools/command.hpp"
#include "tools/doctor/checks.hpp"

namespace heartservo::tools {

namespace {

const char* name_of(Finding::State state) {
  switch (state) {
    case Finding::State::OK:
      return "ok";
    case Finding::State::NOTE:
      return "note";
    case Finding::State::LACK:
      return "LACK";
  }
  return "";
}

int run_doctor(bool as_json) {
  const auto findings = examine_machine();
  if (as_json) {
    nlohmann::json j{{"command", "doctor"}, {"version", HEARTSERVO_VERSION}, {"findings", nlohmann::json::array()}};
    for (const auto& f : findings)
      j["findings"].push_back(
          {{"subject", f.subject}, {"state", name_of(f.state)}, {"found", f.found}, {"fix", f.fix}});
    fmt::print("{}\n", j.dump(2));
    return DONE;
  }
  for (const auto& f : findings) {
    fmt::print("{:<5}{:<15}{}\n", name_of(f.state), f.subject, f.found);
    if (!f.fix.empty()) fmt::print("{:20}{}\n", "", f.fix);
  }
  return DONE;
}

}  // namespace

Command add_doctor_command(CLI::App& program) {
  auto as_json = std::make_shared<bool>(false);
  CLI::App* app = program.add_subcommand("doctor", "what this machine has and lacks, and how to mend it");
  app->add_flag("--json", *as_json, "the findings as JSON");
  app->footer("Example:\n  heartservo doctor");
  return {app, [as_json] { return run_doctor(*as_json); }};
}

}  // namespace heartservo::tools
