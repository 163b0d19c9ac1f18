#pragma once
// Writes frames to disk in a thread of its own, so that no disk holds up the camera.
#include <condition_variable>
#include <cstdint>
#include <cstdio>
#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "tools/capture/picture_writer.hpp"
#include "tracking/frames/frame.hpp"

namespace heartservo::tools {

struct RecorderOptions {
  std::size_t most_queued_bytes = std::size_t(256) << 20;    ///< of pictures that wait to be written
  std::uint64_t least_free_bytes = std::uint64_t(16) << 20;  ///< kept free, to end the files; and four pictures more
  /// Free bytes on the disk; empty: asked of the file system.
  std::function<std::uint64_t()> free_bytes;
};

class Recorder {
 public:
  /// `folder` gets frames.csv beside what `pictures` writes. Throws ConfigError.
  Recorder(const std::filesystem::path& folder, std::unique_ptr<PictureWriter> pictures,
           const RecorderOptions& options);
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// Takes the frame to be written, its colour picture where it has one. Does not wait. False: the queue is full and
  /// the frame is dropped, or the recording has stopped.
  bool offer(const tracking::Frame& frame);

  /// Writes what waits and ends the files.
  void finish();

  std::uint64_t written() const;
  std::uint64_t dropped() const;    ///< because the disk was too slow
  std::size_t most_queued() const;  ///< frames
  /// Why it stopped by itself: the disk is full, or a file cannot be written; "" while all is well. What was written
  /// until then is whole.
  std::string stopped() const;

 private:
  void run();
  bool write(const tracking::Frame& frame);  // false: it has stopped

  RecorderOptions options_;
  std::filesystem::path folder_;
  std::unique_ptr<PictureWriter> pictures_;
  std::FILE* rows_ = nullptr;
  mutable std::mutex mutex_;  // guards what follows
  std::condition_variable changed_;
  std::deque<tracking::Frame> queue_;
  std::size_t queued_bytes_ = 0, most_queued_ = 0;
  std::uint64_t written_ = 0, dropped_ = 0;
  std::string stopped_;
  bool ending_ = false;
  std::thread thread_;
};

}  // namespace heartservo::tools
