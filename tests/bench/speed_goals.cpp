// heartservo_speed_goals: how long every stage takes on one core of this machine, with the goal beside it, and the limit
// that the machine itself sets. Times are CPU times, ratios are of one run. --json FILE keeps the numbers;
// tests/bench/compare_speed.py compares two such files.
#include <CLI/CLI.hpp>
#include <fstream>
#include <functional>
#include <opencv2/core/utility.hpp>

#include "tests/bench/speed/rows.hpp"

namespace {

using namespace heartservo::bench;

MachineLimit add_machine(Results& results) {
  const MachineLimit machine = measure_machine();
  results.heading("this machine, one core");
  results.add("multiply-add, 32 bit", machine.gflops, "GF/s", NAN, true, machine.instructions);
  results.add("word by a gather instruction", machine.gather_ns, "ns", NAN);
  results.add("scattered words loaded one by one", machine.load_ns, "ns", NAN);
  results.add("reading memory", machine.read_gb_s, "GB/s", NAN, true);
  results.all["machine"] = {{"instructions", machine.instructions}, {"gflops", machine.gflops},
                            {"gather_ns", machine.gather_ns}, {"load_ns", machine.load_ns}, {"read_gb_s", machine.read_gb_s}};
  return machine;
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> parts;
  std::string json;
  int frames = 600, memory_frames = 20000;
  CLI::App app("how long every stage takes, with the goal beside it");
  app.add_option("--parts", parts, "of esm, peers, texture, composite, deformable, pose, chain, parallel, scaling, memory; default: all")
      ->delimiter(',');
  app.add_option("--frames", frames, "of the simulated loop")->capture_default_str();
  app.add_option("--memory-frames", memory_frames, "of the long run")->capture_default_str();
  app.add_option("--json", json, "file for the results");
  CLI11_PARSE(app, argc, argv);
  try {
    cv::setNumThreads(1);
    Results results;
    const MachineLimit machine = add_machine(results);
    const std::vector<std::pair<std::string, std::function<void()>>> all{
        {"esm", [&] { add_esm_rows(results, machine); }},
        {"peers", [&] { add_peer_rows(results); }},
        {"texture", [&] { add_texture_rows(results); }},
        {"composite", [&] { add_composite_rows(results); }},
        {"deformable", [&] { add_deformable_rows(results); }},
        {"pose", [&] { add_pose_rows(results); }},
        {"chain", [&] { add_chain_rows(results, frames); }},
        {"parallel", [&] { add_parallel_rows(results); }},
        {"scaling", [&] { add_scaling_rows(results); }},
        {"memory", [&] { add_memory_rows(results, memory_frames); }},
    };
    for (const auto& [name, run] : all)
      if (parts.empty() || std::count(parts.begin(), parts.end(), name)) run();
    if (!json.empty()) {
      std::ofstream file(json);
      file << results.all.dump(1) << '\n';
      if (!file.flush()) throw std::runtime_error(json + ": cannot be written");
    }
  } catch (const std::exception& e) {
    fmt::print(stderr, "heartservo_speed_goals: {}\n", e.what());
    return 2;
  }
  return 0;
}
