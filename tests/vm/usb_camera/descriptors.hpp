#pragma once
// What a USB video camera (USB Video Class 1.1) with one bulk stream says of itself.
#include <cstdint>
#include <initializer_list>
#include <string>
#include <vector>

namespace heartservo::test {

using Bytes = std::vector<std::uint8_t>;

inline constexpr int WIDTH = 640, HEIGHT = 480;
inline constexpr std::uint32_t INTERVAL = 800000;  // of 100 ns: 12.5 Hz
inline constexpr std::uint32_t PAYLOAD = 16384;    // bytes of a bulk transfer
enum Format : std::uint8_t { YUYV = 1, MJPEG = 2 };

/// Little-endian numbers one after the other.
class Packer {
 public:
  Packer& u8(std::initializer_list<int> values) {
    for (const int v : values) bytes.push_back(static_cast<std::uint8_t>(v));
    return *this;
  }
  Packer& u16(std::uint32_t v) { return u8({static_cast<int>(v & 255), static_cast<int>(v >> 8 & 255)}); }
  Packer& u32(std::uint32_t v) { return u16(v & 0xffff).u16(v >> 16); }
  Packer& append(const Bytes& more) {
    bytes.insert(bytes.end(), more.begin(), more.end());
    return *this;
  }
  Bytes bytes;
};

inline Bytes device_descriptor() {
  return Packer().u8({18, 1}).u16(0x200).u8({0xef, 2, 1, 64}).u16(0x1d6b).u16(0x0102).u16(0x100).u8({1, 2, 0, 1}).bytes;
}

inline Bytes string_descriptor(int index) {
  if (index == 0) return {4, 3, 9, 4};  // English
  const std::string text = index == 1 ? "heartservo" : "Emulated Endoscope Grabber";
  Packer p;
  p.u8({static_cast<int>(2 + 2 * text.size()), 3});
  for (const char c : text) p.u8({c, 0});
  return p.bytes;
}

// One size of a format (VS_FRAME_UNCOMPRESSED 5, VS_FRAME_MJPEG 7) and the colours of the format.
inline Bytes frame_descriptor(int subtype) {
  return Packer()
      .u8({26 + 4, 0x24, subtype, 1, 0})
      .u16(WIDTH)
      .u16(HEIGHT)
      .u32(WIDTH * HEIGHT * 16 * 12)  // bits a second, least and most
      .u32(WIDTH * HEIGHT * 16 * 13)
      .u32(WIDTH * HEIGHT * 2)
      .u32(INTERVAL)
      .u8({1})
      .u32(INTERVAL)
      .u8({6, 0x24, 0x0d, 1, 1, 4})
      .bytes;
}

inline Bytes configuration_descriptor() {
  // class-specific part of the control interface: header, camera terminal 1, output terminal 3
  const Bytes terminals =
      Packer().u8({18, 0x24, 2, 1, 1, 2, 0, 0, 0, 0, 0, 0, 0, 0, 3, 0, 0, 0}).u8({9, 0x24, 3, 3, 1, 1, 0, 1, 0}).bytes;
  const Bytes control = Packer()
                            .u8({13, 0x24, 1, 0, 1})
                            .u16(static_cast<std::uint32_t>(13 + terminals.size()))
                            .u32(48000000)
                            .u8({1, 1})
                            .append(terminals)
                            .bytes;
  const Bytes formats = Packer()
                            .u8({27, 0x24, 4, YUYV, 1})  // VS_FORMAT_UNCOMPRESSED with the GUID of YUY2
                            .u8({'Y', 'U', 'Y', '2', 0, 0, 0x10, 0, 0x80, 0, 0, 0xaa, 0, 0x38, 0x9b, 0x71})
                            .u8({16, 1, 0, 0, 0, 0})
                            .append(frame_descriptor(5))
                            .u8({11, 0x24, 6, MJPEG, 1, 1, 1, 0, 0, 0, 0})  // VS_FORMAT_MJPEG
                            .append(frame_descriptor(7))
                            .bytes;
  const Bytes stream = Packer()
                           .u8({15, 0x24, 1, 2})
                           .u16(static_cast<std::uint32_t>(15 + formats.size()))
                           .u8({0x81, 0, 3, 0, 0, 0, 1, 0, 0})
                           .append(formats)
                           .bytes;
  const Bytes body = Packer()
                         .u8({8, 11, 0, 2, 0x0e, 3, 0, 0})    // the two interfaces belong together
                         .u8({9, 4, 0, 0, 0, 0x0e, 1, 0, 0})  // 0: control
                         .append(control)
                         .u8({9, 4, 1, 0, 1, 0x0e, 2, 0, 0})  // 1: stream
                         .append(stream)
                         .u8({7, 5, 0x81, 2})  // its bulk endpoint
                         .u16(512)
                         .u8({0})
                         .bytes;
  return Packer()
      .u8({9, 2})
      .u16(static_cast<std::uint32_t>(9 + body.size()))
      .u8({2, 1, 0, 0x80, 0xfa})
      .append(body)
      .bytes;
}

}  // namespace heartservo::test
