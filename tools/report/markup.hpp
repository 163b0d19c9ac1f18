#pragma once
// Text of a page: what may not stand in HTML is escaped here and nowhere else.
#include <map>
#include <opencv2/core.hpp>
#include <string>
#include <string_view>

#include "tools/report/report.hpp"

namespace heartservo::tools::markup {

std::string escaped(std::string_view text);
/// JSON for the inside of a <script> element: no '<', which could end the element.
std::string script_safe(std::string json);
/// A library as shipped, without the reference to its source map, which a browser would look for.
std::string without_source_map(std::string_view text);
/// <img> with the picture inside. Throws std::invalid_argument for an empty or not 8 bit picture.
std::string image(const ReportPicture& picture);
/// <video> with the file inside. Throws ConfigError when it cannot be read.
std::string video(const ReportVideo& video);
std::string table(const ReportTable& table);
/// Puts values in the place of {{name}}. Throws std::logic_error when a name has no value.
std::string filled(std::string_view page, const std::map<std::string, std::string, std::less<>>& values);

}  // namespace heartservo::tools::markup
