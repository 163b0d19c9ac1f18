#pragma once
// The pictures of a run as files, so that its page can be made again and other pages can show them: pictures/1.png, ...
// and pictures/pictures.json with their captions and keys.
#include <filesystem>
#include <vector>

#include "tools/report/report.hpp"

namespace heartservo::tools {

/// Writes them below `folder`. Throws ConfigError (no space, no permission).
void write_pictures(const std::filesystem::path& folder, const std::vector<ReportPicture>& pictures);

/// Those of a run; none where it has none. Throws InputError for what cannot be read.
std::vector<ReportPicture> read_pictures(const std::filesystem::path& folder);

}  // namespace heartservo::tools
