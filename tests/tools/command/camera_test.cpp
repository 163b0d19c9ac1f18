// heartservo camera: files of other programs, shown and converted.
#include "tests/support/message.hpp"
#include "tests/support/table2_camera.hpp"
#include "tests/tools/command/command_fixture.hpp"
#include "tracking/camera/camera_file.hpp"
#include "tracking/camera/camera_jacobian.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::test {
namespace {

class CameraCommand : public CommandLine {
 protected:
  CameraCommand() { fs::copy(HEARTSERVO_SOURCE_DIR "/scenes/cameras/sauvee_2007.yaml", folder_ / "paper.yaml"); }

  void expect_paper(const std::string& file) const {
    EXPECT_EQ(tracking::parameters_of(tracking::read_camera(folder_ / file)), tracking::parameters_of(table2_camera()))
        << file;
  }
};

TEST_F(CameraCommand, GoesRoundThroughEveryLosslessFormat) {
  const std::vector<std::vector<std::string>> steps{{"paper.yaml", "Calib_Results.m"},
                                                    {"Calib_Results.m", "opencv.yaml", "--to", "opencv"},
                                                    {"opencv.yaml", "opencv.xml", "--to", "opencv"},
                                                    {"opencv.xml", "back.yaml"}};
  for (auto step : steps) {
    const std::string out = step[1];
    step.insert(step.begin(), {"camera", "convert"});
    const Outcome o = run(step);
    EXPECT_EQ(o.code, 0) << o.err;
    EXPECT_NE(o.out.find("nothing is lost"), std::string::npos) << o.out;
    expect_paper(out);
  }
}

TEST_F(CameraCommand, ALossyConversionIsRefusedUnlessForced) {
  expect_refused(2, {"camera", "convert", "paper.yaml", "visp.xml"},
                 {"visp cannot hold k2, k3, k4", "1.527 px RMS over the picture, 7.838 px at most", "--force"});
  EXPECT_FALSE(fs::exists(folder_ / "visp.xml"));
  const Outcome o = run({"camera", "convert", "paper.yaml", "visp.xml", "--force", "--json"});
  ASSERT_EQ(o.code, 0) << o.err;
  const auto json = json_of(o);
  EXPECT_EQ(json["lossy"], true);
  EXPECT_EQ(json["lost"], (nlohmann::json{"k2", "k3", "k4"}));
  EXPECT_NEAR(json["error_px"]["rms"], 1.527, 1e-3);
  EXPECT_NEAR(json["error_px"]["max"], 7.838, 1e-3);
  const auto camera = tracking::read_camera(folder_ / "visp.xml");
  EXPECT_EQ(camera.k2, 0);
  EXPECT_NE(camera.k1, 0);
}

TEST_F(CameraCommand, ASmallLossIsStatedAndAllowed) {
  std::string text = read_text(folder_ / "paper.yaml");
  const std::string from = "[-0.241, 0.207, 0.005, 0.008, 0]";
  ASSERT_NE(text.find(from), std::string::npos);
  text.replace(text.find(from), from.size(), "[-0.05, 0.02, 0.0002, 0.0001, 0]");
  write_text(folder_ / "weak.yaml", text);
  const Outcome o = run({"camera", "convert", "weak.yaml", "visp.xml"});
  EXPECT_EQ(o.code, 0) << o.err;
  EXPECT_NE(o.out.find("without k2, k3, k4: 0."), std::string::npos) << o.out;
  EXPECT_NE(o.out.find("px at most"), std::string::npos) << o.out;
}

TEST_F(CameraCommand, AThirdRadialTermIsKeptOrFitted) {
  std::string text = read_text(folder_ / "paper.yaml");
  text.replace(text.find("0.008, 0]"), 9, "0.008, -0.02]");
  write_text(folder_ / "five.yaml", text);
  EXPECT_NE(message_of<InputError>([&] { tracking::read_camera(folder_ / "five.yaml"); }).find("--terms 4"),
            std::string::npos);
  EXPECT_EQ(run({"camera", "convert", "five.yaml", "five.m"}).code, 0);
  EXPECT_EQ(tracking::read_camera_file(folder_ / "five.m").camera.k5, -0.02);
  const Outcome o = run({"camera", "convert", "five.m", "four.yaml", "--terms", "4"});
  EXPECT_EQ(o.code, 0) << o.err;
  EXPECT_NE(o.out.find("without k5: 0.0"), std::string::npos) << o.out;
  EXPECT_NO_THROW(tracking::read_camera(folder_ / "four.yaml"));
}

TEST_F(CameraCommand, ShowsACameraLegibly) {
  const Outcome o = run({"camera", "show", "paper.yaml"});
  EXPECT_EQ(o.code, 0);
  for (const char* part : {"paper.yaml: ros", "512 x 512 px", "fx 593.600", "k1 -0.241", "k4 0.008", "field of view"})
    EXPECT_NE(o.out.find(part), std::string::npos) << part << "\n" << o.out;
  const auto json = json_of(run({"camera", "show", "paper.yaml", "--json"}));
  EXPECT_EQ(json["camera"]["fx"], 593.6);
  EXPECT_NEAR(json["camera"]["field_of_view_deg"][0], 48.4, 0.1);
  // the corner (511.5, 511.5), where Newton and eq. 3, 4 say the same
  EXPECT_NEAR(json["camera"]["largest_distortion_px"], 33, 0.5);
}

TEST_F(CameraCommand, BadInputIsNamedAndNothingIsWritten) {
  expect_refused(2, {"camera"}, {"camera --help"});
  expect_refused(2, {"camera", "convrt", "a", "b"}, {"'convrt'", "did you mean 'convert'"});
  expect_refused(2, {"camera", "convert", "paper.yaml"}, {"OUT"});
  expect_refused(2, {"camera", "convert", "paper.yaml", "x.txt"}, {"x.txt", "--to ros or opencv or visp or matlab"});
  expect_refused(2, {"camera", "convert", "paper.yaml", "x.m", "--to", "matlap"}, {"did you mean 'matlab'"});
  expect_refused(3, {"camera", "convert", "absent.yaml", "x.m"}, {"absent.yaml: no such file"});
  expect_refused(3, {"camera", "show", "."}, {"is not a file"});
  expect_refused(3, {"camera", "convert", "paper.yaml", "no/such/x.m"}, {"no/such/x.m: cannot be written"});
  write_text(folder_ / "bad.m",
             "fc = [ NaN ; 600 ];\ncc = [ 255 ; 255 ];\nkc = [ 0 ; 0 ; 0 ; 0 ];\nnx = 512;\nny = 512;\n");
  expect_refused(3, {"camera", "convert", "bad.m", "x.yaml"}, {"bad.m:1: fc: holds nan"});
  write_text(folder_ / "bad.m", "fc = [ 600 ; 600 ];\ncc = [ 255 ; 255 ];\nnx = 512;\nny = 512;\n");
  expect_refused(3, {"camera", "convert", "bad.m", "x.yaml"}, {"bad.m: kc: is missing"});
  EXPECT_FALSE(fs::exists(folder_ / "x.yaml"));
  EXPECT_FALSE(fs::exists(folder_ / "x.m"));
}

}  // namespace
}  // namespace heartservo::test
