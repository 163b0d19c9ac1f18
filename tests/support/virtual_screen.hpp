#pragma once
// An X server without a screen (Xvfb) for a test: keys and mouse go in by xdotool, pictures come out.
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <opencv2/core/mat.hpp>
#include <string>
#include <thread>
#include <vector>

#include "tests/support/temporary_folder.hpp"

namespace heartservo::test {

class VirtualScreen {
 public:
  /// Sets DISPLAY while it lives. `ready()` is false where Xvfb or xdotool is missing.
  VirtualScreen() {
    if (std::system("command -v Xvfb >/dev/null && command -v xdotool >/dev/null") != 0) return;
    int number[2];
    if (::pipe(number) != 0) return;
    const std::string pictures = folder_.path(), to = std::to_string(number[1]);
    server_ = ::fork();
    if (server_ == 0) {
      ::close(number[0]);
      ::execlp("Xvfb", "Xvfb", "-displayfd", to.c_str(), "-screen", "0", "1280x1000x24", "-nolisten", "tcp", "-fbdir",
               pictures.c_str(), static_cast<char*>(nullptr));
      ::_exit(127);
    }
    ::close(number[1]);
    std::string display = ":";
    for (char c = 0; ::read(number[0], &c, 1) == 1 && c != '\n';) display += c;
    ::close(number[0]);
    ready_ = display.size() > 1;
    if (const char* before = std::getenv("DISPLAY")) before_ = before;
    if (ready_) ::setenv("DISPLAY", display.c_str(), 1);
  }
  ~VirtualScreen() {
    if (before_.empty())
      ::unsetenv("DISPLAY");
    else
      ::setenv("DISPLAY", before_.c_str(), 1);
    stop();
  }
  VirtualScreen(const VirtualScreen&) = delete;
  VirtualScreen& operator=(const VirtualScreen&) = delete;

  bool ready() const { return ready_; }
  void stop() {
    if (server_ > 0) ::kill(server_, SIGTERM), ::waitpid(server_, nullptr, 0);
    server_ = 0;
  }

  /// What is on the screen now, BGR.
  cv::Mat picture() const {
    const std::string xwd = read_text(folder_ / "Xvfb_screen0");
    if (xwd.size() < 100) return {};
    const auto word = [&](std::size_t i) {
      const auto* b = reinterpret_cast<const unsigned char*>(xwd.data()) + 4 * i;
      return static_cast<std::size_t>(b[0]) << 24 | static_cast<std::size_t>(b[1]) << 16 |
             static_cast<std::size_t>(b[2]) << 8 | b[3];
    };
    const std::size_t begin = word(0) + 12 * word(19), width = word(4), height = word(5), stride = word(12);
    if (word(11) != 32 || xwd.size() < begin + height * stride) return {};
    cv::Mat bgr(static_cast<int>(height), static_cast<int>(width), CV_8UC3);
    for (int v = 0; v < bgr.rows; ++v)
      for (int u = 0; u < bgr.cols; ++u) {
        const char* p = xwd.data() + begin + static_cast<std::size_t>(v) * stride + 4 * static_cast<std::size_t>(u);
        bgr.at<cv::Vec3b>(v, u) = {static_cast<std::uint8_t>(p[0]), static_cast<std::uint8_t>(p[1]),
                                   static_cast<std::uint8_t>(p[2])};
      }
    return bgr;
  }

  /// xdotool with these arguments.
  static bool act(const std::string& what) {
    return std::system(("xdotool " + what + " >/dev/null 2>&1").c_str()) == 0;
  }

 private:
  TemporaryFolder folder_;
  pid_t server_ = 0;
  bool ready_ = false;
  std::string before_;
};

}  // namespace heartservo::test
