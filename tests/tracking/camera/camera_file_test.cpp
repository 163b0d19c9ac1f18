#include "tracking/camera/camera_file.hpp"

#include <gtest/gtest.h>
#include <visp3/core/vpMeterPixelConversion.h>
#include <visp3/core/vpXmlParserCamera.h>

#include <opencv2/core.hpp>

#include "tests/support/files.hpp"
#include "tests/support/table2_camera.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tracking {
namespace {

using test::TemporaryFolder;

void expect_same(const Camera& a, const Camera& b) {
  EXPECT_EQ(a.width, b.width);
  EXPECT_EQ(a.height, b.height);
  EXPECT_EQ(a.fx, b.fx);
  EXPECT_EQ(a.fy, b.fy);
  EXPECT_EQ(a.cx, b.cx);
  EXPECT_EQ(a.cy, b.cy);
  EXPECT_EQ(a.k1, b.k1);
  EXPECT_EQ(a.k2, b.k2);
  EXPECT_EQ(a.k3, b.k3);
  EXPECT_EQ(a.k4, b.k4);
}

// Reading must fail with one line that names the file and all of `words`.
void expect_refused(const std::string& file, const std::vector<std::string>& words) {
  try {
    read_camera(file);
    ADD_FAILURE() << file << " was accepted";
  } catch (const InputError& e) {
    const std::string message = e.what();
    EXPECT_NE(message.find(file), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    for (const auto& word : words) EXPECT_NE(message.find(word), std::string::npos) << word << " not in: " << message;
  }
}

std::string ros(const std::string& from = "", const std::string& to = "") {
  std::string text = test::read_all(HEARTSERVO_SOURCE_DIR "/scenes/cameras/sauvee_2007.yaml");
  const auto at = from.empty() ? std::string::npos : text.find(from);
  if (!from.empty() && at == std::string::npos) throw std::runtime_error("no '" + from + "' in the example");
  return from.empty() ? text : text.replace(at, from.size(), to);
}

TEST(CameraFile, ShippedPaperCameraIsTable2) {
  expect_same(read_camera(HEARTSERVO_SOURCE_DIR "/scenes/cameras/sauvee_2007.yaml"), test::table2_camera());
}

TEST(CameraFile, RosFileReadsBackBitByBitAndLeavesNothingElse) {
  const TemporaryFolder folder;
  Camera camera = test::table2_camera();
  camera.fx = 593.0 + 1.0 / 3;
  camera.k2 = 0.1 + 0.2;
  write_ros_camera(camera, folder / "camera.yaml", "left: \"tip\"");
  expect_same(read_camera(folder / "camera.yaml"), camera);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

TEST(CameraFile, WritingWhereItCannotBeOrWhatIsNoCameraIsRefused) {
  const TemporaryFolder folder;
  EXPECT_THROW(write_ros_camera(test::table2_camera(), folder / "no/such/folder.yaml", "x"), InputError);
  EXPECT_THROW(write_ros_camera(Camera{}, folder / "empty.yaml", "x"), InputError);
  std::filesystem::create_directory(folder / "taken.yaml");
  folder.write("taken.yaml/inside", "");
  EXPECT_THROW(write_ros_camera(test::table2_camera(), folder / "taken.yaml", "x"), InputError);
  EXPECT_FALSE(std::filesystem::exists(folder / "taken.yaml.partial"));
}

TEST(CameraFile, RosFileErrorsNameTheKey) {
  const TemporaryFolder folder;
  const auto refused = [&](const std::string& from, const std::string& to, const std::vector<std::string>& words) {
    expect_refused(folder.write("camera.yaml", ros(from, to)), words);
  };
  refused("image_width: 512\n", "", {"image_width", "missing"});
  refused("image_width", "image_widht", {"image_width", "did you mean"});
  refused("image_height: 512", "image_height: tall", {"image_height", "whole number"});
  refused("image_height: 512", "image_height: -4", {"height", "positive"});
  refused("593.6, 0", "593.6, .nan", {"camera_matrix", "nan"});
  refused("593.6, 0", ".inf, 0", {"camera_matrix", "inf"});
  refused("593.6, 0", "wide, 0", {"camera_matrix", "numbers"});
  refused("593.6, 0, ", "593.6, ", {"camera_matrix", "8 numbers"});
  refused("593.6, 0", "593.6, 3", {"camera_matrix", "skew"});
  refused("593.6, 0", "-593.6, 0", {"fx", "positive"});
  refused("plumb_bob\n", "equidistant\n", {"distortion_model", "plumb_bob", "equidistant"});
  refused("distortion_model", "#", {"distortion_model", "missing"});
  refused("0.008, 0]", "0.008, 0.1]", {"distortion_coefficients", "third radial", "0.1"});
  refused("cols: 5\n  data: [-0.241, 0.207, 0.005, 0.008, 0]", "cols: 3\n  data: [-0.241, 0.207, 0.005]",
          {"distortion_coefficients", "3 numbers"});
  refused("cols: 5", "cols: 4", {"distortion_coefficients", "rows and cols"});
  refused("-0.241", "-2.41", {"cannot be inverted"});
}

TEST(CameraFile, FourCoefficientsAreEnough) {
  const TemporaryFolder folder;
  const std::string text =
      ros("cols: 5\n  data: [-0.241, 0.207, 0.005, 0.008, 0]", "cols: 4\n  data: [-0.241, 0.207, 0.005, 0.008]");
  expect_same(read_camera(folder.write("camera.yaml", text)), test::table2_camera());
}

TEST(CameraFile, WhatIsNoCameraFileIsRefused) {
  const TemporaryFolder folder;
  expect_refused(folder / "absent.yaml", {"no such file"});
  expect_refused(folder.path(), {"not a file"});
  expect_refused(folder.write("empty.yaml", ""), {"empty"});
  expect_refused(folder.write("blank.yaml", " \n\n"), {"empty"});
  expect_refused(folder.write("note.txt", "just some words\n"), {"no keys"});
  expect_refused(folder.write("broken.yaml", "a: [1, 2\nb: }"), {"broken.yaml:"});
  expect_refused(folder.write("binary.yaml", std::string("\x89PNG\0\0", 6)), {"not a text file"});
  expect_refused(folder.write("other.yaml", "heart: six_line\n"), {"image_width", "missing"});
  expect_refused(folder.write("other.xml", "<?xml version=\"1.0\"?>\n<root><robot/></root>\n"), {"no <camera>"});
  expect_refused(folder.write("cut.xml", "<?xml version=\"1.0\"?>\n<opencv_storage>\n<camera_matrix"), {"OpenCV"});
}

TEST(CameraFile, OpenCvFilesInYamlAndXmlUnderTheirUsualNames) {
  const TemporaryFolder folder;
  const Camera camera = test::table2_camera();
  const cv::Mat K = (cv::Mat_<double>(3, 3) << camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
  const cv::Mat D = (cv::Mat_<double>(1, 5) << camera.k1, camera.k2, camera.k3, camera.k4, 0);
  for (const std::string extension : {".yaml", ".yml", ".xml"})
    for (const auto& [k, d] : std::vector<std::pair<std::string, std::string>>{
             {"camera_matrix", "distortion_coefficients"}, {"cameraMatrix", "distCoeffs"}, {"K", "D"}}) {
      const std::string file = folder / ("camera" + extension);
      {
        cv::FileStorage out(file, cv::FileStorage::WRITE);
        out << "image_width" << 512 << "image_height" << 512 << k << K << d << D.t();
      }
      expect_same(read_camera(file), camera);
    }
}

TEST(CameraFile, OpenCvFileErrorsNameTheKey) {
  const TemporaryFolder folder;
  const std::string head = "%YAML:1.0\n---\n", size = "image_width: 512\nimage_height: 512\n";
  const auto matrix = [](const std::string& name, int rows, int cols, const std::string& data) {
    return name + ": !!opencv-matrix\n   rows: " + std::to_string(rows) + "\n   cols: " + std::to_string(cols) +
           "\n   dt: d\n   data: [ " + data + " ]\n";
  };
  const std::string K = matrix("camera_matrix", 3, 3, "593.6, 0., 279.6, 0., 594.5, 223.7, 0., 0., 1.");
  const std::string D = matrix("distortion_coefficients", 4, 1, "-0.241, 0.207, 0.005, 0.008");
  EXPECT_NO_THROW(read_camera(folder.write("good.yaml", head + size + K + D)));
  EXPECT_NO_THROW(read_camera(folder.write("good.yaml", size + K + D))) << "the header may be missing";
  expect_refused(folder.write("a.yaml", head + K + D), {"image_width", "missing"});
  expect_refused(folder.write("b.yaml", head + size + D), {"camera_matrix", "missing"});
  expect_refused(folder.write("c.yaml", head + size + K), {"distortion_coefficients", "missing"});
  expect_refused(folder.write("d.yaml", head + size + matrix("camera_matrix", 2, 2, "593.6, 0., 0., 594.5") + D),
                 {"camera_matrix", "3 x 3"});
  expect_refused(folder.write("e.yaml", head + size + K + matrix("distCoeffs", 1, 5, "0.1, 0., 0., 0., 0.3")),
                 {"distCoeffs", "third radial"});
  expect_refused(
      folder.write("f.yaml",
                   head + size + matrix("camera_matrix", 3, 3, ".Nan, 0., 279.6, 0., 594.5, 223.7, 0., 0., 1.") + D),
      {"camera_matrix", "nan"});
  expect_refused(folder.write("g.yaml", head + size + "camera_matrix: 3\n" + D), {"camera_matrix", "matrix"});
  expect_refused(folder.write("h.yaml", head + "image_width: wide\nimage_height: 512\n" + K + D), {"image_width"});
  expect_refused(folder.write("i.yaml", head + size + "Camera.fx: 500.\nCamera.fy: 500.\nCamera.cx: 250.\n"),
                 {"Camera.cy", "missing"});
}

TEST(CameraFile, RealOrbSlamAndStereoFilesOfAnEndoscope) {
  const auto rectified = test::data("endoscope_calib/sd-defslam_hamlyn_rectified_320x240.yaml");
  const auto stereo = test::data("endoscope_calib/sd-defslam_hamlyn_stereo_320x240_fdb63e9.yaml");
  SKIP_WITHOUT_DATA(rectified);
  const Camera a = read_camera(rectified.string());
  EXPECT_EQ(a.width, 320);
  EXPECT_EQ(a.height, 240);
  EXPECT_DOUBLE_EQ(a.fx, 383.1901395);
  EXPECT_DOUBLE_EQ(a.cy, 124.3409128);
  EXPECT_FALSE(a.has_distortion());
  const Camera b = read_camera(stereo.string());
  EXPECT_EQ(b.width, 320);
  EXPECT_DOUBLE_EQ(b.fx, 381.914307);
  EXPECT_DOUBLE_EQ(b.fy, 383.797882);
  EXPECT_DOUBLE_EQ(b.k2, 0.925076);
  EXPECT_DOUBLE_EQ(b.k4, 0.000916);
}

TEST(CameraFile, VispXmlProjectsAsVispAndPrintsNothing) {
  const TemporaryFolder folder;
  vpCameraParameters parameters;
  parameters.initPersProjWithDistortion(593.6, 594.5, 279.6, 223.7, -0.2, 0.21);
  vpXmlParserCamera().save(parameters, folder / "visp.xml", "endoscope tip", 512, 512);
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  const Camera camera = read_camera(folder / "visp.xml");
  EXPECT_EQ(testing::internal::GetCapturedStdout() + testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(camera.width, 512);
  double u = 0, v = 0;
  vpMeterPixelConversion::convertPoint(parameters, 0.21, -0.13, u, v);
  const Eigen::Vector2d pixel = camera.project({0.21, -0.13, 1});
  EXPECT_NEAR(pixel.x(), u, 1e-9);
  EXPECT_NEAR(pixel.y(), v, 1e-9);
}

TEST(CameraFile, VispXmlWithoutDistortionAndWhatIsRefused) {
  const TemporaryFolder folder;
  vpCameraParameters parameters;
  parameters.initPersProjWithoutDistortion(500, 501, 300, 200);
  vpXmlParserCamera().save(parameters, folder / "plain.xml", "", 640, 480);
  const Camera camera = read_camera(folder / "plain.xml");
  EXPECT_EQ(camera.fy, 501);
  EXPECT_FALSE(camera.has_distortion());

  vpXmlParserCamera().save(parameters, folder / "two.xml", "a", 640, 480);
  vpXmlParserCamera().save(parameters, folder / "two.xml", "b", 640, 480);
  expect_refused(folder / "two.xml", {"2 cameras", "a, b"});
  parameters.initProjWithKannalaBrandtDistortion(500, 501, 300, 200, {0.1, 0.01, 0.001, 0.0001});
  vpXmlParserCamera().save(parameters, folder / "fisheye.xml", "c", 640, 480);
  expect_refused(folder / "fisheye.xml", {"Kannala-Brandt"});
  std::string text = test::read_all(folder / "plain.xml");
  text.erase(text.find("<px>"), 12);
  expect_refused(folder.write("nopx.xml", text), {"px"});
}

}  // namespace
}  // namespace heartservo::tracking
