#include "tools/capture/window.hpp"

#include <visp3/core/vpDisplay.h>
#include <visp3/core/vpException.h>
#include <visp3/core/vpImage.h>
#include <visp3/gui/vpDisplayX.h>

#include <cstdlib>

#include "tracking/settings/errors.hpp"

namespace heartservo::tools {

struct Window::Display {
  vpImage<unsigned char> picture;
  vpDisplayX window;
};

Window::Window(const std::string& title, cv::Size size) : display_(new Display) {
  const char* name = std::getenv("DISPLAY");
  if (name == nullptr || *name == '\0') throw ConfigError("--show: there is no display (DISPLAY is not set)");
  display_->picture.resize(static_cast<unsigned>(size.height), static_cast<unsigned>(size.width));
  try {
    display_->window.init(display_->picture, -1, -1, title);
  } catch (const vpException& e) {
    throw ConfigError(std::string("--show: the display '") + name + "' cannot be used: " + e.getStringMessage());
  }
}

Window::~Window() = default;

void Window::show(const cv::Mat& grey, const std::vector<Outline>& outlines) {
  auto& picture = display_->picture;
  cv::Mat to(static_cast<int>(picture.getHeight()), static_cast<int>(picture.getWidth()), CV_8UC1, picture.bitmap);
  if (grey.size() != to.size() || grey.type() != CV_8UC1) return;
  grey.copyTo(to);
  vpDisplay::display(picture);
  for (const Outline& outline : outlines) {
    const auto& corners = outline.corners;
    const vpColor colour(static_cast<unsigned char>(outline.bgr[2]), static_cast<unsigned char>(outline.bgr[1]),
                         static_cast<unsigned char>(outline.bgr[0]));
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const auto &a = corners[i], &b = corners[(i + 1) % corners.size()];
      vpDisplay::displayLine(picture, vpImagePoint(a.y, a.x), vpImagePoint(b.y, b.x), colour, 2);
    }
  }
  vpDisplay::flush(picture);
}

}  // namespace heartservo::tools
