#include "tracking/frames/v4l2/buffer_ring.hpp"

#include <linux/videodev2.h>

#include <algorithm>
#include <cerrno>

namespace heartservo::tracking::v4l2 {

namespace {

v4l2_buffer described(std::uint32_t index) {
  v4l2_buffer buffer{};
  buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  buffer.memory = V4L2_MEMORY_MMAP;
  buffer.index = index;
  return buffer;
}

}  // namespace

int BufferRing::map(int count) {
  v4l2_requestbuffers request{};
  request.count = static_cast<std::uint32_t>(count);
  request.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  request.memory = V4L2_MEMORY_MMAP;
  if (const int result = calls_.ioctl(fd_, VIDIOC_REQBUFS, &request); result < 0) return result;
  if (request.count < 2) return -ENOMEM;
  for (std::uint32_t i = 0; i < request.count; ++i) {
    v4l2_buffer buffer = described(i);
    if (const int result = calls_.ioctl(fd_, VIDIOC_QUERYBUF, &buffer); result < 0) return result;
    void* start = calls_.mmap(fd_, buffer.length, buffer.m.offset);
    if (start == nullptr) return -ENOMEM;
    mapped_.emplace_back(static_cast<std::uint8_t*>(start), buffer.length);
    if (const int result = calls_.ioctl(fd_, VIDIOC_QBUF, &buffer); result < 0) return result;
  }
  return 0;
}

int BufferRing::start(int count) {
  stop();
  int result = map(count);
  int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  if (result == 0) result = calls_.ioctl(fd_, VIDIOC_STREAMON, &type);
  if (result < 0) {
    if (mapped_.empty()) mapped_.emplace_back();  // buffers may have been granted though none is mapped
    stop();
  }
  return result;
}

void BufferRing::stop() {
  if (mapped_.empty()) return;
  int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  calls_.ioctl(fd_, VIDIOC_STREAMOFF, &type);
  for (const auto& buffer : mapped_)
    if (!buffer.empty()) calls_.munmap(buffer.data(), buffer.size());
  mapped_.clear();
  v4l2_requestbuffers none{};
  none.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  none.memory = V4L2_MEMORY_MMAP;
  calls_.ioctl(fd_, VIDIOC_REQBUFS, &none);
}

int BufferRing::take(Filled& filled) {
  v4l2_buffer buffer = described(0);
  if (const int result = calls_.ioctl(fd_, VIDIOC_DQBUF, &buffer); result < 0) return result;
  if (buffer.index >= mapped_.size()) return -EIO;
  filled = {buffer.index, buffer.bytesused, buffer.flags, buffer.sequence, buffer.field, 0, {}};
  filled.time_s = static_cast<double>(buffer.timestamp.tv_sec) + 1e-6 * static_cast<double>(buffer.timestamp.tv_usec);
  filled.bytes = mapped_[buffer.index].first(std::min<std::size_t>(buffer.bytesused, mapped_[buffer.index].size()));
  return 0;
}

int BufferRing::give_back(const Filled& filled) {
  v4l2_buffer buffer = described(filled.index);
  return calls_.ioctl(fd_, VIDIOC_QBUF, &buffer);
}

}  // namespace heartservo::tracking::v4l2
