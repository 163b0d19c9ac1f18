// A plugin of libv4l2 that makes a camera of any file that begins with "BAYERCAM": 320x240, 50 Hz, in the raw Bayer
// pattern (BGGR) that only libv4l2 converts. Its blue, green and red pixels are 60, 90 and 160 in the mean, with waves
// that move by 0.5 px a frame to the right; "BAYERCAM still" stands still. Buffers lie in the file.
#include <fcntl.h>
#include <libv4l-plugin.h>
#include <linux/videodev2.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <deque>
#include <string_view>

namespace {

constexpr std::uint32_t WIDTH = 320, HEIGHT = 240, BYTES = WIDTH * HEIGHT, STRIDE = (BYTES + 4095) & ~4095u,
                        HEADER = 4096;
constexpr double PERIOD_s = 0.02;

double now_s() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

int refuse(int error) {
  errno = error;
  return -1;
}

struct Camera {
  bool streaming = false, still = false;
  double due_s = 0;
  std::uint32_t sequence = 0, count = 0;
  std::uint8_t* memory = nullptr;
  std::deque<std::uint32_t> queued;

  ~Camera() { unmap(); }
  void unmap() {
    if (memory) ::munmap(memory, HEADER + count * STRIDE);
    memory = nullptr;
  }
  int buffers(int fd, v4l2_requestbuffers& request) {
    if (request.memory != V4L2_MEMORY_MMAP) return refuse(EINVAL);
    unmap();
    queued.clear();
    count = request.count = request.count < 8 ? request.count : 8;
    if (count == 0) return 0;
    if (::ftruncate(fd, HEADER + count * STRIDE) != 0) return -1;
    void* start = ::mmap(nullptr, HEADER + count * STRIDE, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
    if (start == MAP_FAILED) return -1;
    memory = static_cast<std::uint8_t*>(start);
    return 0;
  }
  void paint(std::uint8_t* pixel) const {
    const double shift = still ? 0 : 0.5 * sequence;
    double across[WIDTH], slowly[WIDTH], down[HEIGHT];
    for (std::uint32_t u = 0; u < WIDTH; ++u) {
      const double at = u - shift;  // no whole number of one wave is one of the other: no place looks like another
      across[u] = std::sin(at / 6);
      slowly[u] = 20 * std::sin(at * at / 3000);
    }
    for (std::uint32_t v = 0; v < HEIGHT; ++v) down[v] = 25 * std::cos(v / 7.0);
    for (std::uint32_t v = 0; v < HEIGHT; ++v)
      for (std::uint32_t u = 0; u < WIDTH; ++u) {
        const int base = v % 2 == u % 2 ? (v % 2 ? 160 : 60) : 90;
        *pixel++ = static_cast<std::uint8_t>(base + across[u] * down[v] + slowly[u]);
      }
  }
  int dequeue(v4l2_buffer& buffer) {
    if (!streaming || queued.empty()) return refuse(EINVAL);
    if (now_s() < due_s) {
      ::usleep(500);
      return refuse(EAGAIN);
    }
    if (now_s() - due_s > 0.5) {  // as a driver without free buffers
      const auto dropped = static_cast<std::uint32_t>((now_s() - due_s) / PERIOD_s);
      sequence += dropped;
      due_s += dropped * PERIOD_s;
    }
    const double stamp = due_s;
    due_s += PERIOD_s;
    buffer.index = queued.front();
    queued.pop_front();
    paint(memory + HEADER + buffer.index * STRIDE);
    buffer.bytesused = buffer.length = BYTES;
    buffer.sequence = sequence++;
    buffer.flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
    buffer.field = V4L2_FIELD_NONE;
    buffer.timestamp.tv_sec = static_cast<time_t>(stamp);
    buffer.timestamp.tv_usec = static_cast<suseconds_t>(1e6 * (stamp - static_cast<double>(buffer.timestamp.tv_sec)));
    return 0;
  }
};

int answer(Camera& camera, int fd, unsigned long request, void* argument) {
  switch (request) {
    case VIDIOC_QUERYCAP: {
      auto& c = *static_cast<v4l2_capability*>(argument);
      c = {};
      std::strcpy(reinterpret_cast<char*>(c.driver), "bayer");
      std::strcpy(reinterpret_cast<char*>(c.card), "Bayer camera");
      c.device_caps = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
      c.capabilities = c.device_caps | V4L2_CAP_DEVICE_CAPS;
      return 0;
    }
    case VIDIOC_ENUM_FMT: {
      auto& d = *static_cast<v4l2_fmtdesc*>(argument);
      if (d.index > 0) return refuse(EINVAL);
      d.pixelformat = V4L2_PIX_FMT_SBGGR8;
      return 0;
    }
    case VIDIOC_ENUM_FRAMESIZES: {
      auto& s = *static_cast<v4l2_frmsizeenum*>(argument);
      if (s.index > 0 || s.pixel_format != V4L2_PIX_FMT_SBGGR8) return refuse(EINVAL);
      s.type = V4L2_FRMSIZE_TYPE_DISCRETE;
      s.discrete = {WIDTH, HEIGHT};
      return 0;
    }
    case VIDIOC_G_FMT:
    case VIDIOC_S_FMT:
    case VIDIOC_TRY_FMT: {
      auto& pix = static_cast<v4l2_format*>(argument)->fmt.pix;
      pix = {};
      pix.width = WIDTH, pix.height = HEIGHT, pix.bytesperline = WIDTH, pix.sizeimage = BYTES;
      pix.pixelformat = V4L2_PIX_FMT_SBGGR8;
      pix.field = V4L2_FIELD_NONE;
      pix.colorspace = V4L2_COLORSPACE_SRGB;
      return 0;
    }
    case VIDIOC_REQBUFS:
      return camera.buffers(fd, *static_cast<v4l2_requestbuffers*>(argument));
    case VIDIOC_QUERYBUF: {
      auto& b = *static_cast<v4l2_buffer*>(argument);
      if (b.index >= camera.count) return refuse(EINVAL);
      b.length = BYTES;
      b.m.offset = HEADER + b.index * STRIDE;
      return 0;
    }
    case VIDIOC_QBUF:
      camera.queued.push_back(static_cast<v4l2_buffer*>(argument)->index);
      return 0;
    case VIDIOC_DQBUF:
      return camera.dequeue(*static_cast<v4l2_buffer*>(argument));
    case VIDIOC_STREAMON:
      camera.streaming = true;
      camera.due_s = now_s() + PERIOD_s;
      return 0;
    case VIDIOC_STREAMOFF:
      camera.streaming = false;
      camera.queued.clear();
      return 0;
    default:
      return refuse(ENOTTY);
  }
}

void* begin(int fd) {
  struct stat file {};
  char text[14] = {};
  if (::fstat(fd, &file) != 0 || !S_ISREG(file.st_mode) || ::pread(fd, text, sizeof text, 0) < 8) return nullptr;
  const std::string_view name(text, sizeof text);
  if (name.substr(0, 8) != "BAYERCAM") return nullptr;
  auto* camera = new Camera;
  camera->still = name == "BAYERCAM still";
  return camera;
}
void end(void* camera) { delete static_cast<Camera*>(camera); }
int request(void* camera, int fd, unsigned long what, void* argument) {
  return answer(*static_cast<Camera*>(camera), fd, what, argument);
}

}  // namespace

extern "C" __attribute__((visibility("default"))) const libv4l_dev_ops libv4l2_plugin = {
    begin, end, request, nullptr, nullptr, nullptr, nullptr, nullptr, nullptr, nullptr, nullptr, nullptr};
