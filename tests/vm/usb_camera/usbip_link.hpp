#pragma once
// The kernel's side of USB/IP: a device made of software is plugged into vhci-hcd by handing it one end of a socket
// pair.
#include <arpa/inet.h>
#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <string>

#include "tests/vm/usb_camera/descriptors.hpp"

namespace heartservo::test {

/// A transfer that the kernel asks for, or wants back (`unlink` is its number then).
struct Transfer {
  std::uint32_t number = 0, unlink = 0, length = 0;
  int endpoint = 0;
  bool to_host = false, is_unlink = false;
  std::array<std::uint8_t, 8> setup{};  ///< of endpoint 0
  Bytes data;                           ///< from the host
};

class UsbIpLink {
 public:
  /// Plugs the device in, at high speed. Throws std::runtime_error.
  UsbIpLink() {
    int pair[2];
    if (::socketpair(AF_UNIX, SOCK_STREAM, 0, pair) != 0) throw std::runtime_error("no socket pair");
    socket_ = pair[0];
    const int room = 4 << 20;
    ::setsockopt(socket_, SOL_SOCKET, SO_SNDBUF, &room, sizeof room);
    const std::string plug = "0 " + std::to_string(pair[1]) + " 65538 3";  // port, socket, device, high speed
    const int attach = ::open("/sys/devices/platform/vhci_hcd.0/attach", O_WRONLY);
    const bool done = attach >= 0 && ::write(attach, plug.data(), plug.size()) == static_cast<ssize_t>(plug.size());
    if (attach >= 0) ::close(attach);
    ::close(pair[1]);
    if (!done) throw std::runtime_error("vhci-hcd does not take the device; is it loaded, and are you root?");
  }
  ~UsbIpLink() { ::close(socket_); }  // unplugs it
  UsbIpLink(const UsbIpLink&) = delete;
  UsbIpLink& operator=(const UsbIpLink&) = delete;

  /// Waits `timeout_ms` for the next transfer. Throws std::runtime_error when the kernel has hung up.
  std::optional<Transfer> next(int timeout_ms) {
    pollfd waiting{socket_, POLLIN, 0};
    if (::poll(&waiting, 1, timeout_ms) <= 0) return std::nullopt;
    std::array<std::uint32_t, 12> header{};
    read_all(header.data(), sizeof header);
    Transfer t;
    std::memcpy(t.setup.data(), &header[10], 8);
    for (std::size_t i = 0; i < 10; ++i) header[i] = ntohl(header[i]);
    t.number = header[1];
    t.is_unlink = header[0] == 2;
    t.unlink = header[5];
    t.to_host = header[3] == 1;
    t.endpoint = static_cast<int>(header[4]);
    t.length = header[6];
    if (!t.is_unlink && !t.to_host && t.length > 0) {
      t.data.resize(t.length);
      read_all(t.data.data(), t.data.size());
    }
    return t;
  }

  /// Answers with `data`, or with an error (-EPIPE: not understood, -EPROTO: the cable).
  void answer(const Transfer& t, const Bytes& data, int error = 0) {
    const auto length = static_cast<std::uint32_t>(t.to_host ? data.size() : t.data.size());
    send({3, t.number, 0, 0, 0, static_cast<std::uint32_t>(error), length, 0, 0, 0, 0, 0}, t.to_host ? data : Bytes{});
  }
  void answer_unlink(const Transfer& t, bool found) {
    send({4, t.number, 0, 0, 0, static_cast<std::uint32_t>(found ? -104 : 0), 0, 0, 0, 0, 0, 0}, {});
  }

 private:
  void read_all(void* to, std::size_t count) {
    for (auto* p = static_cast<char*>(to); count > 0;) {
      const ssize_t got = ::read(socket_, p, count);
      if (got <= 0) throw std::runtime_error("unplugged by the kernel");
      p += got;
      count -= static_cast<std::size_t>(got);
    }
  }
  void send(std::array<std::uint32_t, 12> header, const Bytes& data) {
    for (auto& word : header) word = htonl(word);
    Bytes all(sizeof header + data.size());
    std::memcpy(all.data(), header.data(), sizeof header);
    std::copy(data.begin(), data.end(), all.begin() + sizeof header);
    for (std::size_t sent = 0; sent < all.size();) {
      const ssize_t done = ::write(socket_, all.data() + sent, all.size() - sent);
      if (done <= 0) throw std::runtime_error("unplugged by the kernel");
      sent += static_cast<std::size_t>(done);
    }
  }

  int socket_ = -1;
};

}  // namespace heartservo::test
