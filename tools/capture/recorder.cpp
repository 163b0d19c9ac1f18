#include "tools/capture/recorder.hpp"

#include <fmt/format.h>
#include <sys/statvfs.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <limits>

#include "tracking/frames/recording.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tools {

namespace {

std::uint64_t free_on(const std::filesystem::path& folder) {
  struct statvfs disk {};
  if (::statvfs(folder.c_str(), &disk) != 0) return std::numeric_limits<std::uint64_t>::max();  // writing will tell
  return static_cast<std::uint64_t>(disk.f_bavail) * disk.f_frsize;
}

const cv::Mat& picture_of(const tracking::Frame& frame) { return frame.colour.empty() ? frame.grey : frame.colour; }

std::size_t bytes_of(const cv::Mat& picture) { return picture.total() * picture.elemSize(); }

}  // namespace

Recorder::Recorder(const std::filesystem::path& folder, std::unique_ptr<PictureWriter> pictures,
                   const RecorderOptions& options)
    : options_(options), folder_(folder), pictures_(std::move(pictures)) {
  if (!options_.free_bytes) options_.free_bytes = [this] { return free_on(folder_); };
  const auto file = folder / tracking::RECORDED_ROWS;
  rows_ = std::fopen(file.c_str(), "we");
  if (!rows_ || std::fputs(tracking::recorded_header().c_str(), rows_) < 0 || std::fflush(rows_) != 0) {
    const std::string why = std::strerror(errno);
    if (rows_) std::fclose(rows_);
    throw ConfigError(fmt::format("{}: cannot be written: {}", file.string(), why));
  }
  thread_ = std::thread([this] { run(); });
}

Recorder::~Recorder() {
  finish();
  std::fclose(rows_);
}

bool Recorder::offer(const tracking::Frame& frame) {
  const std::size_t bytes = bytes_of(picture_of(frame));
  const std::lock_guard lock(mutex_);
  if (!stopped_.empty() || ending_ || bytes == 0) return false;
  if (queued_bytes_ + bytes > options_.most_queued_bytes) {
    ++dropped_;
    return false;
  }
  queue_.push_back(frame);
  queued_bytes_ += bytes;
  most_queued_ = std::max(most_queued_, queue_.size());
  changed_.notify_one();
  return true;
}

void Recorder::run() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return !queue_.empty() || ending_; });
    if (queue_.empty()) return;
    const tracking::Frame frame = std::move(queue_.front());
    queue_.pop_front();
    lock.unlock();
    const bool goes_on = write(frame);
    lock.lock();
    queued_bytes_ -= bytes_of(picture_of(frame));
    if (goes_on) continue;
    dropped_ += queue_.size() + 1;
    queue_.clear();
    return;
  }
}

bool Recorder::write(const tracking::Frame& frame) {
  std::string why;
  const std::uint64_t least = options_.least_free_bytes + 4 * bytes_of(picture_of(frame)), left = options_.free_bytes();
  if (left < least) {
    why = fmt::format("the disk of {} is full ({} MB left, {} MB are needed to end the files)", folder_.string(),
                      left >> 20, least >> 20);
  } else {
    try {
      pictures_->write(picture_of(frame));
      const std::string row = tracking::recorded_row(frame);
      // flushed a row at a time: what is written stays readable whatever happens to this process
      if (std::fputs(row.c_str(), rows_) < 0 || std::fflush(rows_) != 0)
        why = fmt::format("frames.csv cannot be written: {}", std::strerror(errno));
    } catch (const std::exception& e) {
      why = e.what();
    }
  }
  const std::lock_guard lock(mutex_);
  if (why.empty()) ++written_;
  stopped_ = why;
  return why.empty();
}

void Recorder::finish() {
  {
    const std::lock_guard lock(mutex_);
    if (!thread_.joinable()) return;
    ending_ = true;
    changed_.notify_one();
  }
  thread_.join();
  pictures_->finish();
}

std::uint64_t Recorder::written() const {
  const std::lock_guard lock(mutex_);
  return written_;
}

std::uint64_t Recorder::dropped() const {
  const std::lock_guard lock(mutex_);
  return dropped_;
}

std::size_t Recorder::most_queued() const {
  const std::lock_guard lock(mutex_);
  return most_queued_;
}

std::string Recorder::stopped() const {
  const std::lock_guard lock(mutex_);
  return stopped_;
}

}  // namespace heartservo::tools
