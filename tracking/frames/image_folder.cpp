#include "tracking/frames/image_folder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <optional>
#include <regex>

#include "tracking/frames/frame.hpp"
#include "tracking/frames/picture_file.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tracking {

namespace fs = std::filesystem;

namespace {

constexpr int LAST_FIRST_NUMBER = 10000;

class ImageFiles final : public FrameSource {
 public:
  ImageFiles(std::vector<std::string> files, double rate_hz, std::string description)
      : files_(std::move(files)), rate_hz_(rate_hz), description_(std::move(description)) {
    std::string first_problem;
    for (const auto& file : files_) {
      const Picture picture = read_picture(file);
      if (picture.problem.empty()) {
        size_ = picture.grey.size();
        return;
      }
      if (first_problem.empty()) first_problem = picture.problem;
    }
    throw InputError(files_.size() == 1 ? first_problem
                                        : fmt::format("{} (none of the {} pictures of {} can be read)", first_problem,
                                                      files_.size(), description_));
  }

  bool next(Frame& frame) override {
    if (sequence_ >= files_.size()) return false;
    frame = Frame{};
    frame.sequence = sequence_;
    frame.time_s = static_cast<double>(sequence_) / rate_hz_;
    Picture picture = read_picture(files_[sequence_++]);
    frame.note = picture.problem;
    if (frame.note.empty() && picture.grey.size() != size_)
      frame.note = fmt::format("{}: is {} x {} px, the pictures before it {} x {}", files_[sequence_ - 1],
                               picture.grey.cols, picture.grey.rows, size_.width, size_.height);
    if (frame.note.empty()) {
      frame.grey = picture.grey;
      frame.colour = picture.colour;
    } else {
      frame.status = FrameStatus::UNREADABLE;
    }
    return true;
  }

  cv::Size size() const override { return size_; }
  double frame_rate_hz() const override { return rate_hz_; }
  std::optional<std::size_t> frame_count() const override { return files_.size(); }
  std::string description() const override { return description_; }

 private:
  std::vector<std::string> files_;
  double rate_hz_;
  std::string description_;
  cv::Size size_;
  std::size_t sequence_ = 0;
};

std::vector<std::string> files_of_folder(const std::string& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    std::error_code ignored;
    if (name[0] != '.' && has_picture_name(name) && !entry->is_directory(ignored)) names.push_back(name);
  }
  if (error) throw InputError(folder + ": the folder cannot be read; check its permissions");
  if (names.empty())
    throw InputError(fmt::format("{}: the folder holds no pictures; looked for {}", folder, picture_names()));
  std::sort(names.begin(), names.end(), natural_less);
  for (auto& name : names) name = (fs::path(folder) / name).string();
  return names;
}

// The number that a %d or %0Nd of this width shows in the middle of a name, if it does.
std::optional<int> number_of(const std::string& name, const std::string& head, const std::string& tail,
                             std::size_t width) {
  if (name.size() <= head.size() + tail.size() || name.compare(0, head.size(), head) != 0 ||
      name.compare(name.size() - tail.size(), tail.size(), tail) != 0)
    return std::nullopt;
  const std::string digits = name.substr(head.size(), name.size() - head.size() - tail.size());
  const bool all_digits = std::all_of(digits.begin(), digits.end(), [](unsigned char c) { return std::isdigit(c); });
  const bool padded = digits.size() > 1 && digits[0] == '0';
  if (!all_digits || digits.size() > 8 || digits.size() < width || (padded && digits.size() > width))
    return std::nullopt;
  return std::stoi(digits);
}

std::vector<std::string> files_of_pattern(const std::string& pattern) {
  const fs::path folder = fs::path(pattern).has_parent_path() ? fs::path(pattern).parent_path() : fs::path(".");
  const std::string name = fs::path(pattern).filename().string();
  static const std::regex form("([^%]*)%(?:0([1-8]))?d([^%]*)");
  std::smatch part;
  if (folder.string().find('%') != std::string::npos || !std::regex_match(name, part, form))
    throw InputError(pattern + ": is not a pattern of pictures; write one %d or %04d in the file name");
  const std::size_t width = part[2].matched ? std::stoul(part[2]) : 1;

  int first = -1, last = -1;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
    if (const auto number = number_of(entry->path().filename().string(), part[1], part[3], width)) {
      if (first < 0 || *number < first) first = *number;
      last = std::max(last, *number);
    }
  if (error) throw InputError(folder.string() + ": the folder of the pattern cannot be read; check the path");
  if (first < 0 || first > LAST_FIRST_NUMBER)
    throw InputError(fmt::format("{}: no such picture; looked for the numbers 0 to {}", pattern, LAST_FIRST_NUMBER));
  std::vector<std::string> files;
  for (int number = first; number <= last; ++number)
    files.push_back((folder / fmt::format("{}{:0{}}{}", part[1].str(), number, width, part[3].str())).string());
  return files;
}

}  // namespace

bool natural_less(const std::string& a, const std::string& b) {
  const auto digit = [](const std::string& s, std::size_t i) {
    return i < s.size() && std::isdigit(static_cast<unsigned char>(s[i]));
  };
  const auto run = [&](const std::string& s, std::size_t& i) {  // digits without leading zeros
    const std::size_t start = std::min(s.find_first_not_of('0', i), s.size());
    while (digit(s, i)) ++i;
    return s.substr(std::min(start, i), i - std::min(start, i));
  };
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (digit(a, i) && digit(b, j)) {
      const std::string x = run(a, i), y = run(b, j);
      if (x != y) return x.size() != y.size() ? x.size() < y.size() : x < y;
    } else if (a[i] != b[j]) {
      return a[i] < b[j];
    } else {
      ++i;
      ++j;
    }
  }
  return a.size() - i != b.size() - j ? a.size() - i < b.size() - j : a < b;
}

std::unique_ptr<FrameSource> open_image_files(std::vector<std::string> files, double frame_rate_hz,
                                              const std::string& description) {
  const double rate = frame_rate_hz > 0 && std::isfinite(frame_rate_hz) ? frame_rate_hz : PICTURE_RATE_HZ;
  return std::make_unique<ImageFiles>(std::move(files), rate, description);
}

std::unique_ptr<FrameSource> open_image_folder(const std::string& path, double frame_rate_hz) {
  std::error_code error;
  if (fs::is_directory(path, error)) return open_image_files(files_of_folder(path), frame_rate_hz, path);
  if (path.find('%') != std::string::npos) return open_image_files(files_of_pattern(path), frame_rate_hz, path);
  throw InputError(path + ": no such folder; name a folder of pictures or a pattern like dir/img%04d.png");
}

}  // namespace heartservo::tracking
