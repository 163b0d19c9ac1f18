#include <algorithm>
#include <cctype>
#include <numeric>

#include "tracking/settings/yaml_reader.hpp"

namespace heartservo {

namespace {

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

// Letters inserted, left out, changed, or swapped with their neighbour (optimal string alignment distance).
int edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::vector<int>> d(a.size() + 1, std::vector<int>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) d[i][0] = static_cast<int>(i);
  std::iota(d[0].begin(), d[0].end(), 0);
  for (std::size_t i = 1; i <= a.size(); ++i)
    for (std::size_t j = 1; j <= b.size(); ++j) {
      d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
    }
  return d[a.size()][b.size()];
}

}  // namespace

std::string nearest_name(const std::string& word, const std::vector<std::string>& names) {
  std::string best;
  const std::string typed = lower(word);
  // two letters of three would suggest anything
  int best_distance = (word.size() <= 3 ? 1 : std::max(2, static_cast<int>(word.size()) / 3)) + 1;
  for (const auto& name : names) {
    const bool prefix = word.size() >= 3 && lower(name).compare(0, typed.size(), typed) == 0;
    const int distance = prefix ? 1 : edit_distance(typed, lower(name));
    if (distance < best_distance && distance < static_cast<int>(std::max(typed.size(), name.size()))) {
      best_distance = distance;
      best = name;
    }
  }
  return best;
}

std::string did_you_mean(const std::string& word, const std::vector<std::string>& names) {
  const std::string name = nearest_name(word, names);
  return name.empty() ? "" : " (did you mean '" + name + "'?)";
}

}  // namespace heartservo
