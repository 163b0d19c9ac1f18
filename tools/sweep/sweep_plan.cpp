#include "tools/sweep/sweep_plan.hpp"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "tools/shipped.hpp"
#include "tracking/settings/errors.hpp"
#include "tracking/settings/yaml_reader.hpp"

namespace heartservo::tools {

namespace {

const std::vector<std::string> kMetrics{"residual.rms_mm",   "residual.p95_mm",       "residual.max_mm",
                                        "reduction_percent", "tracking.lost_frames",  "tracking.uncertain_frames",
                                        "tracking.relocks",  "commands.safety_stops", "timing.chain_ms.p50"};

std::string text_of(const YAML::Node& node) {
  if (node.IsScalar()) return node.Scalar();
  YAML::Emitter out;
  out << YAML::Flow << node;
  return out.c_str();
}

bool is_number(const std::string& text) {
  char* end = nullptr;
  const double v = std::strtod(text.c_str(), &end);
  return end != text.c_str() && *end == '\0' && std::isfinite(v);
}

// Sets the key at a path, such as "loop.guard.coast_s", in a map.
void put(YAML::Node node, const std::string& path, const std::string& value) {
  const auto dot = path.find('.');
  const std::string key = path.substr(0, dot);
  if (dot == std::string::npos) {
    node[key] = YAML::Load(value);
    return;
  }
  if (!node[key].IsDefined() || node[key].IsNull()) node[key] = YAML::Node(YAML::NodeType::Map);
  if (!node[key].IsMap()) throw ConfigError(fmt::format("'{}' is not a group of keys in the scene", key));
  put(node[key], path.substr(dot + 1), value);
}

// {from, to} or {from, to, steps}
std::vector<std::string> range_of(const YAML::Node& node, const std::string& where) {
  std::vector<std::string> values;
  for (const auto& entry : node)
    if (const std::string key = entry.first.Scalar(); key != "from" && key != "to" && key != "steps")
      throw ConfigError(where + ": a range has from, to and, for values between whole numbers, steps");
  double from = NAN, to = NAN;
  int steps = 0;
  if (!node["from"] || !node["to"] || !YAML::convert<double>::decode(node["from"], from) ||
      !YAML::convert<double>::decode(node["to"], to) || !std::isfinite(from) || !std::isfinite(to))
    throw ConfigError(where + ": a range needs from and to, which are numbers");
  if (node["steps"]) {
    if (!YAML::convert<int>::decode(node["steps"], steps) || steps < 2 || steps > 1000000)
      throw ConfigError(where + ": steps must be a whole number from 2 on");
    for (int i = 0; i < steps; ++i) values.push_back(fmt::format("{:.10g}", from + (to - from) * i / (steps - 1)));
    return values;
  }
  if (from != std::floor(from) || to != std::floor(to) || to < from || to - from > 1e7)
    throw ConfigError(where + ": from and to must be whole numbers in this order, or steps given");
  for (long long i = static_cast<long long>(from); i <= static_cast<long long>(to); ++i)
    values.push_back(std::to_string(i));
  return values;
}

}  // namespace

std::uint64_t SweepPlan::runs() const {
  std::uint64_t n = 1;
  for (const auto& axis : axes) {
    if (axis.values.empty()) return 0;
    if (n > (std::uint64_t{1} << 62) / axis.values.size()) return std::uint64_t{1} << 62;
    n *= axis.values.size();
  }
  return n;
}

std::vector<std::string> SweepPlan::values(std::uint64_t i) const {
  std::vector<std::string> chosen(axes.size());
  for (std::size_t k = axes.size(); k-- > 0;) {
    chosen[k] = axes[k].values[i % axes[k].values.size()];
    i /= axes[k].values.size();
  }
  return chosen;
}

sim::Scene SweepPlan::scene_of(std::uint64_t i) const {
  const auto chosen = values(i);
  std::vector<std::pair<std::string, std::string>> changes = set;
  for (std::size_t k = 0; k < axes.size(); ++k) changes.emplace_back(axes[k].key, chosen[k]);
  const YAML::Node node = load_yaml(scene);
  double latency_ms = -1;
  sim::Scene made;
  try {
    for (const auto& [key, value] : changes) {
      if (key == "latency_ms")
        latency_ms = std::strtod(value.c_str(), nullptr);
      else
        put(node, key, value);
    }
    read_fields(node, file + ", in the scene", made);
  } catch (const YAML::Exception& e) {
    throw ConfigError(fmt::format("{}: a value is no YAML: {}", file, e.msg));
  }
  const auto folder = std::filesystem::path(scene).parent_path();
  made.folder = folder.empty() ? "." : folder.string();
  if (latency_ms >= 0) made.loop.latency.set_total(1e-3 * latency_ms);
  sim::require_valid(made, file);
  return made;
}

SweepPlan read_sweep(const std::string& given) {
  SweepPlan plan;
  plan.file = shipped(given);
  const YAML::Node root = load_yaml(plan.file);
  const std::vector<std::string> known{"title", "scene", "set", "axes", "metrics"};
  for (const auto& entry : root)
    if (const std::string key = entry.first.Scalar(); std::find(known.begin(), known.end(), key) == known.end())
      throw ConfigError(fmt::format("{}:{}: unknown key '{}'{}", plan.file, entry.first.Mark().line + 1, key,
                                    did_you_mean(key, known)));
  const auto fail = [&](const std::string& what) { throw ConfigError(fmt::format("{}: {}", plan.file, what)); };
  if (root["title"]) plan.title = root["title"].as<std::string>("");
  if (!root["scene"] || !root["scene"].IsScalar()) fail("scene is missing: the scene file that is run");
  const std::filesystem::path scene = root["scene"].Scalar();
  plan.scene = scene.is_absolute()
                   ? scene.string()
                   : (std::filesystem::path(plan.file).parent_path() / scene).lexically_normal().string();
  if (root["set"] && !root["set"].IsMap()) fail("set must be a group of keys");
  for (const auto& entry : root["set"]) plan.set.emplace_back(entry.first.Scalar(), text_of(entry.second));
  if (!root["axes"] || !root["axes"].IsMap() || root["axes"].size() == 0)
    fail("axes is missing: keys of the scene, each with a list of values or a range {from, to}");
  for (const auto& entry : root["axes"]) {
    SweepAxis axis{entry.first.Scalar(), {}, true};
    const std::string where = fmt::format("{}:{}: axis {}", plan.file, entry.first.Mark().line + 1, axis.key);
    if (entry.second.IsSequence())
      for (const auto& value : entry.second) axis.values.push_back(text_of(value));
    else if (entry.second.IsMap())
      axis.values = range_of(entry.second, where);
    else
      axis.values = {text_of(entry.second)};
    if (axis.values.empty()) throw ConfigError(where + " has no values, so that there is nothing to run");
    for (const auto& other : plan.axes)
      if (other.key == axis.key) throw ConfigError(where + " is given twice");
    axis.numeric = std::all_of(axis.values.begin(), axis.values.end(), is_number);
    if (axis.key == "latency_ms" && !axis.numeric) throw ConfigError(where + " must have numbers");
    plan.axes.push_back(std::move(axis));
  }
  plan.metrics = kMetrics;
  if (root["metrics"]) {
    if (!root["metrics"].IsSequence() || root["metrics"].size() == 0)
      fail("metrics must be a list of keys of summary.json");
    plan.metrics.clear();
    for (const auto& metric : root["metrics"]) plan.metrics.push_back(metric.as<std::string>(""));
  }
  // every value of every axis must make a good scene beside the first of the others
  std::uint64_t stride = plan.runs();
  for (const auto& axis : plan.axes) {
    stride /= axis.values.size();
    const std::size_t step = std::max<std::size_t>(1, axis.values.size() / 200);
    for (std::size_t i = 0; i < axis.values.size(); i += step) (void)plan.scene_of(i * stride);
  }
  return plan;
}

}  // namespace heartservo::tools
