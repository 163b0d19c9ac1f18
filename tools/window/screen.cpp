#include "tools/window/screen.hpp"

#include <visp3/core/vpDisplay.h>
#include <visp3/core/vpException.h>
#include <visp3/core/vpImage.h>
#include <visp3/gui/vpDisplayX.h>

#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <opencv2/imgproc.hpp>

#include "tracking/settings/errors.hpp"

// last: it defines Complex, None and other common words
#include <X11/Xlib.h>

namespace heartservo::tools {

namespace {

// A window manager closes a window of ViSP by cutting its connection, upon which Xlib ends the process when this
// returns. So it does not: the thread that talked to the display stays here.
std::atomic<bool> connection_lost = false;

int stay(::Display*) {
  connection_lost = true;
  for (;;) ::pause();
}

int ignore(::Display*, XErrorEvent*) { return 0; }

}  // namespace

struct Screen::Display {
  vpImage<vpRGBa> picture;
  vpDisplayX window;
};

Screen::Screen(const std::string& title, cv::Size size) : display_(new Display) {
  const char* name = std::getenv("DISPLAY");
  if (name == nullptr || *name == '\0')
    throw DeviceError("--show: there is no display (DISPLAY is not set); run it in a graphical session");
  display_->picture.resize(static_cast<unsigned>(size.height), static_cast<unsigned>(size.width));
  connection_lost = false;
  XSetIOErrorHandler(stay);
  XSetErrorHandler(ignore);
  try {
    display_->window.init(display_->picture, -1, -1, title);
  } catch (const vpException& e) {
    throw DeviceError(std::string("--show: the display '") + name + "' cannot be used: " + e.getStringMessage());
  }
}

Screen::~Screen() = default;

void Screen::show(const cv::Mat& bgr) {
  auto& picture = display_->picture;
  cv::Mat to(static_cast<int>(picture.getHeight()), static_cast<int>(picture.getWidth()), CV_8UC4, picture.bitmap);
  if (bgr.size() != to.size()) return;
  cv::cvtColor(bgr, to, cv::COLOR_BGR2RGBA);
  vpDisplay::display(picture);
  vpDisplay::flush(picture);
}

std::optional<std::string> Screen::key() {
  std::string key;
  if (!vpDisplay::getKeyboardEvent(display_->picture, key, false)) return {};
  return key;
}

std::optional<cv::Point> Screen::click() {
  vpImagePoint at;
  vpMouseButton::vpMouseButtonType button = vpMouseButton::none;
  while (vpDisplay::getClick(display_->picture, at, button, false))
    if (button == vpMouseButton::button1) return cv::Point(static_cast<int>(at.get_u()), static_cast<int>(at.get_v()));
  return {};
}

bool Screen::lost() { return connection_lost; }

}  // namespace heartservo::tools
