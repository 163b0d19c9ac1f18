#include "tracking/camera/stereo_camera.hpp"

#include <gtest/gtest.h>

#include "tests/support/files.hpp"
#include "tests/support/message.hpp"
#include "tests/support/table2_camera.hpp"
#include "tracking/camera/camera_file.hpp"
#include "tracking/camera/camera_jacobian.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tracking {
namespace {

using test::message_of;
using test::TemporaryFolder;

StereoCamera endoscope() {
  StereoCamera stereo;
  stereo.left = stereo.right = test::table2_camera();
  stereo.right.fx = 601.125;
  stereo.T_right_left.linear() = Eigen::AngleAxisd(0.06, Eigen::Vector3d(0.1, 1, 0).normalized()).matrix();
  stereo.T_right_left.translation() << -0.0047, 0.0001, 0.0003;
  return stereo;
}

TEST(StereoCamera, FileReadsBack) {
  const TemporaryFolder folder;
  const auto stereo = endoscope();
  write_stereo_camera(stereo, folder / "stereo.yaml");
  const auto read = read_stereo_camera(folder / "stereo.yaml");
  EXPECT_EQ(parameters_of(read.left), parameters_of(stereo.left));
  EXPECT_EQ(parameters_of(read.right), parameters_of(stereo.right));
  EXPECT_EQ(read.right.width, 512);
  EXPECT_LT((read.T_right_left.matrix() - stereo.T_right_left.matrix()).norm(), 1e-14);
  EXPECT_TRUE(is_stereo_file(folder / "stereo.yaml"));
  EXPECT_EQ(parameters_of(read_camera(folder / "stereo.yaml")), parameters_of(stereo.left)) << "the left one alone";
  write_ros_camera(stereo.left, folder / "left.yaml", "left");
  EXPECT_FALSE(is_stereo_file(folder / "left.yaml"));
  EXPECT_FALSE(is_stereo_file(folder / "absent.yaml"));
}

TEST(StereoCamera, ErrorsNameTheKey) {
  const TemporaryFolder folder;
  write_stereo_camera(endoscope(), folder / "good.yaml");
  const std::string good = test::read_all(folder / "good.yaml");
  const auto refusal = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    const auto at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
    const std::string file = folder.write("bad.yaml", text);
    const std::string message = message_of<InputError>([&] { read_stereo_camera(file); });
    EXPECT_EQ(message.rfind(file, 0), 0u) << message;
    return message.substr(std::min(message.size(), file.size()));
  };
  EXPECT_NE(refusal("M2: ", "N2: ").find("M2: key is missing"), std::string::npos);
  EXPECT_NE(refusal("\nT: ", "\nt: ").find("T: key is missing"), std::string::npos);
  EXPECT_NE(refusal("\nR: ", "\nRR: ").find("R: key is missing"), std::string::npos);
  EXPECT_NE(refusal("length_unit: m", "length_unit: inch").find("length_unit: must be m or mm"), std::string::npos);
  EXPECT_NE(refusal("length_unit: m", "length_unit: mm").find("apart, must be 0.0001"), std::string::npos);
  EXPECT_NE(refusal("6.0112500000000000e+02", ".Nan").find("nan; calibrate again"), std::string::npos);
  EXPECT_NE(refusal("-4.7000000000000002e-03", ".Inf").find("T: holds inf"), std::string::npos);
  EXPECT_NE(refusal("-4.7000000000000002e-03", "-4.7").find("T: the cameras are 4.7 m apart"), std::string::npos);
  EXPECT_NE(refusal("9.9", "-9.9").find("R: is not a rotation"), std::string::npos);
  EXPECT_THROW(read_stereo_camera(folder / "absent.yaml"), InputError);
  write_ros_camera(endoscope().left, folder / "left.yaml", "left");
  EXPECT_THROW(read_stereo_camera(folder / "left.yaml"), InputError);
  StereoCamera other = endoscope();
  other.right.width = 640;
  EXPECT_NE(message_of<InputError>([&] { write_stereo_camera(other, folder / "x.yaml"); }).find("other sizes"),
            std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(folder / "x.yaml"));
}

TEST(StereoCamera, MillimetresAreTakenWhenSaid) {
  const TemporaryFolder folder;
  write_stereo_camera(endoscope(), folder / "m.yaml");
  std::string text = test::read_all(folder / "m.yaml");
  for (const auto& [from, to] : {std::pair{"-4.7000000000000002e-03", "-4.7"},
                                 {"1.0000000000000000e-04", "0.1"},
                                 {"2.9999999999999997e-04", "0.3"},
                                 {"length_unit: m", "length_unit: mm"}}) {
    ASSERT_NE(text.find(from), std::string::npos) << from << text;
    text.replace(text.find(from), std::string(from).size(), to);
  }
  EXPECT_NEAR(read_stereo_camera(folder.write("mm.yaml", text)).baseline_m(), endoscope().baseline_m(), 1e-12);
}

}  // namespace
}  // namespace heartservo::tracking
