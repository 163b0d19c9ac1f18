// peer_capture visp|opencv DEVICE SECONDS: reads frames as vpV4l2Grabber or cv::VideoCapture does, for docs/capture.md,
// and says what a program sees: how many frames, how long the longest call took, errors with their text.
#include <visp3/core/vpException.h>
#include <visp3/core/vpImage.h>
#include <visp3/sensor/vpV4l2Grabber.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <opencv2/core/mat.hpp>
#include <opencv2/videoio.hpp>
#include <string>
#include <thread>

namespace {

double now_s() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

// `read` gives "" for a frame, else what is wrong.
void watch(double seconds, const std::function<std::string()>& read) {
  const double begin = now_s();
  long frames = 0, errors = 0;
  double longest = 0;
  std::string last;
  while (now_s() - begin < seconds) {
    const double call = now_s();
    const std::string why = read();
    longest = std::max(longest, now_s() - call);
    if (why.empty()) {
      if (frames++ == 0) std::printf("  %.2f s: first frame\n", now_s() - begin);
      if (!last.empty()) std::printf("  %.2f s: frames again\n", now_s() - begin);
    } else {
      ++errors;
      if (last.empty()) std::printf("  %.2f s: %s\n", now_s() - begin, why.c_str());
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    last = why;
    std::fflush(stdout);
  }
  std::printf("  %ld frames, %ld errors, the longest call took %.2f s, at the end: %s\n", frames, errors, longest,
              last.empty() ? "frames" : "no frames");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  const std::string peer = argv[1], device = argv[2];
  const double seconds = std::atof(argv[3]);
  if (peer == "opencv") {
    cv::VideoCapture capture(device, cv::CAP_V4L2);
    if (!capture.isOpened()) return std::printf("  does not open\n"), 1;
    cv::Mat picture;
    watch(seconds, [&]() -> std::string { return capture.read(picture) ? "" : "read() is false"; });
    return 0;
  }
  try {
    vpV4l2Grabber grabber;
    grabber.setDevice(device);
    grabber.setScale(1);
    vpImage<unsigned char> picture;
    grabber.open(picture);
    watch(seconds, [&]() -> std::string {
      try {
        grabber.acquire(picture);
        return "";
      } catch (const vpException& e) {
        return e.getStringMessage();
      }
    });
  } catch (const vpException& e) {
    return std::printf("  does not open: %s\n", e.what()), 1;
  }
}
