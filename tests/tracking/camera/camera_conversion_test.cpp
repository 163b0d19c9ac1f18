// Files of other programs: written, read back, and what is lost on the way.
#include <gtest/gtest.h>
#include <visp3/core/vpMeterPixelConversion.h>
#include <visp3/core/vpPixelMeterConversion.h>
#include <visp3/core/vpXmlParserCamera.h>

#include <Eigen/Geometry>

#include "tests/support/files.hpp"
#include "tests/support/message.hpp"
#include "tests/support/numeric_jacobian.hpp"
#include "tests/support/random.hpp"
#include "tests/support/table2_camera.hpp"
#include "tracking/camera/camera_file.hpp"
#include "tracking/camera/camera_fit.hpp"
#include "tracking/camera/camera_jacobian.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tracking {
namespace {

using test::message_of;
using test::table2_camera;
using test::TemporaryFolder;

WideCamera wide_camera() {
  WideCamera wide;
  wide.camera = table2_camera();
  wide.camera.fx = 593.0 + 1.0 / 3;
  wide.k5 = -0.05;
  wide.skew = 0.7;
  return wide;
}

void expect_same(const WideCamera& a, const WideCamera& b) {
  EXPECT_EQ(a.camera.width, b.camera.width);
  EXPECT_EQ(a.camera.height, b.camera.height);
  const CameraParameters p = parameters_of(a.camera), q = parameters_of(b.camera);
  for (int k = 0; k < 8; ++k) EXPECT_DOUBLE_EQ(p[k], q[k]) << CAMERA_PARAMETER_NAMES[k];
  EXPECT_DOUBLE_EQ(a.k5, b.k5);
  EXPECT_DOUBLE_EQ(a.skew, b.skew);
}

TEST(CameraConversion, EveryFormatReadsBackWhatItCanHold) {
  const TemporaryFolder folder;
  WideCamera no_skew = wide_camera(), radial = {table2_camera()};
  no_skew.skew = 0;
  radial.camera.k2 = radial.camera.k3 = radial.camera.k4 = 0;
  const std::tuple<CameraFormat, const char*, WideCamera> files[] = {
      {CameraFormat::ROS, "ros.yaml", no_skew},      {CameraFormat::OPENCV, "opencv.yaml", no_skew},
      {CameraFormat::OPENCV, "opencv.xml", no_skew}, {CameraFormat::MATLAB, "Calib_Results.m", wide_camera()},
      {CameraFormat::VISP, "visp.xml", radial},
  };
  for (const auto& [format, name, camera] : files) {
    write_camera(camera, format, folder / name, "tip & \"eye\"");
    const CameraFile read = read_camera_file(folder / name);
    EXPECT_EQ(read.format, format) << name;
    expect_same(read.camera, camera);
    EXPECT_EQ(read.beyond.empty(), camera.is_paper_model()) << name;
    EXPECT_FALSE(std::filesystem::exists(folder / (std::string(name) + ".partial")));
  }
}

TEST(CameraConversion, MatlabFilesOfTheToolboxAreRead) {
  const TemporaryFolder folder;
  const std::string file = folder.write("Calib_Results.m",
                                        "% Intrinsic and Extrinsic Camera Parameters\r\n"
                                        "%-- Focal length:\r\nfc = [ 657.395 ; 657.763 ];\r\n"
                                        "%-- Principal point:\ncc = [ 302.98 ; ...\n  242.62 ];\n"
                                        "alpha_c = 0.00042; kc = [ -0.2558\n 0.1276\n -0.0002  0.00003 ; 0 ];\n"
                                        "fc_error = [ 0.3 ; 0.4 ];\nnx = 640;\tny=480;\n"
                                        "omc_1 = [ 1.6e+00 ; 1.7 ; -6.7e-01 ]; % rotation\nn_ima = 20;\n");
  const CameraFile read = read_camera_file(file);
  EXPECT_EQ(read.format, CameraFormat::MATLAB);
  const Camera& c = read.camera.camera;
  EXPECT_EQ(c.width, 640);
  EXPECT_EQ(c.height, 480);
  EXPECT_EQ(parameters_of(c),
            (CameraParameters() << 657.395, 657.763, 302.98, 242.62, -0.2558, 0.1276, -0.0002, 0.00003).finished());
  EXPECT_DOUBLE_EQ(read.camera.skew, 0.00042 * 657.395);
  // Bouguet: xp = xd + alpha_c yd, u = fc(1) xp + cc(1)
  const Eigen::Vector2d n(0.2, -0.1), d = c.distort(n);
  EXPECT_NEAR(read.camera.to_pixel(n).x(), 657.395 * (d.x() + 0.00042 * d.y()) + 302.98, 1e-10);
}

TEST(CameraConversion, MatlabErrorsNameTheKey) {
  const TemporaryFolder folder;
  const std::string good =
      "fc = [ 600 ; 601 ];\ncc = [ 255 ; 250 ];\nalpha_c = 0;\nkc = [ -0.2 ; 0.1 ; 0 ; 0 ; 0 ];\nnx = 512;\nny = "
      "512;\n";
  const auto refusal = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    text.replace(text.find(from), from.size(), to);
    const std::string file = folder.write("c.m", text);
    const std::string message = message_of<InputError>([&] { read_camera(file); });
    EXPECT_EQ(message.rfind(file, 0), 0u) << message;
    return message.substr(std::min(message.size(), file.size()));
  };
  EXPECT_NO_THROW(read_camera(folder.write("good.m", good)));
  EXPECT_NE(refusal("fc = ", "f = ").find(": fc: is missing (did you mean"), std::string::npos);
  EXPECT_NE(refusal("ny = 512;", "").find(": ny: is missing"), std::string::npos);
  EXPECT_NE(refusal("[ 600 ; 601 ]", "[ 600 ]").find(":1: fc: must hold 2 numbers, has 1"), std::string::npos);
  EXPECT_NE(refusal("601", "Inf").find(":1: fc: holds inf"), std::string::npos);
  EXPECT_NE(refusal("-0.2 ", "NaN ").find(":4: kc: holds nan"), std::string::npos);
  EXPECT_NE(refusal("255", "x").find(":2: cc: 'x' is not a number"), std::string::npos);
  EXPECT_NE(refusal("nx = 512", "nx = 512.5").find(":5: nx: must be a whole number"), std::string::npos);
  EXPECT_NE(refusal("[ 600", "[ -600").find("fx is -600 px, must be positive"), std::string::npos);
  EXPECT_NE(refusal("0 ; 0 ]", "0 ; 0.4 ]").find("third radial"), std::string::npos);
  EXPECT_NE(refusal("alpha_c = 0", "alpha_c = 0.01").find(":3: alpha_c"), std::string::npos);
  EXPECT_NE(refusal("alpha_c = 0", "alpha_c = 0.01").find("--terms 4"), std::string::npos);
  EXPECT_NE(refusal("kc = [ -0.2 ; 0.1 ; 0 ; 0 ; 0 ]", "kc = [ -0.2 ; 0.1").find("kc"), std::string::npos);
}

TEST(CameraConversion, NothingIsLostWhereNothingHasToBe) {
  const auto fit = fit_camera(wide_camera(), {true, true, true, true});
  expect_same(fit.camera, wide_camera());
  EXPECT_TRUE(fit.lost.empty());
  EXPECT_EQ(fit.error.max_px, 0);
  expect_same(fit_camera({table2_camera()}, PAPER_TERMS).camera, {table2_camera()});
}

// Root mean square over an own grid, finer than that of the fit.
double rms_px(const WideCamera& a, const WideCamera& b) {
  double sum = 0, count = 0;
  for (const auto& pixel : picture_grid(512, 512, 50)) {
    sum += (b.to_pixel(a.normalise(pixel)) - pixel).squaredNorm();
    ++count;
  }
  return std::sqrt(sum / count);
}

TEST(CameraConversion, TheFitIsTheNearestCameraAndItsErrorIsAsStated) {
  auto random = test::seeded();
  for (const CameraTerms& terms : {CameraTerms{}, PAPER_TERMS, CameraTerms{true, true, true, false}}) {
    const auto fit = fit_camera(wide_camera(), terms);
    EXPECT_NEAR(rms_px(wide_camera(), fit.camera), fit.error.rms_px, 0.06 * fit.error.rms_px);
    EXPECT_LT((fit.camera.to_pixel(wide_camera().normalise(fit.error.worst_px)) - fit.error.worst_px).norm(),
              fit.error.max_px + 1e-9);
    double best = 0;
    for (const auto& pixel : picture_grid(512, 512))
      best += (fit.camera.to_pixel(wide_camera().normalise(pixel)) - pixel).squaredNorm();
    for (int trial = 0; trial < 30; ++trial) {  // no neighbour is nearer
      WideCamera other = fit.camera;
      CameraParameters step;
      for (int k = 0; k < 8; ++k) step[k] = test::normal(random, k < 4 ? 0.05 : 3e-4);
      if (!terms.k2) step[5] = 0;
      if (!terms.tangential) step[6] = step[7] = 0;
      other.camera = with_parameters(other.camera, parameters_of(other.camera) + step);
      double sum = 0;
      for (const auto& pixel : picture_grid(512, 512))
        sum += (other.to_pixel(wide_camera().normalise(pixel)) - pixel).squaredNorm();
      EXPECT_GT(sum, best);
    }
  }
  const auto paper = fit_camera(wide_camera(), PAPER_TERMS);
  EXPECT_EQ(paper.lost, (std::vector<std::string>{"k5", "skew"}));
  EXPECT_LT(paper.error.max_px, 0.5) << "k2 takes most of what r^6 did, and a turn of the picture most of the skew";
}

TEST(CameraConversion, ThePapersCameraIsTooMuchForVisp) {
  const auto fit = fit_camera({table2_camera()}, {});
  EXPECT_EQ(fit.lost, (std::vector<std::string>{"k2", "k3", "k4"}));
  EXPECT_GT(fit.error.rms_px, 1);
  EXPECT_GT(fit.error.max_px, 5);
  EXPECT_EQ(fit.camera.camera.k2, 0);
}

// What ViSP itself does with the file, both ways.
TEST(CameraConversion, VispFindsTheRaysAndPixelsThatAreStated) {
  const TemporaryFolder folder;
  Camera weak = table2_camera();
  weak.k1 = -0.05;
  weak.k2 = 0.02;
  weak.k3 = weak.k4 = 3e-4;
  const auto fit = fit_camera({weak}, {});
  const auto backward = fit_backward(fit.camera.camera, {weak});
  EXPECT_LT(fit.error.max_px, 0.5);
  write_camera(fit.camera, CameraFormat::VISP, folder / "visp.xml", "tip", backward.kdu);
  vpXmlParserCamera parser;
  vpCameraParameters visp;
  ASSERT_EQ(parser.parse(visp, folder / "visp.xml", "tip", vpCameraParameters::perspectiveProjWithDistortion),
            vpXmlParserCamera::SEQUENCE_OK);
  double forward_max = 0, backward_max = 0;
  for (const auto& pixel : picture_grid(512, 512)) {
    const Eigen::Vector2d ray = weak.normalise(pixel);
    Eigen::Vector2d seen, found;
    vpMeterPixelConversion::convertPoint(visp, ray.x(), ray.y(), seen.x(), seen.y());
    vpPixelMeterConversion::convertPoint(visp, pixel.x(), pixel.y(), found.x(), found.y());
    forward_max = std::max(forward_max, (seen - pixel).norm());
    const Eigen::Array2d f(fit.camera.camera.fx, fit.camera.camera.fy);
    backward_max = std::max(backward_max, (f * (found - ray).array()).matrix().norm());
  }
  EXPECT_NEAR(forward_max, fit.error.max_px, 1e-6);
  EXPECT_NEAR(backward_max, backward.error.max_px, 1e-6);
}

TEST(CameraConversion, WideCameraInvertsItself) {
  const WideCamera wide = wide_camera();
  EXPECT_TRUE(wide.validate().empty());
  for (const auto& pixel : picture_grid(512, 512))
    EXPECT_LT((wide.to_pixel(wide.normalise(pixel)) - pixel).norm(), 1e-8);
  WideCamera folded = wide;
  folded.k5 = -3;
  ASSERT_FALSE(folded.validate().empty());
  EXPECT_NE(folded.validate()[0].find("cannot be inverted"), std::string::npos);
  folded.k5 = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(folded.validate().empty());
}

TEST(CameraConversion, NamesTellFormats) {
  EXPECT_EQ(format_of_name("a.m"), CameraFormat::MATLAB);
  EXPECT_EQ(format_of_name("dir.m/a.xml"), CameraFormat::VISP);
  EXPECT_EQ(format_of_name("a.yml"), CameraFormat::ROS);
  EXPECT_FALSE(format_of_name("a.txt"));
  EXPECT_EQ(camera_format("opencv"), CameraFormat::OPENCV);
  EXPECT_NE(message_of<ConfigError>([] { camera_format("matlap"); }).find("did you mean 'matlab'"), std::string::npos);
}

TEST(CameraJacobian, IsTheDerivative) {
  auto random = test::seeded();
  const Camera camera = table2_camera();
  for (int i = 0; i < 20; ++i) {
    const Eigen::Vector3d point(test::uniform(random, -0.02, 0.02), test::uniform(random, -0.02, 0.02), 0.055);
    const auto by_point = [&](const Eigen::VectorXd& p) { return Eigen::VectorXd(camera.project(p)); };
    EXPECT_LT((projection_jacobian(camera, point) - test::numeric_jacobian(by_point, point)).norm(), 1e-3);
    const auto by_parameters = [&](const Eigen::VectorXd& p) {
      return Eigen::VectorXd(with_parameters(camera, p).project(point));
    };
    EXPECT_LT(
        (parameter_jacobian(camera, point.hnormalized()) - test::numeric_jacobian(by_parameters, parameters_of(camera)))
            .norm(),
        1e-6);
  }
}

}  // namespace
}  // namespace heartservo::tracking
