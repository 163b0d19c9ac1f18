#pragma once
// The simulated endoscope's pictures of a landmark at any pose, and the bound on what they tell about that pose.
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <memory>
#include <opencv2/imgproc.hpp>

#include "sim/endoscope/endoscope.hpp"
#include "sim/endoscope/painted_pattern.hpp"
#include "tracking/camera/camera.hpp"

namespace heartservo::test {

/// A 5 mm landmark on the middle of the tissue. Pictures under the scene's own light: xenon, vignetting, speculars.
class PosedLandmark {
 public:
  static constexpr double kSide_m = 0.005;

  explicit PosedLandmark(const tracking::Camera& camera)
      : camera_(camera),
        texture_(std::make_shared<const sim::TissueTexture>(
            sim::TissueTexture::procedural({}, {{.side_m = kSide_m}}, 11))) {}

  /// CV_8UC1; noise is drawn from the seed.
  cv::Mat picture(const Eigen::Isometry3d& T_camera_landmark, double noise_grey, std::uint64_t seed,
                  double bias_grey = 4) const {
    sim::HeartMotionOptions motion;
    motion.profile = "rail";
    motion.rail.travel_m = 0;
    const Eigen::AngleAxisd turn(Eigen::Matrix3d(T_camera_landmark.linear()));
    motion.rail.turn_rad = turn.angle() * turn.axis();
    sim::HeartSurfaceOptions surface;
    surface.anchor_m = T_camera_landmark.translation();
    surface.landmarks = {{.side_m = kSide_m}};
    sim::PictureOptions options;
    options.noise_grey = noise_grey;
    options.bias_grey = bias_grey;
    sim::Endoscope endoscope(camera_, sim::HeartSurface(surface, sim::HeartMotion(motion, 1, 1), 1), options, seed, {},
                             texture_);
    cv::Mat grey;
    endoscope.render(0, 0, grey);
    return grey;
  }

 private:
  tracking::Camera camera_;
  std::shared_ptr<const sim::TissueTexture> texture_;
};

/// The Cramer-Rao bound on the pose of that landmark, from a model of its own: the painted pattern, blurred as the
/// texture and its interpolation do it, seen by the exact ray of each pixel; derivatives by central differences in the
/// pose. Gain and bias are unknown too. Only pixels whose ray meets the plate count.
class PoseBound {
 public:
  explicit PoseBound(const tracking::Camera& camera) : camera_(camera) {
    cv::Mat sharp(kSize, kSize, CV_32FC1);
    for (int j = 0; j < kSize; ++j)
      for (int i = 0; i < kSize; ++i)
        sharp.at<float>(j, i) =
            static_cast<float>(sim::painted_pattern(0, (2 * i + 1.0) / kSize - 1, (2 * j + 1.0) / kSize - 1));
    const double sigma = kBlur_m / (PosedLandmark::kSide_m / kSize);
    cv::GaussianBlur(sharp, plate_, {}, sigma, sigma, cv::BORDER_REPLICATE);
  }

  struct Result {
    Eigen::Matrix<double, 6, 6> covariance;  ///< of the twist (v in m, w in rad; camera frame)
    double misfit_grey;                      ///< of the model to a picture without noise
    int pixels;
  };

  /// `clean`: the picture without noise, for gain and bias, and to check the model.
  Result at(const Eigen::Isometry3d& T, const cv::Mat& clean, double sigma_grey) const {
    std::vector<Eigen::Vector3d> rays;
    std::vector<double> seen;
    const Eigen::Vector2d centre = camera_.project(T.translation());
    for (int v = std::max(0, int(centre.y()) - 60); v < std::min(camera_.height, int(centre.y()) + 60); ++v)
      for (int u = std::max(0, int(centre.x()) - 60); u < std::min(camera_.width, int(centre.x()) + 60); ++u) {
        const Eigen::Vector3d ray = camera_.normalise({u, v}).homogeneous();
        if (!(on_plate(T, ray).cwiseAbs().maxCoeff() < 0.99)) continue;
        rays.push_back(ray);
        seen.push_back(clean.at<std::uint8_t>(v, u));
      }
    const auto n = static_cast<Eigen::Index>(rays.size());
    Eigen::MatrixXd J(n, 8), light(n, 2);
    light.col(0) = greys(T, rays);
    light.col(1).setOnes();
    const Eigen::VectorXd picture = Eigen::Map<const Eigen::VectorXd>(seen.data(), n);
    const Eigen::Vector2d gain = (light.transpose() * light).inverse() * (light.transpose() * picture);
    for (int k = 0; k < 6; ++k) {
      const double step = k < 2 ? 5e-6 : k == 2 ? 5e-5 : 2e-3;
      J.col(k) = gain(0) * (greys(moved(T, k, step), rays) - greys(moved(T, k, -step), rays)) / (2 * step);
    }
    J.rightCols<2>() = light;
    const Eigen::VectorXd scale = J.colwise().norm().cwiseInverse();
    const Eigen::MatrixXd scaled = J * scale.asDiagonal(), information = scaled.transpose() * scaled;
    const Eigen::MatrixXd covariance = scale.asDiagonal() * information.inverse() * scale.asDiagonal();
    // rounding to whole levels is noise too
    return {(sigma_grey * sigma_grey + 1.0 / 12) * covariance.topLeftCorner<6, 6>(),
            misfit(picture, light.col(0), rays), static_cast<int>(n)};
  }

 private:
  // Under light that is quadratic over the plate: the endoscope's falls off, and that is not what the check is about.
  static double misfit(const Eigen::VectorXd& picture, const Eigen::VectorXd& grey,
                       const std::vector<Eigen::Vector3d>& rays) {
    const auto n = picture.size();
    Eigen::MatrixXd model(n, 7);
    for (Eigen::Index i = 0; i < n; ++i) {
      const Eigen::Vector2d d = 20 * (rays[static_cast<std::size_t>(i)] - rays[static_cast<std::size_t>(n / 2)]).head<2>();
      model.row(i) << 1, grey(i), grey(i) * d.x(), grey(i) * d.y(), grey(i) * d.x() * d.x(), grey(i) * d.x() * d.y(),
          grey(i) * d.y() * d.y();
    }
    const Eigen::MatrixXd information = model.transpose() * model;
    const Eigen::VectorXd best = information.inverse() * (model.transpose() * picture);
    return (picture - model * best).norm() / std::sqrt(static_cast<double>(n));
  }

  static constexpr int kSize = 1024;
  /// Texture's blur of 0.047 mm; painting by means over a texel and reading between texels add its side squared times
  /// (1 / 12)(1 - 1 / 9) and 1 / 6 to the variance.
  static constexpr double kTexel_m = 0.08 / 2048;
  inline static const double kBlur_m = std::sqrt(0.047e-3 * 0.047e-3 + kTexel_m * kTexel_m * (8 / 108.0 + 1 / 6.0));

  static Eigen::Isometry3d moved(const Eigen::Isometry3d& T, int parameter, double step) {
    Eigen::Isometry3d result = T;
    if (parameter < 3)
      result.translation()(parameter) += step;
    else
      result.linear() = Eigen::AngleAxisd(step, Eigen::Vector3d::Unit(parameter - 3)) * T.linear();
    return result;
  }

  /// Half sides.
  static Eigen::Vector2d on_plate(const Eigen::Isometry3d& T, const Eigen::Vector3d& ray) {
    const Eigen::Isometry3d inverse = T.inverse();
    const Eigen::Vector3d from = inverse.translation(), along = inverse.linear() * ray;
    return (from - along * (from.z() / along.z())).head<2>() / (0.5 * PosedLandmark::kSide_m);
  }

  Eigen::VectorXd greys(const Eigen::Isometry3d& T, const std::vector<Eigen::Vector3d>& rays) const {
    Eigen::VectorXd result(static_cast<Eigen::Index>(rays.size()));
    for (std::size_t k = 0; k < rays.size(); ++k) {
      const Eigen::Vector2d at = ((on_plate(T, rays[k]).array() + 1) * (0.5 * kSize) - 0.5).matrix();
      const int i = std::clamp(int(at.x()), 0, kSize - 2), j = std::clamp(int(at.y()), 0, kSize - 2);
      const double f = at.x() - i, g = at.y() - j;
      result(static_cast<Eigen::Index>(k)) =
          (1 - g) * ((1 - f) * plate_.at<float>(j, i) + f * plate_.at<float>(j, i + 1)) +
          g * ((1 - f) * plate_.at<float>(j + 1, i) + f * plate_.at<float>(j + 1, i + 1));
    }
    return result;
  }

  tracking::Camera camera_;
  cv::Mat plate_;
};

}  // namespace heartservo::test
