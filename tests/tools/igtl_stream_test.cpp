// A real client of the library, over loopback.
#include "tools/igtl/igtl_stream.hpp"

#include <gtest/gtest.h>
#include <igtlClientSocket.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstring>
#include <functional>
#include <thread>

#include "tests/support/igtl_client.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tools {
namespace {

using namespace std::chrono_literals;
using test::receive;
using test::Received;

int some_port(int salt) { return 20000 + (static_cast<int>(::getpid()) * 7 + salt) % 20000; }

IgtlSnapshot snapshot(double time_s) {
  IgtlSnapshot s;
  s.time_s = time_s;
  s.has_target = true;
  s.T_camera_target.translation() = Eigen::Vector3d(0.001, -0.002, 0.055);
  s.T_camera_target.linear() = Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitX()).toRotationMatrix();
  s.T_camera_tip.translation() = Eigen::Vector3d(0.004, 0.001, 0.054);
  s.grey = cv::Mat(48, 64, CV_8UC1, cv::Scalar(77));
  s.grey.at<std::uint8_t>(3, 5) = 200;
  return s;
}

// Publishes until `enough` says so; how long the slowest publish() took, s.
double publish_until(IgtlStream& stream, const std::function<bool()>& enough) {
  double slowest = 0;
  for (int i = 0; i < 400 && !enough(); ++i) {
    const IgtlSnapshot s = snapshot(0.008 * i);
    const auto begin = std::chrono::steady_clock::now();
    stream.publish(s);
    slowest = std::max(slowest, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    std::this_thread::sleep_for(4ms);
  }
  return slowest;
}

TEST(IgtlStream, AClientGetsPosesInMillimetresAndPictures) {
  IgtlStream stream(some_port(1));
  Received target, tip, picture;
  std::thread client([&] {
    auto socket = igtl::ClientSocket::New();
    ASSERT_EQ(socket->ConnectToServer("127.0.0.1", some_port(1)), 0);
    socket->SetReceiveTimeout(3000);
    for (int i = 0; i < 60 && (target.name.empty() || tip.name.empty() || picture.name.empty()); ++i) {
      Received r = receive(*socket);
      if (r.name.empty()) break;
      (r.name == "target" ? target : r.name == "tip" ? tip : picture) = r;
    }
    socket->CloseSocket();
  });
  std::atomic<bool> done = false;
  std::thread waiter([&] { client.join(), done = true; });
  publish_until(stream, [&] { return done.load(); });
  waiter.join();
  ASSERT_EQ(target.name, "target");
  ASSERT_EQ(tip.name, "tip");
  ASSERT_EQ(picture.name, "endoscope");
  Eigen::Matrix4d expected = snapshot(0).T_camera_target.matrix();
  expected.topRightCorner<3, 1>() *= 1e3;
  EXPECT_LT((target.pose - expected).norm(), 1e-4) << target.pose;
  EXPECT_NEAR(tip.pose(2, 3), 54, 1e-4);
  EXPECT_EQ(cv::countNonZero(picture.grey != snapshot(0).grey), 0);
  EXPECT_NEAR(std::fmod(target.time_s + 0.0001, 0.008), 0.0001, 1e-6);
}

TEST(IgtlStream, ADeadClientNeverSlowsTheLoopAndIsDropped) {
  IgtlStream stream(some_port(2));
  auto deaf = igtl::ClientSocket::New();
  ASSERT_EQ(deaf->ConnectToServer("127.0.0.1", some_port(2)), 0);  // never reads
  IgtlSnapshot large = snapshot(0);
  large.grey = cv::Mat(2048, 2048, CV_8UC1, cv::Scalar(1));
  double slowest = 0;
  for (int i = 0; i < 300 && stream.counts().dropped_clients == 0; ++i) {
    large.time_s = 0.05 * i;
    const auto begin = std::chrono::steady_clock::now();
    stream.publish(large);
    slowest = std::max(slowest, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    std::this_thread::sleep_for(5ms);
  }
  EXPECT_EQ(stream.counts().dropped_clients, 1);
  EXPECT_LT(slowest, 0.09) << "a client's patience is 0.1 s; nobody may wait for it here";
  deaf->CloseSocket();
}

TEST(IgtlStream, WithoutClientsNothingIsSentAndATakenPortIsSaid) {
  IgtlStream stream(some_port(3));
  stream.publish(snapshot(1));
  std::this_thread::sleep_for(60ms);
  EXPECT_EQ(stream.counts().sent, 0);
  EXPECT_EQ(stream.counts().published, 1);
  EXPECT_THROW(IgtlStream(some_port(3)), DeviceError);
}

}  // namespace
}  // namespace heartservo::tools
