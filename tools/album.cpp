#include "tools/album.hpp"

#include <fmt/format.h>

#include <cmath>

namespace heartservo::tools {

void Album::look_at(const Moment& moment, const std::function<ReportPicture()>& draw) {
  std::vector<std::optional<Kept>*> places;
  if (!start_) places.push_back(&start_);
  if (!middle_ && expected_ > 0 && moment.index >= expected_ / 2) places.push_back(&middle_);
  if (!std::isnan(moment.badness) && (!worst_ || moment.badness > worst_->moment.badness)) places.push_back(&worst_);
  if (!first_lost_ && moment.lost) places.push_back(&first_lost_);
  if (places.empty()) return;
  const Kept kept{moment, draw()};
  for (auto* place : places) *place = kept;
}

std::vector<ReportPicture> Album::pictures() const {
  std::vector<ReportPicture> result;
  std::vector<std::size_t> shown;
  const auto add = [&](const std::optional<Kept>& kept, const std::string& what) {
    if (!kept) return;
    for (std::size_t i = 0; i < shown.size(); ++i)
      if (shown[i] == kept->moment.index) {
        result[i].caption += ", " + what;
        return;
      }
    shown.push_back(kept->moment.index);
    result.push_back(kept->picture);
    result.back().caption = fmt::format("{:.2f} s: {}", kept->moment.time_s, what);
  };
  add(start_, "start");
  add(middle_, "middle");
  if (worst_) add(worst_, "worst moment, " + worst_->moment.worst + badness_text_(worst_->moment.badness));
  if (first_lost_) add(first_lost_, first_lost_->moment.loser + "lost for the first time");
  return result;
}

}  // namespace heartservo::tools
