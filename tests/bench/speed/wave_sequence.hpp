#pragma once
// Frames of twelve waves under a motion like the comparison's sequence b: a circle of radius 30 px, rotation +-20 degrees,
// scale +-10 %, perspective 2e-4 and 1.5e-4 per px, noise of 1 grey level.
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <random>
#include <vector>

#include "tests/bench/speed/machine_limit.hpp"
#include "tracking/frames/frame.hpp"
#include "tracking/planar/registry.hpp"

namespace heartservo::bench {

inline constexpr int kSide = 512, kFrames = 100;

struct WaveSequence {
  std::vector<tracking::Frame> frames;
  std::vector<Eigen::Matrix3d> H;
};

inline Eigen::Matrix3d wave_motion(int k) {
  const double t = 2 * M_PI * k, angle = 20 * M_PI / 180 * std::sin(t / 80), scale = 1 + 0.1 * std::sin(t / 67);
  Eigen::Matrix3d H, centred = Eigen::Matrix3d::Identity();
  H << scale * std::cos(angle), -scale * std::sin(angle), 30 * std::sin(t / 100), scale * std::sin(angle),
      scale * std::cos(angle), 30 - 30 * std::cos(t / 100), 2e-4 * std::sin(t / 90), 1.5e-4 * std::sin(t / 60), 1;
  centred(0, 2) = centred(1, 2) = kSide / 2.0;
  return centred * H * centred.inverse();
}

// Twelve waves of 12 to 60 px in as many directions: no second place looks like the region, as it would with fewer.
inline cv::Mat wave_picture(const Eigen::Matrix3d& H) {
  struct Wave {
    double x, y, phase;
  };
  static const std::vector<Wave> waves = [] {
    std::mt19937_64 random(11);
    std::uniform_real_distribution<double> uniform(0, 1);
    std::vector<Wave> result;
    for (int i = 0; i < 12; ++i) {
      const double w = 2 * M_PI / (12 * std::pow(5, uniform(random))), direction = 2 * M_PI * uniform(random);
      result.push_back({w * std::cos(direction), w * std::sin(direction), 2 * M_PI * uniform(random)});
    }
    return result;
  }();
  cv::Mat image(kSide, kSide, CV_32FC1);
  const Eigen::Matrix3d H_inverse = H.inverse();
  for (int v = 0; v < kSide; ++v)
    for (int u = 0; u < kSide; ++u) {
      const Eigen::Vector2d p = (H_inverse * Eigen::Vector3d(u, v, 1)).hnormalized();
      double grey = 128;
      for (const Wave& wave : waves) grey += 16 * std::sin(wave.x * p.x() + wave.y * p.y() + wave.phase);
      image.at<float>(v, u) = static_cast<float>(grey);
    }
  return image;
}

inline const WaveSequence& wave_sequence() {
  static const WaveSequence result = [] {
    WaveSequence s;
    std::mt19937_64 random(7);
    std::normal_distribution<float> noise(0, 1);
    for (int k = 0; k < kFrames; ++k) {
      s.H.push_back(wave_motion(k));
      s.frames.emplace_back();
      cv::Mat_<float> grey = wave_picture(s.H.back());
      for (float& v : grey) v += noise(random);
      grey.convertTo(s.frames.back().grey, CV_8U);
    }
    return s;
  }();
  return result;
}

/// A tracker on its way through the sequence, there and back. `seconds`: CPU time of the process in track().
class Walk {
 public:
  Walk(const std::string& name, double side)
      : Walk(tracking::trackers().make(name, tracking::Camera{}, tracking::TrackerOptions{}), side) {}
  Walk(std::unique_ptr<tracking::TargetTracker> tracker, double side)
      : tracker_(std::move(tracker)),
        region_(tracking::rectangle((kSide - side) / 2, (kSide - side) / 2, side, side)) {
    tracker_->start(wave_sequence().frames[0], region_);
  }

  void step() {
    ++k_;
    const int phase = k_ % (2 * kFrames - 2);
    const auto at = static_cast<std::size_t>(phase < kFrames ? phase : 2 * kFrames - 2 - phase);
    tracking::Frame frame = wave_sequence().frames[at];
    frame.time_s = 0.008 * k_;
    const double begin = cpu_s();
    const tracking::Track track = tracker_->track(frame);
    seconds.push_back(cpu_s() - begin);
    if (track.state == tracking::TrackState::LOST) {
      ++lost;
      return;
    }
    const tracking::Quad truth = tracking::transform(wave_sequence().H[at], region_);
    for (std::size_t i = 0; i < 4; ++i) error_px += (track.corners[i] - truth[i]).norm() / 4;
    ++followed;
  }

  double mean_s() const {
    double sum = 0;
    for (const double s : seconds) sum += s;
    return sum / static_cast<double>(seconds.size());
  }
  double mean_error_px() const { return error_px / std::max(1.0, followed); }

  std::vector<double> seconds;
  double error_px = 0, lost = 0, followed = 0;

 private:
  std::unique_ptr<tracking::TargetTracker> tracker_;
  tracking::Quad region_;
  int k_ = 0;
};

}  // namespace heartservo::bench
