// usb_camera [--jpeg FILE...] [--fault NAME FRAME]: a USB camera made of software, 640x480 at 12.5 Hz in YUYV and
// MJPEG, that the kernel's own uvcvideo drives. Faults, once the frame of that number is reached: unplug (it ends),
// freeze (no more data), error (a transfer fails), short (half a frame), garbage (a frame's bytes are noise).
#include <sys/types.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <deque>
#include <fstream>
#include <iterator>

#include "tests/vm/usb_camera/descriptors.hpp"
#include "tests/vm/usb_camera/usbip_link.hpp"

namespace {

using namespace heartservo::test;

double now_s() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

class Camera {
 public:
  Camera(std::vector<Bytes> jpegs, std::string fault, long at)
      : jpegs_(std::move(jpegs)), fault_(std::move(fault)), at_(at) {
    probe_ = commit_ = Bytes(26);
    settle(probe_);
    settle(commit_);
  }

  /// One turn; false when it is unplugged.
  bool turn() {
    const bool may_send = streaming_ && !waiting_.empty() && !frozen_;
    const double wait = rest_.empty() ? std::max(0.0, due_s_ - now_s()) : 0;
    if (const auto transfer = link_.next(may_send ? static_cast<int>(1e3 * wait) : 1000)) return take(*transfer), true;
    if (!may_send || now_s() < due_s_) return true;
    if (rest_.empty() && !begin_frame()) return false;
    if (!frozen_) send_part();
    return true;
  }

 private:
  void take(const Transfer& t) {
    if (t.is_unlink) {
      const auto found =
          std::find_if(waiting_.begin(), waiting_.end(), [&](const auto& w) { return w.number == t.unlink; });
      const bool was_there = found != waiting_.end();
      if (was_there) waiting_.erase(found);
      link_.answer_unlink(t, was_there);
      if (waiting_.empty()) streaming_ = false;
    } else if (t.endpoint == 1) {
      if (!streaming_) {
        streaming_ = true;
        rest_.clear();
        due_s_ = now_s();
      }
      waiting_.push_back(t);
    } else {
      control(t);
    }
  }

  // Standard requests, and the negotiation of format and size (VS_PROBE_CONTROL 1, VS_COMMIT_CONTROL 2).
  void control(const Transfer& t) {
    const int type = t.setup[0], request = t.setup[1], low = t.setup[2], high = t.setup[3], index = t.setup[4];
    const std::size_t length = static_cast<std::size_t>(t.setup[6] | t.setup[7] << 8);
    Bytes reply;
    bool known = true;
    if (type == 0x80 && request == 6) {
      if (high == 1)
        reply = device_descriptor();
      else if (high == 2)
        reply = configuration_descriptor();
      else if (high == 3)
        reply = string_descriptor(low);
      else
        known = false;
    } else if (type == 0x80 && request == 0) {
      reply = {0, 0};
    } else if (type == 0xa1 && index == 1 && (high == 1 || high == 2)) {
      if (request == 0x85)
        reply = {26, 0};  // GET_LEN
      else if (request == 0x86)
        reply = {3};  // GET_INFO
      else
        reply = high == 1 ? probe_ : commit_;  // GET_CUR, MIN, MAX, DEF
    } else if (type == 0x21 && request == 1 && index == 1 && t.data.size() >= 26) {
      Bytes& to = high == 1 ? probe_ : commit_;
      to.assign(t.data.begin(), t.data.begin() + 26);
      settle(to);
    } else if (type == 0xa1 && index == 0 && high == 2) {
      reply = {0};
    } else {
      known = (type & 0x60) == 0;  // set configuration, set interface, clear halt
    }
    if (reply.size() > length) reply.resize(length);
    link_.answer(t, reply, known ? 0 : -EPIPE);
  }

  // The nearest thing that there is to what was asked for.
  static void settle(Bytes& control) {
    if (control[2] != MJPEG) control[2] = YUYV;
    control[3] = 1;
    const auto put = [&](std::size_t at, std::uint32_t value) {
      for (std::size_t i = 0; i < 4; ++i) control[at + i] = static_cast<std::uint8_t>(value >> 8 * i);
    };
    put(4, INTERVAL);
    put(18, WIDTH * HEIGHT * 2);
    put(22, PAYLOAD);
  }

  bool begin_frame() {
    due_s_ = std::max(due_s_ + 1e-7 * INTERVAL, now_s() - 0.5);
    if (commit_[2] == MJPEG && !jpegs_.empty()) {
      rest_ = jpegs_[static_cast<std::size_t>(count_) % jpegs_.size()];
    } else {
      rest_.resize(WIDTH * HEIGHT * 2);
      for (int row = 0; row < HEIGHT; ++row)  // a grey ramp that moves
        for (int i = 0; i < WIDTH; ++i) {
          const auto at = static_cast<std::size_t>(2 * (row * WIDTH + i));
          rest_[at] = static_cast<std::uint8_t>(row / 2 + 4 * count_);
          rest_[at + 1] = 128;
        }
    }
    position_ = 0;
    toggle_ ^= 1;
    const bool now = count_++ == at_;
    failing_ = now && fault_ == "error";
    if (!now) return true;
    std::fprintf(stderr, "usb_camera: %s at frame %ld\n", fault_.c_str(), at_);
    if (fault_ == "unplug") return false;
    if (fault_ == "freeze") frozen_ = true;
    if (fault_ == "short") rest_.resize(rest_.size() / 2);
    if (fault_ == "garbage")
      for (std::size_t i = 600; i + 2 < rest_.size(); ++i) rest_[i] = static_cast<std::uint8_t>(i * 7919 >> 3 & 0x7f);
    return true;
  }

  // A payload of the stream: a header of two bytes, then pixels.
  void send_part() {
    const Transfer t = waiting_.front();
    waiting_.pop_front();
    const std::size_t room = t.length - 2, part = std::min(room, rest_.size() - position_);
    const bool last = position_ + part >= rest_.size();
    Bytes payload{2, static_cast<std::uint8_t>(0x80 | toggle_ | (last ? 2 : 0))};
    payload.insert(payload.end(), rest_.begin() + static_cast<std::ptrdiff_t>(position_),
                   rest_.begin() + static_cast<std::ptrdiff_t>(position_ + part));
    if (failing_)
      link_.answer(t, {}, -EPROTO);
    else
      link_.answer(t, payload);
    position_ += part;
    if (last) rest_.clear();
  }

  UsbIpLink link_;
  std::vector<Bytes> jpegs_;
  std::string fault_;
  long at_, count_ = 0;
  Bytes probe_, commit_, rest_;  // rest_: of the frame that is being sent
  std::size_t position_ = 0;
  int toggle_ = 0;
  bool streaming_ = false, frozen_ = false, failing_ = false;
  double due_s_ = 0;
  std::deque<Transfer> waiting_;
};

}  // namespace

int main(int argc, char** argv) {
  std::vector<Bytes> jpegs;
  std::string fault;
  long at = -1;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--jpeg") {
      for (; i + 1 < argc && argv[i + 1][0] != '-'; ++i) {
        std::ifstream in(argv[i + 1], std::ios::binary);
        jpegs.emplace_back(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
      }
    } else if (word == "--fault" && i + 2 < argc) {
      fault = argv[i + 1];
      at = std::atol(argv[i + 2]);
      i += 2;
    } else {
      std::fprintf(stderr, "usb_camera: '%s' is not known; see the source\n", argv[i]);
      return 2;
    }
  }
  std::signal(SIGPIPE, SIG_IGN);
  try {
    Camera camera(std::move(jpegs), fault, at);
    while (camera.turn()) continue;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "usb_camera: %s\n", e.what());
    return 1;
  }
}
