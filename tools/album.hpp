#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tools/report/report.hpp"

namespace heartservo::tools {

/// Pictures of a run that are worth a look: its start, its middle, its worst moment, and the first frame in which the
/// region was lost.
class Album {
 public:
  struct Moment {
    std::size_t index = 0;  ///< of the frame, from 0
    double time_s = 0;
    double badness = NAN;    ///< the worst moment has the largest; NaN: cannot be it
    std::string worst = {};  ///< whose badness it is, with a blank at the end, where several run side by side
    bool lost = false;
    std::string loser = {};  ///< the same of the loss
  };

  /// `expected_frames`: 0 where nobody knows; then there is no middle. `badness_text` says what it was: "3.2 px off".
  Album(std::size_t expected_frames, std::function<std::string(double)> badness_text)
      : expected_(expected_frames), badness_text_(std::move(badness_text)) {}

  /// Show it every frame that can be drawn. `draw` is called only for those that are kept; its caption is set here.
  void look_at(const Moment& moment, const std::function<ReportPicture()>& draw);

  /// In the order start, middle, worst, first lost; a frame that is several of them comes once.
  std::vector<ReportPicture> pictures() const;

 private:
  struct Kept {
    Moment moment;
    ReportPicture picture;
  };

  std::size_t expected_;
  std::function<std::string(double)> badness_text_;
  std::optional<Kept> start_, middle_, worst_, first_lost_;
};

}  // namespace heartservo::tools
