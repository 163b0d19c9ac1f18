#include "tools/track_pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "tools/overlay.hpp"
#include "tracking/frames/frame.hpp"

namespace heartservo::tools {

namespace {

constexpr int kTrajectoryWidth_px = 900;  // as drawn; a small part of a frame is enlarged to about this

struct Path {
  std::vector<Eigen::Vector2d> px;  // NaN: a gap
};

Path path_of(const TimeTable& table, const std::string& group) {
  const auto u = table.column(group + "/u_px"), v = table.column(group + "/v_px");
  Path path;
  for (std::size_t i = 0; i < u.size(); ++i) path.px.emplace_back(u[i], v[i]);
  return path;
}

std::string label_of(const std::vector<TrackLane>& lanes, std::size_t i) {
  return lanes[i].name() + (series_width(i) < series_width(0) ? " (thin)" : "");
}

std::string centre_group(const TrackLane& lane) { return lane.table().has("point/u_px") ? "point" : "target"; }

// Of all paths, with a margin, within the picture.
cv::Rect covered(const std::vector<Path>& paths, cv::Size picture) {
  Eigen::Vector2d low = Eigen::Vector2d::Constant(INFINITY), high = -low;
  for (const auto& path : paths)
    for (const auto& p : path.px)
      if (p.allFinite()) low = low.cwiseMin(p), high = high.cwiseMax(p);
  const cv::Rect whole({0, 0}, picture);
  if (!low.allFinite()) return whole;
  const double margin = 20 + 0.1 * (high - low).maxCoeff();
  low.array() -= margin, high.array() += margin;
  const auto px = [](double v) { return static_cast<int>(std::clamp(v, -1e5, 1e5)); };
  const cv::Rect part = cv::Rect({px(low.x()), px(low.y())}, cv::Point(px(high.x()), px(high.y()))) & whole;
  return part.area() > 0 ? part : whole;
}

void draw_path(cv::Mat& bgr, const Path& path, const cv::Rect& part, int scale, const cv::Scalar& colour, int width) {
  constexpr int kShift = 4;
  const auto fixed = [&](const Eigen::Vector2d& p) {
    const double u = (p.x() - part.x + 0.5) * scale - 0.5, v = (p.y() - part.y + 0.5) * scale - 0.5;
    return cv::Point(static_cast<int>(std::lround(u * (1 << kShift))),
                     static_cast<int>(std::lround(v * (1 << kShift))));
  };
  const auto drawable = [](const Eigen::Vector2d& p) { return p.allFinite() && p.cwiseAbs().maxCoeff() < 1e4; };
  for (std::size_t i = 1; i < path.px.size(); ++i)
    if (drawable(path.px[i - 1]) && drawable(path.px[i]))
      cv::line(bgr, fixed(path.px[i - 1]), fixed(path.px[i]), colour, width, cv::LINE_AA, kShift);
}

// How bad a frame is for a lane: its error, or without truth what its quality lacks. NaN where it is LOST.
double badness_of(const TrackLane& lane, const TruthKind& truth) {
  if (truth.corners) return lane.errors().corners_px;
  if (truth.point) return lane.errors().point_px;
  return lane.track().state == tracking::TrackState::LOST ? NAN : 1 - lane.track().quality;
}

Album::Moment moment_of(const std::vector<TrackLane>& lanes, const TruthKind& truth, std::size_t index, double time_s) {
  Album::Moment moment;
  moment.index = index;
  moment.time_s = time_s;
  const auto name = [&](const TrackLane& lane) { return lanes.size() > 1 ? lane.name() + " " : ""; };
  for (const auto& lane : lanes) {
    const double badness = badness_of(lane, truth);
    if (!std::isnan(badness) && !(badness <= moment.badness)) moment.badness = badness, moment.worst = name(lane);
    if (!moment.lost && lane.track().state == tracking::TrackState::LOST) moment.lost = true, moment.loser = name(lane);
  }
  return moment;
}

ReportPicture overlay_picture(const tracking::Frame& frame, std::vector<TrackLane>& lanes, const Eigen::Vector2d& point,
                              const std::string& point_name) {
  ReportPicture picture{"", canvas_of(frame), {}};
  cv::Mat mask;
  lanes.front().mark_left_out(mask);
  const bool tinted = tint_left_out(picture.bgr, mask);
  for (std::size_t i = lanes.size(); i-- > 0;) {  // the first lies on top
    const tracking::Track& track = lanes[i].track();
    if (lanes.size() == 1)
      draw_region(picture.bgr, track);
    else
      draw_region(picture.bgr, track, series_colour(i), series_width(i));
  }
  if (lanes.size() == 1) picture.keys.push_back(region_key(lanes[0].track()));
  for (std::size_t i = 0; i < lanes.size() && lanes.size() > 1; ++i) {
    const bool lost = lanes[i].track().state == tracking::TrackState::LOST;
    picture.keys.push_back({label_of(lanes, i) + (lost ? ": LOST" : ""), series_colour(i),
                            lost ? PictureKey::Mark::DASHES : PictureKey::Mark::LINE});
  }
  if (draw_point(picture.bgr, point))
    picture.keys.push_back(point_key(point_name == "target" ? "true centre" : "annotated point " + point_name));
  if (tinted) {
    picture.keys.push_back(left_out_key());
    if (lanes.size() > 1) picture.keys.back().label = lanes.front().name() + " " + picture.keys.back().label;
  }
  return picture;
}

ReportPicture trajectory_picture(const cv::Mat& first_bgr, const std::vector<TrackLane>& lanes) {
  std::vector<Path> paths;
  for (const auto& lane : lanes) paths.push_back(path_of(lane.table(), centre_group(lane)));
  const bool known = lanes.front().table().has("truth/point/u_px");
  if (known) paths.push_back(path_of(lanes.front().table(), "truth/point"));
  const cv::Rect part = covered(paths, first_bgr.size());
  const int scale = std::clamp(kTrajectoryWidth_px / part.width, 1, 8);
  cv::Mat grey;
  cv::cvtColor(first_bgr(part), grey, cv::COLOR_BGR2GRAY);
  grey.convertTo(grey, -1, 0.5, 100);  // pale, so that the lines stand out
  ReportPicture picture{"Trajectories in the picture, over the first frame", {}, {}};
  cv::resize(grey, grey, {}, scale, scale, cv::INTER_CUBIC);
  cv::cvtColor(grey, picture.bgr, cv::COLOR_GRAY2BGR);
  const cv::Scalar truth(255, 255, 255);
  if (known) {
    draw_path(picture.bgr, paths.back(), part, scale, truth, 9);
    picture.keys.push_back({"truth", truth});
  }
  for (std::size_t i = lanes.size(); i-- > 0;)
    draw_path(picture.bgr, paths[i], part, scale, series_colour(i), series_width(i));
  for (std::size_t i = 0; i < lanes.size(); ++i) picture.keys.push_back({label_of(lanes, i), series_colour(i)});
  return picture;
}

}  // namespace

TrackAlbum::TrackAlbum(std::size_t expected_frames, TruthKind truth, const tracking::Frame& first)
    : truth_(std::move(truth)),
      first_bgr_(canvas_of(first)),
      album_(expected_frames, [known = truth_.corners || truth_.point](double badness) {
        return known ? fmt::format("{:.2f} px off", badness) : fmt::format("quality {:.2f}", 1 - badness);
      }) {}

void TrackAlbum::look_at(const tracking::Frame& frame, std::vector<TrackLane>& lanes, const TrackTruth& truth) {
  const std::size_t index = count_++;
  if (frame.status != tracking::FrameStatus::OK) return;
  album_.look_at(moment_of(lanes, truth_, index, frame.time_s),
                 [&] { return overlay_picture(frame, lanes, truth.point, truth_.point.value_or("")); });
}

std::vector<ReportPicture> TrackAlbum::pictures(const std::vector<TrackLane>& lanes) const {
  auto pictures = album_.pictures();
  pictures.insert(pictures.begin() + std::min<std::ptrdiff_t>(1, std::ssize(pictures)),
                  trajectory_picture(first_bgr_, lanes));
  return pictures;
}

}  // namespace heartservo::tools
