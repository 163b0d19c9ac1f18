#include "tools/report/markup.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "tracking/settings/errors.hpp"

namespace heartservo::tools::markup {

namespace {

constexpr int MAX_WIDTH = 1280;

std::string base64(const std::vector<unsigned char>& bytes) {
  static constexpr char DIGITS[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t left = std::min<std::size_t>(bytes.size() - i, 3);
    unsigned word = bytes[i] << 16;
    if (left > 1) word |= bytes[i + 1] << 8;
    if (left > 2) word |= bytes[i + 2];
    for (std::size_t j = 0; j < 4; ++j) text += j <= left ? DIGITS[word >> (18 - 6 * j) & 63] : '=';
  }
  return text;
}

// "0.41", "-3 mm", "98.2 %", "–": things to compare, so they stand below each other at the right.
bool looks_like_number(std::string_view text) {
  if (text.empty() || text == "–" || text == "-") return true;
  if (text[0] == '+' || text[0] == '-') text.remove_prefix(1);
  return !text.empty() && text[0] >= '0' && text[0] <= '9' && text.size() < 16 &&
         std::count(text.begin(), text.end(), ' ') <= 1 && text.find_first_of("-:/_") == text.npos;
}

}  // namespace

std::string escaped(std::string_view text) {
  std::string result;
  result.reserve(text.size());
  for (const char c : text) switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      case '\'':
        result += "&#39;";
        break;
      default:
        result += c;
    }
  return result;
}

std::string script_safe(std::string json) {
  for (std::size_t at = 0; (at = json.find('<', at)) != json.npos;) json.replace(at, 1, "\\u003c");
  return json;
}

std::string without_source_map(std::string_view text) {
  const auto at = text.rfind("# sourceMappingURL=");
  if (at == text.npos || at < 2) return std::string(text);
  return std::string(text.substr(0, at - 2));  // with the // or /* before it; nothing follows but its end
}

namespace {

std::string key(const PictureKey& key) {
  const auto byte = [&](int channel) { return cv::saturate_cast<std::uint8_t>(key.bgr[channel]); };
  const char* mark = key.mark == PictureKey::Mark::AREA     ? " class=\"area\""
                     : key.mark == PictureKey::Mark::DASHES ? " class=\"dashes\""
                                                            : "";
  return fmt::format("<span class=\"key\"><i{} style=\"color:#{:02x}{:02x}{:02x}\"></i>{}</span>", mark, byte(2),
                     byte(1), byte(0), escaped(key.label));
}

}  // namespace

std::string image(const ReportPicture& picture) {
  if (picture.bgr.empty() || picture.bgr.depth() != CV_8U)
    throw std::invalid_argument(fmt::format("report: the picture '{}' is empty or not 8 bit", picture.caption));
  cv::Mat shown = picture.bgr;
  if (shown.cols > MAX_WIDTH) {
    const double scale = static_cast<double>(MAX_WIDTH) / shown.cols;
    cv::resize(picture.bgr, shown, {}, scale, scale, cv::INTER_AREA);
  }
  std::vector<unsigned char> png;
  cv::imencode(".png", shown, png, {cv::IMWRITE_PNG_COMPRESSION, 6});
  std::string keys;
  for (const auto& k : picture.keys) keys += key(k);
  if (!keys.empty()) keys = "<span class=\"legend\">" + keys + "</span>";
  return fmt::format(
      "<figure class=\"picture\"><img width=\"{}\" height=\"{}\" alt=\"{}\" src=\"data:image/png;base64,{}\">"
      "<figcaption>{}{}</figcaption></figure>\n",
      shown.cols, shown.rows, escaped(picture.caption), base64(png), escaped(picture.caption), keys);
}

std::string video(const ReportVideo& video) {
  std::ifstream in(video.file, std::ios::binary);
  const std::vector<unsigned char> bytes{std::istreambuf_iterator<char>(in), {}};
  if (bytes.empty()) throw ConfigError(video.file.string() + ": the video cannot be read");
  return fmt::format(
      "<figure class=\"picture film\"><video controls loop muted playsinline src=\"data:video/webm;base64,{}\"></video>"
      "<figcaption>{}</figcaption></figure>\n",
      base64(bytes), escaped(video.caption));
}

std::string table(const ReportTable& table) {
  std::string html =
      fmt::format("<div{}><h2>{}</h2>\n", table.wide || table.header.size() > 5 ? " class=\"wide\"" : "", escaped(table.title));
  if (!table.note.empty()) html += fmt::format("<p class=\"note\">{}</p>\n", escaped(table.note));
  html += "<div class=\"scroll\"><table>\n";
  // in a comparison a column is numeric when all its cells look like numbers
  std::vector<bool> numeric;
  for (const auto& row : table.rows)
    for (std::size_t i = 0; i < row.size(); ++i) {
      if (i >= numeric.size()) numeric.push_back(i > 0 && !table.header.empty());
      if (!looks_like_number(row[i])) numeric[i] = false;
    }
  const auto align = [&](std::size_t i) { return i < numeric.size() && numeric[i] ? " class=\"n\"" : ""; };
  if (!table.header.empty()) {
    html += "<thead><tr>";
    for (std::size_t i = 0; i < table.header.size(); ++i)
      html += fmt::format("<th scope=\"col\"{}>{}</th>", align(i), escaped(table.header[i]));
    html += "</tr></thead>\n";
  }
  html += "<tbody>\n";
  for (const auto& row : table.rows) {
    html += "<tr>";
    for (std::size_t i = 0; i < row.size(); ++i)
      html += i == 0 ? fmt::format("<th scope=\"row\">{}</th>", escaped(row[i]))
                     : fmt::format("<td{}>{}</td>", align(i), escaped(row[i]));
    html += "</tr>\n";
  }
  return html + "</tbody></table></div></div>\n";
}

std::string filled(std::string_view page, const std::map<std::string, std::string, std::less<>>& values) {
  std::string result;
  for (std::size_t from; (from = page.find("{{")) != page.npos;) {
    const std::size_t to = page.find("}}", from);
    const auto value = values.find(page.substr(from + 2, to - from - 2));
    if (value == values.end()) throw std::logic_error("report template: no value for a name in {{ }}");
    result.append(page.substr(0, from)).append(value->second);
    page.remove_prefix(to + 2);
  }
  return result.append(page);
}

}  // namespace heartservo::tools::markup
