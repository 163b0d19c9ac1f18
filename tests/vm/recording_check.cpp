// recording_check: looks at what the tests in the virtual machine recorded.
//
//   recording_check colour RECORDING B G R TOLERANCE       every picture's middle has this colour
//   recording_check raw SOURCE FILE WIDTH HEIGHT COUNT     writes grey frames one after the other, for v4l2-ctl to send
//   recording_check jpegs SOURCE FOLDER WIDTH HEIGHT COUNT  writes colour JPEGs, for usb_camera to send
//   recording_check frames RECORDING FILE WIDTH HEIGHT LEAST   every recorded picture is one of FILE, bit for bit, they
//                                                          come in its order, and LEAST different ones are there
//   recording_check track LIVE.csv FILES.csv               every place tracked live is one that was tracked in the
//   files
#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <set>
#include <string>
#include <vector>

#include "tracking/frames/frame.hpp"
#include "tracking/frames/open_source.hpp"
#include "tracking/settings/csv_rows.hpp"

namespace {

using namespace heartservo;
using tracking::Frame;

[[noreturn]] void fail(const std::string& why) {
  fmt::print("recording_check: {}\n", why);
  std::exit(1);
}

int colour(const std::vector<std::string>& a) {
  const auto source = tracking::open_source(a[0], 0);
  const cv::Scalar wanted(std::stod(a[1]), std::stod(a[2]), std::stod(a[3]));
  Frame frame;
  int count = 0;
  for (; source->next(frame); ++count) {
    cv::Mat picture = frame.colour.empty() ? frame.grey : frame.colour;
    const cv::Rect middle(picture.cols / 4, picture.rows / 4, picture.cols / 2, picture.rows / 2);
    const cv::Scalar is = cv::mean(picture(middle));
    for (int i = 0; i < picture.channels(); ++i)
      if (std::abs(is[i] - wanted[i]) > std::stod(a[4]))
        fail(fmt::format("frame {} is {:.1f}, {:.1f}, {:.1f}", count, is[0], is[1], is[2]));
  }
  if (count == 0) fail("no frame");
  fmt::print("{} frames of the right colour\n", count);
  return 0;
}

int raw(const std::vector<std::string>& a) {
  const auto source = tracking::open_source(a[0], 0);
  const cv::Size size(std::stoi(a[2]), std::stoi(a[3]));
  std::ofstream out(a[1], std::ios::binary);
  Frame frame;
  int count = 0;
  for (; count < std::stoi(a[4]) && source->next(frame); ++count) {
    if (frame.grey.empty()) fail(frame.note);
    cv::Mat whole(size, CV_8UC1, cv::Scalar(16));
    const cv::Rect part(0, 0, std::min(size.width, frame.grey.cols), std::min(size.height, frame.grey.rows));
    frame.grey(part).copyTo(whole(part));
    out.write(reinterpret_cast<const char*>(whole.data), static_cast<std::streamsize>(whole.total()));
  }
  out.close();
  if (!out || count == 0) fail("nothing written");
  fmt::print("{}\n", count);
  return 0;
}

int jpegs(const std::vector<std::string>& a) {
  const auto source = tracking::open_source(a[0], 0);
  const cv::Size size(std::stoi(a[2]), std::stoi(a[3]));
  Frame frame;
  int count = 0;
  for (; count < std::stoi(a[4]) && source->next(frame); ++count) {
    cv::Mat bgr = frame.colour, whole(size, CV_8UC3, cv::Scalar(16, 16, 16));
    if (bgr.empty()) cv::cvtColor(frame.grey, bgr, cv::COLOR_GRAY2BGR);
    const cv::Rect part(0, 0, std::min(size.width, bgr.cols), std::min(size.height, bgr.rows));
    bgr(part).copyTo(whole(part));
    if (!cv::imwrite(fmt::format("{}/{:03}.jpg", a[1], count), whole, {cv::IMWRITE_JPEG_QUALITY, 95}))
      fail("nothing written");
  }
  fmt::print("{}\n", count);
  return count > 0 ? 0 : 1;
}

int frames(const std::vector<std::string>& a) {
  std::ifstream in(a[1], std::ios::binary);
  const std::size_t bytes = std::stoul(a[2]) * std::stoul(a[3]);
  std::map<std::string, std::size_t> sent;  // picture to its number
  std::string picture(bytes, '\0');
  while (in.read(picture.data(), static_cast<std::streamsize>(bytes))) sent.emplace(picture, sent.size());
  if (sent.empty()) fail("nothing was sent");
  const auto source = tracking::open_source(a[0], 0);
  Frame frame;
  std::set<std::size_t> seen;
  std::size_t count = 0, foreign = 0, back = 0, last = 0;
  for (; source->next(frame); ++count) {
    picture.assign(reinterpret_cast<const char*>(frame.grey.data), frame.grey.total());
    const auto found = sent.find(picture);
    if (found == sent.end()) {
      if (!seen.empty()) ++foreign;  // before the first: what the input showed before the sender began
      continue;
    }
    const std::size_t ahead = (found->second + sent.size() - last) % sent.size();
    if (!seen.empty() && ahead > sent.size() / 2) ++back;
    last = found->second;
    seen.insert(last);
  }
  fmt::print("{} frames recorded, {} of {} different ones sent are among them, {} are none of them, {} out of order\n",
             count, seen.size(), sent.size(), foreign, back);
  return foreign == 0 && back == 0 && seen.size() >= std::stoul(a[4]) ? 0 : 1;
}

struct Place {
  double u, v;
};

std::vector<Place> places(const std::string& file) {
  CsvRows rows(file, "a track");
  const auto u = rows.find("displacement/u_px"), v = rows.find("displacement/v_px");
  if (!u || !v) rows.fail("has no displacement");
  std::vector<Place> result;
  while (rows.next()) result.push_back({rows.number(*u), rows.number(*v)});
  return result;
}

int track(const std::vector<std::string>& a) {
  auto live = places(a[0]);
  const auto files = places(a[1]);
  // displacements count from the first frame, which differs: align the two by the one live frame that fits best
  std::size_t best_close = 0;
  double worst = NAN;
  for (std::size_t shift = 0; shift < files.size() && best_close < live.size(); ++shift) {
    std::size_t close = 0;
    double largest = 0;
    for (const Place& p : live) {
      double nearest = 1e18;  // squared
      for (const Place& q : files) {
        const double u = p.u + files[shift].u - q.u, v = p.v + files[shift].v - q.v, d = u * u + v * v;
        if (d < nearest) nearest = d;  // false for NaN, a place that was lost
      }
      close += nearest < 0.15 * 0.15;
      largest = std::max(largest, std::sqrt(nearest));
    }
    if (close > best_close) best_close = close, worst = largest;
  }
  fmt::print("{} of {} places tracked live are within 0.15 px of the way in the files; the farthest {:.2f} px\n",
             best_close, live.size(), worst);
  return best_close >= 0.97 * static_cast<double>(live.size()) && live.size() > 20 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> all(argv + 1, argv + argc);
  const std::map<std::string, std::pair<std::size_t, int (*)(const std::vector<std::string>&)>> commands{
      {"colour", {5, colour}},
      {"raw", {5, raw}},
      {"jpegs", {5, jpegs}},
      {"frames", {5, frames}},
      {"track", {2, track}}};
  const auto command = all.empty() ? commands.end() : commands.find(all[0]);
  if (command == commands.end() || all.size() != command->second.first + 1) fail("wrong usage; see the source");
  try {
    return command->second.second({all.begin() + 1, all.end()});
  } catch (const std::exception& e) {
    fail(e.what());
  }
}
