// heartservo calibrate, as people run it: pictures drawn through the paper's lens, corner lists, and what can be wrong.
#include "tests/support/board_scene.hpp"
#include "tests/support/table2_camera.hpp"
#include "tests/tools/command/command_fixture.hpp"
#include "tracking/camera/camera_file.hpp"
#include "tracking/camera/camera_jacobian.hpp"
#include "tracking/camera/stereo_camera.hpp"

namespace heartservo::test {
namespace {

using tracking::Board;
using tracking::Camera;

const std::vector<std::string> BOARD_OPTIONS{"--columns", "9", "--rows", "7", "--square-mm", "2.5"};

class Calibrate : public CommandLine {
 protected:
  static std::vector<std::string> line(std::vector<std::string> words, std::vector<std::string> more = BOARD_OPTIONS) {
    words.insert(words.begin(), "calibrate");
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }

  // Lists NAME/0.txt, 1.txt, ... of the small board.
  void write_lists(const std::string& name, const Camera& camera, const std::vector<Eigen::Isometry3d>& poses,
                   double sigma_px = 0.1) {
    fs::create_directories(folder_ / name);
    for (std::size_t i = 0; i < poses.size(); ++i) {
      std::string text;
      for (const auto& c : board_corners(random_, camera, small_board().points(), poses[i], sigma_px))
        text += std::to_string(c.x()) + " " + std::to_string(c.y()) + "\n";
      write_text(list(name, i), text);
    }
  }
  fs::path list(const std::string& name, std::size_t i) const {
    return folder_ / (name + "/" + std::to_string(i) + ".txt");
  }

  std::vector<Eigen::Isometry3d> poses(int count) {
    return board_poses(random_, table2_camera(), small_board(), count);
  }

  // Pictures NAME/0.png, ...
  void write_pictures(const std::string& name, const Board& board, int count) {
    static const BoardPainter painter(table2_camera());
    fs::create_directories(folder_ / name);
    for (const auto& T : board_poses(random_, table2_camera(), board, count))
      cv::imwrite(folder_ / (name + "/" + std::to_string(pictures_++) + ".png"), painter.paint(board, T, 2, random_));
  }

  std::mt19937_64 random_ = seeded();
  int pictures_ = 0;
};

void expect_near_table2(const Camera& camera) {
  EXPECT_NEAR(camera.fx, 593.6, 6);
  EXPECT_NEAR(camera.cx, 279.6, 6);
  EXPECT_NEAR(camera.k1, -0.241, 0.03);
}

TEST_F(Calibrate, APictureFolderBecomesARunFolderWithACamera) {
  write_pictures("board", small_board(), 8);
  cv::imwrite(folder_ / "board/blank.png", cv::Mat(512, 512, CV_8UC1, cv::Scalar(120)));
  cv::imwrite(folder_ / "board/small.png", cv::Mat(100, 100, CV_8UC1, cv::Scalar(120)));
  write_text(folder_ / "board/broken.png", "\x89PNG no more");
  write_text(folder_ / "board/notes.txt", "not a picture");
  const Outcome o = run(line({"board", "--json", "--out", "run"}));
  ASSERT_EQ(o.code, 0) << o.err;
  EXPECT_EQ(o.err, "");
  const auto json = json_of(o);
  EXPECT_EQ(json, summary_of("run"));
  EXPECT_EQ(json["command"], "calibrate");
  EXPECT_EQ(json["views"]["given"], 11);
  EXPECT_EQ(json["views"]["used"], 8);
  std::map<std::string, std::string> reasons;
  for (const auto& view : json["views"]["skipped"])
    reasons[fs::path(view["name"].get<std::string>()).filename()] = view["reason"];
  EXPECT_EQ(reasons["blank.png"], "the picture has no contrast");
  EXPECT_EQ(reasons["small.png"], "is 100 x 100 px, the pictures before it 512 x 512");
  EXPECT_NE(reasons["broken.png"], "");
  EXPECT_LT(json["rms_px"], 0.1);
  EXPECT_EQ(json["cameras"].size(), 1u);
  EXPECT_EQ(json["cameras"][0]["views"].size(), 8u);
  EXPECT_GT(json["cameras"][0]["coverage"]["picture_percent"], 20);
  EXPECT_TRUE(json["stereo"].is_null());
  expect_complete("run");
  expect_near_table2(tracking::read_camera(folder_ / "run/camera.yaml"));
  EXPECT_NEAR(json["cameras"][0]["parameters"]["fx"], tracking::read_camera(folder_ / "run/camera.yaml").fx, 1e-9);
  const std::string csv = read_text(folder_ / "run/corners.csv");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 1 + 8 * 63);
  const std::string report = read_text(folder_ / "run/report.html");
  EXPECT_NE(report.find("Where the board was seen"), std::string::npos);
  EXPECT_NE(report.find("the picture has no contrast"), std::string::npos);
}

TEST_F(Calibrate, CirclesAreMeasuredInThePictures) {
  Board board = small_board(tracking::BoardKind::CIRCLES);
  board.disc_m = 0.6 * board.pitch_m;
  write_pictures("board", board, 6);
  const Outcome o = run(line({"board", "--board", "circles", "--json", "--out", "run"}));
  ASSERT_EQ(o.code, 0) << o.err;
  const auto json = json_of(o);
  EXPECT_NEAR(json["board"]["circle_mm"], 1.5, 0.1);
  EXPECT_LT(json["rms_px"], 0.1);
  expect_near_table2(tracking::read_camera(folder_ / "run/camera.yaml"));
}

TEST_F(Calibrate, TheTableNamesViewsAndWarnings) {
  write_lists("lists", table2_camera(), poses(6));
  const Outcome o = run(line({"--corners", "lists", "--size", "512,512", "--out", "run"}));
  ASSERT_EQ(o.code, 0) << o.err;
  for (const char* part : {"6 of 6 views of a chessboard of 9 x 7, 2.5 mm", "fx ", "0.txt", "RMS px", "tilt deg",
                           "working volume", "report: "})
    EXPECT_NE(o.out.find(part), std::string::npos) << part << "\n" << o.out;
  const Outcome quiet = run(line({"--corners", "lists", "--size", "512,512", "--out", "run", "--quiet"}));
  EXPECT_EQ(quiet.out + quiet.err, "");
}

TEST_F(Calibrate, AreaThatWasNotCoveredIsWarnedOf) {
  std::vector<Eigen::Isometry3d> left;
  for (int i = 0; i < 8; ++i) left.push_back(board_pose({-0.006, -0.004, 0.068}, 0.5, 0.8 * i, 0));
  write_lists("lists", table2_camera(), left);
  const auto json = json_of(run(line({"--corners", "lists", "--size", "512,512", "--json", "--out", "run"})));
  std::string warnings;
  for (const auto& w : json["warnings"]) warnings += w.get<std::string>() + "\n";
  EXPECT_NE(warnings.find("no board in this part of the picture: "), std::string::npos) << warnings;
  EXPECT_NE(warnings.find("bottom right"), std::string::npos) << warnings;
  EXPECT_NE(warnings.find("working volume of 20 x 15 x 15 mm at 55 mm"), std::string::npos) << warnings;
  const auto volume = json["cameras"][0]["coverage"]["volume_slices_percent"];
  EXPECT_EQ(volume.size(), 3u);
  EXPECT_LT(volume[0], 30);
  const auto other = json_of(run(line({"--corners", "lists", "--size", "512,512", "--json", "--out", "run",
                                       "--volume-mm", "4,4,2", "--distance-mm", "68"})));
  EXPECT_EQ(other["working_volume"]["size_mm"], (nlohmann::json{4.0, 4.0, 2.0}));
}

TEST_F(Calibrate, PairsBecomeAStereoCamera) {
  Camera right = table2_camera();
  right.cx = 240;
  Eigen::Isometry3d T_right_left = Eigen::Isometry3d::Identity();
  T_right_left.linear() = Eigen::AngleAxisd(0.08, Eigen::Vector3d::UnitY()).matrix();
  T_right_left.translation() << -0.0047, 0, 0.0002;
  const auto left_poses = poses(9);
  std::vector<Eigen::Isometry3d> right_poses;
  for (const auto& T : left_poses) right_poses.push_back(T_right_left * T);
  write_lists("left", table2_camera(), left_poses);
  write_lists("right", right, right_poses);
  const auto words = line({"--corners", "left", "--right", "right", "--size", "512,512", "--json", "--out", "run"});
  const auto json = json_of(run(words));
  EXPECT_NEAR(json["stereo"]["baseline_mm"], 4.704, 0.1);
  EXPECT_EQ(json["stereo"]["pairs"], 9);
  EXPECT_EQ(json["cameras"][1]["side"], "right");
  expect_complete("run");
  const auto stereo = tracking::read_stereo_camera(folder_ / "run/stereo.yaml");
  EXPECT_LT((stereo.T_right_left.translation() - T_right_left.translation()).norm(), 2e-4);
  EXPECT_EQ(tracking::parameters_of(stereo.right),
            tracking::parameters_of(tracking::read_camera(folder_ / "run/camera_right.yaml")));
  const Outcome shown = run({"camera", "show", "run/stereo.yaml"});
  EXPECT_NE(shown.out.find("baseline"), std::string::npos) << shown.out;

  expect_refused(3, line({"--corners", "left", "--right", "left", "--size", "512,512", "--out", "twice"}),
                 {"mm apart", "the same pictures"});
  EXPECT_FALSE(fs::exists(folder_ / "twice.partial"));
  fs::remove(list("right", 8));
  expect_refused(2, words, {"--right has 8 views and the left side 9"});
  write_text(list("right", 8), read_text(list("right", 0)));
  std::string turned = read_text(list("right", 3)), reversed;
  for (std::size_t end = turned.size(); end > 0;) {
    const auto start = turned.rfind('\n', end - 2);
    reversed +=
        turned.substr(start == std::string::npos ? 0 : start + 1, end - (start == std::string::npos ? 0 : start + 1));
    end = start == std::string::npos ? 0 : start + 1;
  }
  write_text(list("right", 3), reversed);
  expect_refused(3, words, {"right/3.txt: begins at another corner of the board than left/3.txt"});
}

TEST_F(Calibrate, WrongUsageIsNamed) {
  write_lists("lists", table2_camera(), poses(3));
  expect_refused(2, line({}), {"PICTURES are missing"});
  expect_refused(2, {"calibrate", "lists", "--rows", "7", "--square-mm", "2.5"}, {"--columns is missing"});
  expect_refused(2, {"calibrate", "lists", "--columns", "9", "--rows", "7"}, {"--square-mm is missing"});
  expect_refused(2, line({"lists", "--board", "chesboard"}), {"did you mean 'chessboard'"});
  expect_refused(2, line({"lists", "--bord", "circles"}), {"'--bord'", "did you mean '--board'"});
  expect_refused(2, line({"--corners", "lists"}), {"--size is missing"});
  expect_refused(2, line({"lists", "--size", "512,512"}), {"--size is for --corners"});
  expect_refused(2, line({"lists", "--circle-mm", "1"}), {"--circle-mm is for --board circles"});
  expect_refused(2, line({"lists", "--board", "circles", "--circle-mm", "2.5"}), {"must be smaller"});
  expect_refused(2, {"calibrate", "lists", "--columns", "2", "--rows", "7", "--square-mm", "2.5"}, {"--columns"});
  expect_refused(2, {"calibrate", "lists", "--columns", "9", "--rows", "7", "--square-mm", "nan"}, {"--square-mm"});
  expect_refused(2, line({"lists", "--corners", "lists", "--size", "512,512"}), {"not both"});
  EXPECT_FALSE(fs::exists(folder_ / "runs"));
}

TEST_F(Calibrate, BadInputIsNamedAndNothingIsWritten) {
  write_lists("lists", table2_camera(), poses(4));
  const auto lists = line({"--corners", "lists", "--size", "512,512", "--out", "run"});
  expect_refused(3, line({"absent.png"}), {"absent.png: no such file"});
  expect_refused(3, line({"lists"}), {"lists: the folder holds no pictures"});
  expect_refused(
      3,
      {"calibrate", "--corners", "lists", "--size", "512,512", "--columns", "7", "--rows", "9", "--square-mm", "2.5"},
      {"lists/0.txt", "--columns 9 --rows 7"});
  const std::string good = read_text(list("lists", 2));
  write_text(list("lists", 2), "nan 3\n" + good.substr(good.find('\n') + 1));
  expect_refused(3, lists, {"lists/2.txt:1: holds nan"});
  write_text(list("lists", 2), good.substr(good.find('\n') + 1));
  expect_refused(3, lists, {"lists/2.txt: has 62 corners, a board of 9 x 7 has 63"});
  fs::remove(list("lists", 2));
  fs::remove(list("lists", 1));
  expect_refused(3, lists, {"2 usable views; take 3 or more"});
  write_lists(
      "flat", table2_camera(),
      {board_pose({0, 0, 0.05}, 0, 0, 0), board_pose({0.003, 0, 0.06}, 0, 0, 0), board_pose({0, 0, 0.065}, 0, 0, 0)});
  expect_refused(3, line({"--corners", "flat", "--size", "512,512", "--out", "run"}),
                 {"do not determine fx", "parallel", "tilted by 20 to 45 degrees"});
  EXPECT_FALSE(fs::exists(folder_ / "run"));
  EXPECT_FALSE(fs::exists(folder_ / "run.partial"));
}

TEST_F(Calibrate, PicturesWithoutTheBoardSayWhatIsThere) {
  write_pictures("board", small_board(), 2);
  expect_refused(3, {"calibrate", "board/0.png", "--columns", "10", "--rows", "8", "--square-mm", "2.5"},
                 {"board/0.png: no chessboard of 10 x 8 inner corners found", "one of 9 x 7: count inner corners"});
  expect_refused(3, line({"board"}), {"2 usable views; take 3 or more"});
  cv::imwrite(folder_ / "board/x.png", cv::Mat(512, 512, CV_8UC1, cv::Scalar(4)));
  expect_refused(3, line({"board"}), {"the board is in 2 of 3 pictures", "board/x.png: the picture is dark"});
}

TEST_F(Calibrate, TheRealEndoscopeReachesItsGoal) {
  const fs::path data = recorded_data() / "endoscope_calib";
  if (!fs::exists(data)) GTEST_SKIP() << "no " << data << "; set HEARTSERVO_DATA to the recorded data";
  const Outcome o = run({"calibrate", "--corners", data / "left", "--right", data / "right", "--size", "1920,1080",
                         "--columns", "14", "--rows", "10", "--square-mm", "3", "--json", "--out", "run"});
  ASSERT_EQ(o.code, 0) << o.err;
  const auto json = json_of(o);
  for (const auto& camera : json["cameras"]) EXPECT_LT(camera["rms_px"], 0.5);
  EXPECT_EQ(json["board"]["shape"], "free");
  EXPECT_NEAR(json["stereo"]["baseline_mm"], 4.66, 0.05);
  expect_complete("run");
}

}  // namespace
}  // namespace heartservo::test
