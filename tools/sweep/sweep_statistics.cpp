#include "tools/sweep/sweep_statistics.hpp"

#include <algorithm>
#include <cmath>
#include <random>

namespace heartservo::tools {

namespace {

using nlohmann::json;

constexpr int kResamples = 2000;

double median_of(std::vector<double>& v) {
  const auto middle = v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2);
  std::nth_element(v.begin(), middle, v.end());
  if (v.size() % 2 == 1) return *middle;
  return 0.5 * (*middle + *std::max_element(v.begin(), middle));
}

json json_of(const Interval& i) { return {{"median", i.median}, {"low", i.low}, {"high", i.high}, {"runs", i.count}}; }

// The values of all axes but the seed, as a key.
std::vector<std::string> key_of(const SweepPlan& plan, std::uint64_t run, const std::string& without = "") {
  std::vector<std::string> key = plan.values(run);
  for (std::size_t k = 0; k < key.size(); ++k)
    if (plan.axes[k].key == "seed" || plan.axes[k].key == without) key[k].clear();
  return key;
}

std::string seed_of(const SweepPlan& plan, std::uint64_t run) {
  const auto values = plan.values(run);
  for (std::size_t k = 0; k < values.size(); ++k)
    if (plan.axes[k].key == "seed") return values[k];
  return "";
}

}  // namespace

Interval median_interval(std::vector<double> values, std::uint64_t seed) {
  std::erase_if(values, [](double v) { return !std::isfinite(v); });
  Interval result;
  result.count = values.size();
  if (values.empty()) return result;
  std::vector<double> sample = values, medians;
  result.median = median_of(sample);
  std::mt19937_64 random(seed);
  std::uniform_int_distribution<std::size_t> pick(0, values.size() - 1);
  for (int i = 0; i < kResamples; ++i) {
    for (double& v : sample) v = values[pick(random)];
    medians.push_back(median_of(sample));
  }
  std::sort(medians.begin(), medians.end());
  result.low = medians[static_cast<std::size_t>(0.025 * kResamples)];
  result.high = medians[static_cast<std::size_t>(0.975 * kResamples) - 1];
  return result;
}

json sweep_statistics(const SweepPlan& plan, const std::map<std::uint64_t, SweepResult>& results) {
  std::map<std::vector<std::string>, std::vector<const SweepResult*>> groups;
  std::vector<std::vector<std::string>> order;
  for (const auto& [run, result] : results) {
    const auto key = key_of(plan, run);
    if (!groups.contains(key)) order.push_back(key);
    groups[key].push_back(&result);
  }
  json j{{"groups", json::array()}, {"pairs", json::array()}};
  for (const auto& key : order) {
    json group{{"values", json::object()}, {"runs", groups[key].size()}};
    for (std::size_t k = 0; k < key.size(); ++k)
      if (plan.axes[k].key != "seed") group["values"][plan.axes[k].key] = key[k];
    for (const char* status : {"done", "stopped", "failed"})
      group[status] = std::count_if(groups[key].begin(), groups[key].end(),
                                    [&](const SweepResult* r) { return r->status == status; });
    for (std::size_t m = 0; m < plan.metrics.size(); ++m) {
      std::vector<double> values;
      for (const auto* r : groups[key])
        if (r->status != "failed") values.push_back(r->metrics[m]);
      group["metrics"][plan.metrics[m]] = json_of(median_interval(values));
    }
    j["groups"].push_back(group);
  }
  for (std::size_t k = 0; k < plan.axes.size(); ++k) {
    const SweepAxis& axis = plan.axes[k];
    if (axis.numeric) continue;
    std::map<std::vector<std::string>, std::map<std::string, std::map<std::string, double>>> by;  // others, value, seed
    for (const auto& [run, r] : results)
      if (r.status != "failed" && std::isfinite(r.metrics[0]))
        by[key_of(plan, run, axis.key)][plan.values(run)[k]][seed_of(plan, run)] = r.metrics[0];
    for (auto& [others, settings] : by)
      for (std::size_t a = 0; a < axis.values.size(); ++a)
        for (std::size_t b = a + 1; b < axis.values.size(); ++b) {
          std::vector<double> differences;
          int less = 0;
          for (const auto& [seed, value] : settings[axis.values[a]])
            if (const auto other = settings[axis.values[b]].find(seed); other != settings[axis.values[b]].end()) {
              differences.push_back(value - other->second);
              less += value < other->second;
            }
          if (differences.size() < 2) continue;
          const Interval i = median_interval(differences);
          json pair{{"axis", axis.key},
                    {"a", axis.values[a]},
                    {"b", axis.values[b]},
                    {"others", json::object()},
                    {"metric", plan.metrics[0]},
                    {"seeds", i.count},
                    {"median_difference", i.median},
                    {"low", i.low},
                    {"high", i.high},
                    {"a_is_less", less / static_cast<double>(i.count)}};
          for (std::size_t o = 0; o < others.size(); ++o)
            if (o != k && plan.axes[o].key != "seed") pair["others"][plan.axes[o].key] = others[o];
          j["pairs"].push_back(pair);
        }
  }
  return j;
}

}  // namespace heartservo::tools
