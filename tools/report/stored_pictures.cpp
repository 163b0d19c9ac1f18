#include "tools/report/stored_pictures.hpp"

#include <fmt/format.h>

#include <fstream>
#include <opencv2/imgcodecs.hpp>

#include "tracking/settings/errors.hpp"

namespace heartservo::tools {

namespace fs = std::filesystem;
using nlohmann::json;

void write_pictures(const fs::path& folder, const std::vector<ReportPicture>& pictures) {
  if (pictures.empty()) return;
  const fs::path place = folder / "pictures";
  std::error_code error;
  fs::create_directory(place, error);
  if (error) throw ConfigError(fmt::format("{}: cannot be made: {}", place.string(), error.message()));
  json list = json::array();
  for (const auto& picture : pictures) {
    const std::string name = fmt::format("{}.png", list.size() + 1);
    std::vector<unsigned char> png;
    cv::imencode(".png", picture.bgr, png);
    std::ofstream out(place / name, std::ios::binary);
    out.write(reinterpret_cast<const char*>(png.data()), static_cast<std::streamsize>(png.size()));
    out.close();
    if (!out) throw ConfigError(fmt::format("{}: cannot be written; check the space", (place / name).string()));
    json keys = json::array();
    for (const auto& key : picture.keys)
      keys.push_back(
          {{"label", key.label}, {"bgr", {key.bgr[0], key.bgr[1], key.bgr[2]}}, {"mark", static_cast<int>(key.mark)}});
    list.push_back({{"file", name}, {"caption", picture.caption}, {"keys", keys}});
  }
  std::ofstream out(place / "pictures.json");
  out << list.dump(2) << "\n";
  out.close();
  if (!out) throw ConfigError(fmt::format("{}: cannot be written", (place / "pictures.json").string()));
}

std::vector<ReportPicture> read_pictures(const fs::path& folder) {
  const fs::path place = folder / "pictures", list_file = place / "pictures.json";
  std::vector<ReportPicture> pictures;
  std::ifstream in(list_file);
  if (!in) return pictures;
  try {
    for (const json& entry : json::parse(in)) {
      const std::string name = fs::path(entry.at("file").get<std::string>()).filename();
      ReportPicture picture{entry.at("caption"), cv::imread((place / name).string(), cv::IMREAD_COLOR), {}};
      if (picture.bgr.empty()) throw InputError(fmt::format("{}: is no picture", (place / name).string()));
      for (const json& key : entry.at("keys")) {
        const json& c = key.at("bgr");
        const int mark = std::clamp(key.at("mark").get<int>(), 0, 2);
        picture.keys.push_back(
            {key.at("label"), cv::Scalar(c.at(0), c.at(1), c.at(2)), static_cast<PictureKey::Mark>(mark)});
      }
      pictures.push_back(std::move(picture));
    }
  } catch (const json::exception& e) {
    throw InputError(fmt::format("{}: is not a list of pictures: {}", list_file.string(), e.what()));
  }
  return pictures;
}

}  // namespace heartservo::tools
