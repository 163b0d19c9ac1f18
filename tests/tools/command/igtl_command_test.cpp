// servo --igtl and track --igtl, with a client that reads and one that never does.
#include <igtlServerSocket.h>
#include <unistd.h>

#include <atomic>
#include <map>
#include <thread>

#include "tests/support/igtl_client.hpp"
#include "tests/tools/command/command_fixture.hpp"
#include "tools/time_table.hpp"

namespace heartservo::test {
namespace {

class IgtlCommand : public CommandLine {
 protected:
  struct Heard {
    Outcome outcome;
    std::vector<Received> messages;
    std::size_t of(const std::string& name) const {
      return static_cast<std::size_t>(
          std::count_if(messages.begin(), messages.end(), [&](const Received& r) { return r.name == name; }));
    }
  };

  // Runs the command; meanwhile one client listens and another is deaf.
  Heard heard(std::vector<std::string> arguments) const {
    const int port = 20000 + static_cast<int>(::getpid()) % 20000 + (arguments[0] == "track");
    arguments.insert(arguments.end(), {"--igtl", std::to_string(port), "--quiet", "--out", arguments[0]});
    Heard heard;
    std::atomic<bool> over = false;
    std::thread client([&] {
      igtl::ClientSocket::Pointer socket = igtl::ClientSocket::New(), deaf = igtl::ClientSocket::New();
      // the library keeps a file open for every attempt that fails
      const auto wait = [] { std::this_thread::sleep_for(std::chrono::milliseconds(20)); };
      while (!over && !fs::exists(folder_ / (arguments[0] + ".partial"))) wait();
      while (!over && socket->ConnectToServer("127.0.0.1", port) != 0) wait();
      if (over) return;
      EXPECT_EQ(deaf->ConnectToServer("127.0.0.1", port), 0);
      socket->SetReceiveTimeout(20000);
      for (;;) {
        Received r = receive(*socket);
        if (r.name.empty()) break;
        heard.messages.push_back(std::move(r));
      }
      socket->CloseSocket();
      deaf->CloseSocket();
    });
    heard.outcome = run(arguments);
    over = true;
    client.join();
    return heard;
  }
};

TEST_F(IgtlCommand, TargetAndPictureOfTrackArriveAsTheRunHasThem) {
  const Heard h = heard({"track", scene("pig_2007"), "--frames", frames(250)});
  ASSERT_EQ(h.outcome.code, 0) << h.outcome.err;
  ASSERT_GT(h.of("target"), 5u);
  EXPECT_GT(h.of("endoscope"), 0u);
  EXPECT_EQ(h.of("tip"), 0u) << "there is no tool";
  // what came is what frames.csv says of that time
  const auto table = tools::TimeTable::read_csv(folder_ / "track/frames.csv");
  const auto time = table.time_s();
  std::size_t compared = 0;
  for (const Received& r : h.messages) {
    if (r.name != "target") {
      EXPECT_EQ(r.grey.size(), cv::Size(512, 512)) << r.name;
      continue;
    }
    const auto row = static_cast<std::size_t>(
        std::min_element(time.begin(), time.end(),
                         [&](double a, double b) { return std::abs(a - r.time_s) < std::abs(b - r.time_s); }) -
        time.begin());
    ASSERT_NEAR(time[row], r.time_s, 1e-3);
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_NEAR(r.pose(axis, 3), 1e3 * table.column(std::string("measured/") + "xyz"[axis] + "_m")[row], 1e-3);
    ++compared;
  }
  EXPECT_EQ(compared, h.of("target"));
}

TEST_F(IgtlCommand, ServoSendsTheTipToo) {
  const Heard h = heard({"servo", scene("pig_2007"), "--frames", frames(250), "--no-video"});
  ASSERT_EQ(h.outcome.code, 0) << h.outcome.err;
  EXPECT_GT(h.of("target"), 5u);
  EXPECT_GT(h.of("tip"), 5u);
  EXPECT_GT(h.of("endoscope"), 0u);
}

TEST_F(IgtlCommand, APortThatIsTakenIsSaid) {
  auto socket = igtl::ServerSocket::New();
  const int port = 20000 + static_cast<int>(::getpid()) % 20000 + 5;
  ASSERT_EQ(socket->CreateServer(port), 0);
  expect_refused(4, {"track", scene("pig_2007"), "--frames", "3", "--igtl", std::to_string(port)},
                 {"--igtl " + std::to_string(port), "port"});
  expect_refused(2, {"track", scene("pig_2007"), "--igtl", "70000"}, {"--igtl"});
  socket->CloseSocket();
}

}  // namespace
}  // namespace heartservo::test
