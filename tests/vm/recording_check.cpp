// recording_check: looks at what the tests in the virtual machine recorded.
//
//   recording_check colour RECORDING B G R TOLERANCE       every picture's middle has this colour
//   recording_check raw SOURCE FILE WIDTH HEIGHT COUNT     writes grey frames one after the other, for v4l2-ctl to
//   send,
//                                                          and says how many there are and what to crop to
//   recording_check jpegs SOURCE FOLDER WIDTH HEIGHT COUNT  writes colour JPEGs, for usb_camera to send
//   recording_check frames RECORDING FILE WIDTH HEIGHT CROP   every recorded picture is one of FILE, cropped, bit for
//                                                          bit, they come in its order, and none of FILE is missing
//   recording_check track LIVE.csv FILES.csv TIMES         the places tracked live are those tracked in the files, in
//                                                          their order, from the first to the last; the files hold
//                                                          every picture TIMES times
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
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
  cv::Rect part;
  int count = 0;
  for (; count < std::stoi(a[4]) && source->next(frame); ++count) {
    if (frame.grey.empty()) fail(frame.note);
    cv::Mat whole(size, CV_8UC1, cv::Scalar(16));
    part = {0, 0, std::min(size.width, frame.grey.cols), std::min(size.height, frame.grey.rows)};
    frame.grey(part).copyTo(whole(part));
    out.write(reinterpret_cast<const char*>(whole.data), static_cast<std::streamsize>(whole.total()));
  }
  out.close();
  if (!out || count == 0) fail("nothing written");
  fmt::print("{} 0:0:{}:{}\n", count, part.width, part.height);
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
  cv::Mat whole(std::stoi(a[3]), std::stoi(a[2]), CV_8UC1);
  cv::Rect crop;
  if (std::sscanf(a[4].c_str(), "%d:%d:%d:%d", &crop.x, &crop.y, &crop.width, &crop.height) != 4) fail("no crop");
  const auto bytes = [](const cv::Mat& m) { return std::string(reinterpret_cast<const char*>(m.data), m.total()); };
  std::map<std::string, std::size_t> sent;  // picture to its number
  while (in.read(reinterpret_cast<char*>(whole.data), static_cast<std::streamsize>(whole.total())))
    sent.emplace(bytes(whole(crop).clone()), sent.size());
  if (sent.empty()) fail("nothing was sent");
  const auto source = tracking::open_source(a[0], 0);
  Frame frame;
  std::set<std::size_t> seen;
  std::size_t count = 0, foreign = 0, back = 0, last = 0;
  for (; source->next(frame); ++count) {
    const auto found = sent.find(bytes(frame.grey));
    if (found == sent.end()) {
      if (!seen.empty()) ++foreign;  // before the first: what the input showed before the sender began
      continue;
    }
    back += !seen.empty() && found->second < last;
    last = found->second;
    seen.insert(last);
  }
  fmt::print("{} frames recorded, {} of {} different ones sent are among them, {} are none of them, {} out of order\n",
             count, seen.size(), sent.size(), foreign, back);
  return foreign == 0 && back == 0 && seen.size() == sent.size() ? 0 : 1;
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

// The live rows are laid onto those of the files in order, from the first to the last, each on the same row as the one
// before or one of the next few, so that the distances together are least. A tracker that sees a picture again comes
// nearer, so a picture's place is where it came to in the end: the last of the TIMES rows of the files, and the nearest
// live row among those laid onto any of these.
int track(const std::vector<std::string>& a) {
  const auto live = places(a[0]), files = places(a[1]);
  const std::size_t times = std::stoul(a[2]), rows = files.size(), pictures = rows / times;
  const std::size_t most_skipped = 2 * times - 1;
  constexpr double FAR = 10, CLOSE = 0.15;  // px
  if (live.empty() || pictures == 0) fail("no row");
  const auto distance = [](const Place& p, const Place& q) {
    const double d = std::hypot(p.u - q.u, p.v - q.v);
    return d < FAR ? d : FAR;  // also for NaN, a place that was lost
  };
  std::vector<double> least(rows, 1e18);
  std::vector<std::vector<std::size_t>> from(live.size(), std::vector<std::size_t>(rows, 0));
  for (std::size_t i = 0; i < live.size(); ++i) {
    std::vector<double> next(rows);
    for (std::size_t k = 0; k < rows; ++k) {
      std::size_t best = k;
      for (std::size_t j = k - std::min(k, most_skipped + 1); j < k; ++j)
        if (least[j] < least[best]) best = j;
      from[i][k] = best;
      next[k] = (i > 0 ? least[best] : k > 0 ? 1e18 : 0) + distance(live[i], files[k]);
    }
    least = next;
  }
  std::vector<double> nearest(pictures, 2 * FAR);  // until it is seen
  for (std::size_t i = live.size(), k = pictures * times - 1; i-- > 0; k = from[i][k]) {
    const std::size_t picture = k / times;
    nearest[picture] = std::min(nearest[picture], distance(live[i], files[picture * times + times - 1]));
  }
  const auto unseen = std::erase_if(nearest, [](double d) { return d > FAR; });
  const auto close = std::count_if(nearest.begin(), nearest.end(), [](double d) { return d < CLOSE; });
  const double farthest = nearest.empty() ? FAR : *std::max_element(nearest.begin(), nearest.end());
  fmt::print(
      "{} places tracked live, in order: {} of {} pictures within {} px of their place in the files, {} not seen, the "
      "farthest {:.2f} px\n",
      live.size(), close, pictures, CLOSE, unseen, farthest);
  return static_cast<double>(close) >= 0.95 * static_cast<double>(pictures) && farthest < 3 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> all(argv + 1, argv + argc);
  const std::map<std::string, std::pair<std::size_t, int (*)(const std::vector<std::string>&)>> commands{
      {"colour", {5, colour}},
      {"raw", {5, raw}},
      {"jpegs", {5, jpegs}},
      {"frames", {5, frames}},
      {"track", {3, track}}};
  const auto command = all.empty() ? commands.end() : commands.find(all[0]);
  if (command == commands.end() || all.size() != command->second.first + 1) fail("wrong usage; see the source");
  try {
    return command->second.second({all.begin() + 1, all.end()});
  } catch (const std::exception& e) {
    fail(e.what());
  }
}
