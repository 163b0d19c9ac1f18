#include "tracking/frames/picture_file.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string_view>

namespace heartservo::tracking {

namespace {

constexpr std::array<std::string_view, 9> NAMES{"png", "jpg", "jpeg", "bmp", "tif", "tiff", "pgm", "ppm", "webp"};

bool is_text(const std::uint8_t* data, std::size_t size) {
  return size > 0 && std::all_of(data, data + size, [](std::uint8_t c) {
           return c >= 0x20 || c == '\t' || c == '\n' || c == '\r';  // UTF-8 is text
         });
}

}  // namespace

bool has_picture_name(const std::string& file) {
  std::string extension = std::filesystem::path(file).extension().string();
  if (extension.empty()) return false;
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return std::find(NAMES.begin(), NAMES.end(), std::string_view(extension).substr(1)) != NAMES.end();
}

std::string picture_names() { return fmt::format("{}", fmt::join(NAMES, ", ")); }

bool looks_like_text(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  std::array<char, 4096> start{};
  in.read(start.data(), start.size());
  return is_text(reinterpret_cast<const std::uint8_t*>(start.data()), static_cast<std::size_t>(in.gcount()));
}

Picture read_picture(const std::string& file) {
  Picture picture;
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) {
    picture.problem = file + (std::filesystem::exists(file, error) ? ": is not a file" : ": is missing");
    return picture;
  }
  std::vector<std::uint8_t> bytes(std::filesystem::file_size(file, error));
  std::ifstream in(file, std::ios::binary);
  in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (!in) {
    picture.problem = file + ": cannot be read; check its permissions";
  } else if (bytes.empty()) {
    picture.problem = file + ": is empty";
  } else if (const std::string missing = missing_part(bytes); !missing.empty()) {
    picture.problem = file + ": " + missing;
  } else {
    cv::Mat decoded;
    try {
      decoded = cv::imdecode(bytes, cv::IMREAD_ANYCOLOR);  // 8 bit, grey or BGR
    } catch (const cv::Exception&) {                       // says less than the line below
    }
    if (decoded.empty()) {
      picture.problem = file + (is_text(bytes.data(), std::min<std::size_t>(bytes.size(), 4096))
                                    ? ": is a text file, not a picture"
                                    : ": is damaged or no picture that can be decoded");
    } else if (decoded.channels() == 1) {
      picture.grey = decoded;
    } else {
      picture.colour = decoded;
      cv::cvtColor(decoded, picture.grey, cv::COLOR_BGR2GRAY);
    }
  }
  return picture;
}

}  // namespace heartservo::tracking
