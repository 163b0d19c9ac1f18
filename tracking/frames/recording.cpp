#include "tracking/frames/recording.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>

#include "tracking/frames/frame.hpp"
#include "tracking/frames/image_folder.hpp"
#include "tracking/frames/video_file.hpp"
#include "tracking/settings/csv_rows.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tracking {

namespace {

constexpr std::array COLUMNS{"time_s",
                             "frame/sequence",
                             "frame/status",
                             "capture/device_s",
                             "capture/dequeued_s",
                             "capture/decoded_s",
                             "capture/start_of_exposure",
                             "capture/clock_is_monotonic",
                             "capture/device_sequence",
                             "capture/flags",
                             "capture/missing",
                             "capture/skipped"};

std::vector<Frame> read_rows(const std::filesystem::path& file) {
  CsvRows rows(file, "what 'heartservo capture' writes");
  std::array<std::size_t, COLUMNS.size()> column{};
  for (std::size_t i = 0; i < COLUMNS.size(); ++i) {
    const auto found = rows.find(COLUMNS[i]);
    if (!found) rows.fail(fmt::format("has no column {}", COLUMNS[i]));
    column[i] = *found;
  }
  std::vector<Frame> frames;
  while (rows.next()) {
    const auto value = [&](std::size_t i) { return rows.number(column[i]); };
    Frame& frame = frames.emplace_back();
    frame.time_s = value(0);
    if (!std::isfinite(frame.time_s) || (frames.size() > 1 && frame.time_s <= frames[frames.size() - 2].time_s))
      rows.fail("time_s does not increase");
    frame.sequence = static_cast<std::uint64_t>(value(1));
    frame.status = value(2) == static_cast<double>(FrameStatus::NOT_LIVE) ? FrameStatus::NOT_LIVE : FrameStatus::OK;
    if (std::isnan(value(3))) continue;
    const auto count = [&](std::size_t i) { return static_cast<std::uint32_t>(value(i)); };
    frame.capture = CaptureStamp{value(3), value(4), value(5),  value(6) != 0, value(7) != 0,
                                 count(8), count(9), count(10), count(11)};
  }
  if (frames.empty()) throw InputError(file.string() + ": the recording has no frame");
  return frames;
}

class Recording final : public FrameSource {
 public:
  explicit Recording(const std::filesystem::path& folder)
      : folder_(folder.string()), rows_(read_rows(folder / RECORDED_ROWS)) {
    std::vector<double> intervals;
    for (std::size_t i = 1; i < rows_.size(); ++i) intervals.push_back(rows_[i].time_s - rows_[i - 1].time_s);
    if (!intervals.empty()) {
      const auto middle = intervals.begin() + static_cast<std::ptrdiff_t>(intervals.size() / 2);
      std::nth_element(intervals.begin(), middle, intervals.end());
      rate_hz_ = 1 / *middle;
    }
    const auto video = folder / RECORDED_VIDEO;
    pictures_ = std::filesystem::exists(video) ? open_video_file(video.string(), rate_hz_)
                                               : open_image_folder((folder / RECORDED_PICTURES).string(), rate_hz_);
  }

  bool next(Frame& frame) override {
    if (index_ >= rows_.size() || !pictures_->next(frame)) return false;
    const Frame& row = rows_[index_++];
    frame.time_s = row.time_s;
    frame.sequence = row.sequence;
    frame.capture = row.capture;
    if (frame.status == FrameStatus::OK && row.status != FrameStatus::OK) {
      frame.status = row.status;
      frame.note = fmt::format("{}: frame {} was frozen or without signal when it was recorded", folder_, row.sequence);
    }
    return true;
  }

  cv::Size size() const override { return pictures_->size(); }
  double frame_rate_hz() const override { return rate_hz_; }
  std::optional<std::size_t> frame_count() const override { return rows_.size(); }
  std::string description() const override { return folder_; }

 private:
  std::string folder_;
  std::vector<Frame> rows_;  // without pictures
  std::unique_ptr<FrameSource> pictures_;
  double rate_hz_ = PICTURE_RATE_HZ;
  std::size_t index_ = 0;
};

}  // namespace

std::string recorded_header() { return fmt::format("{}\n", fmt::join(COLUMNS, ",")); }

std::string recorded_row(const Frame& frame) {
  std::string row = fmt::format("{},{},{}", frame.time_s, frame.sequence, static_cast<int>(frame.status));
  if (!frame.capture) return row + std::string(COLUMNS.size() - 3, ',') + "\n";
  const CaptureStamp& c = *frame.capture;
  return row + fmt::format(",{},{},{},{},{},{},{},{},{}\n", c.device_s, c.dequeued_s, c.decoded_s,
                           c.start_of_exposure ? 1 : 0, c.clock_is_monotonic ? 1 : 0, c.device_sequence, c.flags,
                           c.missing, c.skipped);
}

bool is_recording(const std::filesystem::path& folder) {
  std::ifstream rows(folder / RECORDED_ROWS);
  std::string header;
  std::error_code error;
  return std::getline(rows, header) && header.find("capture/device_s") != std::string::npos &&
         (std::filesystem::exists(folder / RECORDED_VIDEO, error) ||
          std::filesystem::is_directory(folder / RECORDED_PICTURES, error));
}

std::unique_ptr<FrameSource> open_recording(const std::filesystem::path& folder) {
  return std::make_unique<Recording>(folder);
}

}  // namespace heartservo::tracking
