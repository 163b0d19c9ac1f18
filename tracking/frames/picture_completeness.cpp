#include <array>
#include <cctype>
#include <cstring>
#include <optional>

#include "tracking/frames/picture_file.hpp"

namespace heartservo::tracking {

namespace {

using Bytes = std::vector<std::uint8_t>;

bool starts_with(const Bytes& bytes, const char* signature, std::size_t size, std::size_t at = 0) {
  return bytes.size() >= at + size && std::memcmp(bytes.data() + at, signature, size) == 0;
}

std::uint32_t big_endian(const Bytes& bytes, std::size_t at) {
  return std::uint32_t(bytes[at]) << 24 | std::uint32_t(bytes[at + 1]) << 16 | std::uint32_t(bytes[at + 2]) << 8 |
         std::uint32_t(bytes[at + 3]);
}

std::uint32_t little_endian(const Bytes& bytes, std::size_t at) {
  return std::uint32_t(bytes[at + 3]) << 24 | std::uint32_t(bytes[at + 2]) << 16 | std::uint32_t(bytes[at + 1]) << 8 |
         std::uint32_t(bytes[at]);
}

// The checksum of PNG chunks (ISO 3309), a table of one byte at a time.
std::uint32_t crc32(const std::uint8_t* data, std::size_t size) {
  static const auto table = [] {
    std::array<std::uint32_t, 256> t{};
    for (std::uint32_t n = 0; n < 256; ++n) {
      std::uint32_t c = n;
      for (int k = 0; k < 8; ++k) c = c & 1 ? 0xEDB88320u ^ (c >> 1) : c >> 1;
      t[n] = c;
    }
    return t;
  }();
  std::uint32_t c = 0xFFFFFFFFu;
  for (std::size_t i = 0; i < size; ++i) c = table[(c ^ data[i]) & 0xFF] ^ (c >> 8);
  return c ^ 0xFFFFFFFFu;
}

// Chunks of length, type, data, checksum; the last is IEND.
std::string check_png(const Bytes& bytes) {
  for (std::size_t at = 8; at + 12 <= bytes.size();) {
    const std::size_t length = big_endian(bytes, at);
    if (length > bytes.size() - at - 12) break;
    if (crc32(bytes.data() + at + 4, length + 4) != big_endian(bytes, at + 8 + length))
      return "is damaged (a PNG checksum is wrong)";
    if (starts_with(bytes, "IEND", 4, at + 4)) return "";
    at += length + 12;
  }
  return "is cut off (PNG without its end)";
}

// Segments FF xx with their length, up to and through the coded scans, to the end marker FF D9. Walked, because a
// thumbnail inside has an end marker of its own.
std::string check_jpeg(const Bytes& bytes) {
  std::size_t at = 2;
  bool in_scan = false;
  while (at + 1 < bytes.size()) {
    if (bytes[at] != 0xFF) {
      if (!in_scan) return "is damaged (no JPEG marker where one must be)";
      ++at;
      continue;
    }
    const std::uint8_t marker = bytes[at + 1];
    if (marker == 0xD9) return "";
    if (marker == 0xFF) {  // fill byte
      ++at;
    } else if (marker == 0x00 || marker == 0x01 || (marker >= 0xD0 && marker <= 0xD8)) {  // stuffing, restart
      at += 2;
    } else {
      if (at + 3 >= bytes.size()) break;
      in_scan = marker == 0xDA;
      at += 2 + (std::size_t(bytes[at + 2]) << 8 | bytes[at + 3]);
    }
  }
  return "is cut off (JPEG without its end)";
}

// P5, P6: width, height and largest value as text, with comments, one white space, then the pixels.
std::string check_pnm(const Bytes& bytes) {
  std::size_t at = 2;
  const auto number = [&]() -> std::optional<std::size_t> {
    while (at < bytes.size() && (std::isspace(bytes[at]) || bytes[at] == '#')) {
      if (bytes[at] == '#')
        while (at < bytes.size() && bytes[at] != '\n') ++at;
      else
        ++at;
    }
    std::size_t value = 0;
    const std::size_t start = at;
    for (; at < bytes.size() && std::isdigit(bytes[at]) && value < 100'000'000; ++at)
      value = 10 * value + bytes[at] - '0';
    return at > start ? std::optional(value) : std::nullopt;
  };
  const auto width = number(), height = number(), largest = number();
  if (!width || !height || !largest) return "is cut off or damaged (no complete PGM/PPM header)";
  const std::size_t needed = *width * *height * (bytes[1] == '6' ? 3 : 1) * (*largest > 255 ? 2 : 1);
  return bytes.size() - at < needed + 1 ? "is cut off (fewer pixels than its header says)" : "";
}

}  // namespace

std::string missing_part(const std::vector<std::uint8_t>& bytes) {
  if (starts_with(bytes, "\x89PNG\r\n\x1a\n", 8)) return check_png(bytes);
  if (starts_with(bytes, "\xFF\xD8", 2)) return check_jpeg(bytes);
  if (starts_with(bytes, "P5", 2) || starts_with(bytes, "P6", 2)) return check_pnm(bytes);
  if (starts_with(bytes, "BM", 2) && (bytes.size() < 54 || little_endian(bytes, 2) > bytes.size()))
    return "is cut off (shorter than its BMP header says)";
  if (starts_with(bytes, "RIFF", 4) && starts_with(bytes, "WEBP", 4, 8) &&
      std::size_t(little_endian(bytes, 4)) + 8 > bytes.size())
    return "is cut off (shorter than its WebP header says)";
  return "";
}

}  // namespace heartservo::tracking
