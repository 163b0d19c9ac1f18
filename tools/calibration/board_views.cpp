#include "tools/calibration/board_views.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "tools/progress.hpp"
#include "tracking/camera/calibration/board_detection.hpp"
#include "tracking/camera/calibration/corner_list.hpp"
#include "tracking/frames/image_folder.hpp"
#include "tracking/frames/picture_file.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tools {

namespace fs = std::filesystem;
using tracking::Board;
using tracking::BoardKind;
using tracking::BoardPosition;

namespace {

// Folders become the files in them, in natural order: pictures, or all files where corner lists are wanted.
std::vector<std::string> files_of(const std::vector<std::string>& paths, bool lists) {
  std::vector<std::string> files;
  for (const auto& path : paths) {
    std::error_code error;
    if (!fs::exists(path, error)) throw InputError(path + ": no such file or folder; check the path");
    if (!fs::is_directory(path, error)) {
      files.push_back(path);
      continue;
    }
    std::vector<std::string> inside;
    for (fs::directory_iterator entry(path, error), end; !error && entry != end; entry.increment(error)) {
      const std::string name = entry->path().filename().string();
      const bool wanted = lists ? entry->path().extension() == ".txt" || entry->path().extension() == ".csv"
                                : tracking::has_picture_name(name);
      if (name[0] != '.' && wanted) inside.push_back(entry->path().string());
    }
    if (error) throw InputError(path + ": the folder cannot be read; check its permissions");
    if (inside.empty())
      throw InputError(
          fmt::format("{}: the folder holds no {}", path,
                      lists ? "corner lists (.txt, .csv)" : "pictures (" + tracking::picture_names() + ")"));
    std::sort(inside.begin(), inside.end(), tracking::natural_less);
    files.insert(files.end(), inside.begin(), inside.end());
  }
  return files;
}

class Collector {
 public:
  Collector(const Board& board, const ViewSources& sources, BoardViews& views)
      : sources_(sources), views_(views), progress_("calibrate", views.given, sources.quiet) {
    views_.board = board;
    views_.width = sources.width;
    views_.height = sources.height;
  }

  // Empty where there is no board, with the reason among the skipped.
  tracking::Corners corners_of(const std::string& file) {
    tracking::Corners corners =
        sources_.are_lists ? tracking::read_corner_list(file, views_.board, views_.width, views_.height) : detect(file);
    progress_.update(++done_);
    return corners;
  }

  // The circles' size, as the pictures show it.
  void finish() {
    progress_.finish();
    if (views_.board.disc_m > 0 || ratios_.empty()) return;
    const auto middle = ratios_.begin() + static_cast<std::ptrdiff_t>(ratios_.size() / 2);
    std::nth_element(ratios_.begin(), middle, ratios_.end());
    views_.board.disc_m = *middle * views_.board.pitch_m;
  }

 private:
  tracking::Corners detect(const std::string& file) {
    const auto picture = tracking::read_picture(file);
    if (!picture.problem.empty()) return skip(file, without(picture.problem, file + ": "));
    const cv::Mat& grey = picture.grey;
    if (views_.width == 0) {
      views_.width = grey.cols;
      views_.height = grey.rows;
    }
    if (grey.cols != views_.width || grey.rows != views_.height)
      return skip(file, fmt::format("is {} x {} px, the pictures before it {} x {}", grey.cols, grey.rows, views_.width,
                                    views_.height));
    auto found = tracking::detect_board(grey, views_.board);
    if (!found.problem.empty()) return skip(file, found.problem);
    if (found.disc_ratio > 0) ratios_.push_back(found.disc_ratio);
    return found.corners;
  }

  static std::string without(const std::string& text, const std::string& head) {
    return text.rfind(head, 0) == 0 ? text.substr(head.size()) : text;
  }

  tracking::Corners skip(const std::string& file, const std::string& reason) {
    views_.skipped.push_back({file, reason});
    return {};
  }

  const ViewSources& sources_;
  BoardViews& views_;
  Progress progress_;
  std::size_t done_ = 0;
  std::vector<double> ratios_;
};

// Left and right detectors may have numbered the board from other ends; lists must not.
void align(const Board& board, BoardPosition& position, bool are_lists) {
  if (position.corners[0].empty() || position.corners[1].empty()) return;
  const std::size_t order = tracking::order_like(board, position.corners[1], position.corners[0]);
  if (order == 0) return;
  if (are_lists)
    throw InputError(fmt::format("{}: begins at another corner of the board than {}; number both alike",
                                 position.names[1], position.names[0]));
  position.corners[1] = tracking::reordered(position.corners[1], tracking::same_looking_orders(board)[order]);
}

// Those who count squares give one too many each way.
std::string counting_hint(const Board& board, const std::vector<std::string>& files) {
  if (board.kind != BoardKind::CHESSBOARD || board.columns < 4 || board.rows < 4) return "";
  Board smaller = board;
  --smaller.columns;
  --smaller.rows;
  for (std::size_t i = 0; i < std::min<std::size_t>(3, files.size()); ++i) {
    const auto picture = tracking::read_picture(files[i]);
    if (!picture.problem.empty() || !tracking::detect_board(picture.grey, smaller).problem.empty()) continue;
    return fmt::format("; {} shows one of {} x {}: count inner corners, not squares", files[i], smaller.columns,
                       smaller.rows);
  }
  return "";
}

}  // namespace

BoardViews collect_views(const Board& board, const ViewSources& sources) {
  const auto left = files_of(sources.left, sources.are_lists), right = files_of(sources.right, sources.are_lists);
  if (!right.empty() && left.size() != right.size())
    throw ConfigError(fmt::format("--right has {} views and the left side {}; they are taken in pairs, in order",
                                  right.size(), left.size()));
  BoardViews views;
  views.sides = right.empty() ? 1 : 2;
  views.given = left.size() + right.size();
  Collector collector(board, sources, views);
  for (std::size_t i = 0; i < left.size(); ++i) {
    BoardPosition position;
    position.names = {left[i], right.empty() ? "" : right[i]};
    position.corners[0] = collector.corners_of(left[i]);
    if (!right.empty()) position.corners[1] = collector.corners_of(right[i]);
    align(board, position, sources.are_lists);
    if (!position.corners[0].empty() || !position.corners[1].empty()) views.positions.push_back(std::move(position));
  }
  collector.finish();
  if (views.positions.empty()) {
    const std::string others = views.given == 1   ? ""
                               : views.given == 2 ? "; nor does the other view help"
                                                  : fmt::format("; nor do the other {} views help", views.given - 1);
    throw InputError(
        fmt::format("{}: {}{}{}", views.skipped[0].name, views.skipped[0].reason, others, counting_hint(board, left)));
  }
  return views;
}

}  // namespace heartservo::tools
