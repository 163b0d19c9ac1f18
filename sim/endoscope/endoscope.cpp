#include "sim/endoscope/endoscope.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/enumerable_thread_specific.h>
#include <oneapi/tbb/parallel_for.h>

#include "sim/endoscope/noise_table.hpp"
#include "sim/endoscope/shading.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::sim {
namespace {

constexpr int kRowsAtOnce = 16;
constexpr int kNodesAtOnce = 512;

/// Buffers of one thread.
struct RowBuffers {
  std::vector<float> scratch, channels, light, cover, grey, work;
};

const PictureOptions& checked(const PictureOptions& options) {
  const auto problems = options.validate();
  if (!problems.empty()) throw ConfigError(fmt::format("picture: {}", fmt::join(problems, "; ")));
  return options;
}

}  // namespace

std::vector<std::string> PictureOptions::validate() const {
  std::vector<std::string> problems;
  if (light != "xenon" && light != "flat") problems.push_back(fmt::format("light '{}' is not xenon or flat", light));
  if (!light_position_m.allFinite()) problems.emplace_back("light_position_m must be finite");
  if (!(light_distance_m > 0 && specular_roughness > 0 && gain > 0 && exposure >= 0))
    problems.emplace_back("light_distance_m, specular_roughness and gain must be positive");
  if (!(noise_grey >= 0 && specular_grey >= 0))
    problems.emplace_back("noise_grey and specular_grey must not be negative");
  if (texture.size < 256 || !(texture.extent_m > 0))
    problems.emplace_back("texture: size below 256 or extent_m not positive");
  return problems;
}

struct Endoscope::Workspace {
  Workspace(const PictureOptions& options, int width, const NodeGrid& grid, std::size_t tool_work, std::uint64_t seed)
      : noise(options.noise_grey, width, seed), gain(options.gain), bias(options.bias_grey), buffers([=, &grid] {
          const auto row = static_cast<std::size_t>(grid.padded_width());
          return RowBuffers{std::vector<float>(grid.columns()),
                            std::vector<float>(SurfaceNodes::kChannels * row),
                            std::vector<float>(row),
                            std::vector<float>(row),
                            std::vector<float>(row),
                            std::vector<float>(tool_work)};
        }) {}

  NoiseTable noise;
  double gain, bias;
  tbb::enumerable_thread_specific<RowBuffers> buffers;
};

Endoscope::Endoscope(const tracking::Camera& camera, const HeartSurface& surface, const PictureOptions& options,
                     std::uint64_t seed, const ToolOptions& tool, std::shared_ptr<const TissueTexture> texture)
    : camera_(camera),
      surface_(surface),
      options_(checked(options)),
      texture_(texture ? std::move(texture)
                       : std::make_shared<const TissueTexture>(
                             TissueTexture::procedural(options.texture, surface.options().landmarks, seed))),
      nodes_(camera, options, texture_->texels_per_m()),
      tool_(camera, tool),
      workspace_(std::make_unique<Workspace>(options, camera.width, nodes_.grid(), tool_.work_size(), seed)) {}

Endoscope::~Endoscope() = default;

void Endoscope::set_light(double gain, double bias_grey) { workspace_->gain = gain, workspace_->bias = bias_grey; }

void Endoscope::move_view(const Eigen::Vector3d& view_m, const Eigen::Vector3d& lamp_m) {
  view_m_ = view_m;
  nodes_.set_lamp(options_.light_position_m + lamp_m - view_m);
}

void Endoscope::render(double t, std::uint64_t frame_index, cv::Mat& grey, const ToolPose* tool) {
  grey.create(camera_.height, camera_.width, CV_8UC1);
  surface_.at(t, state_);
  state_.t_camera_local -= view_m_;
  ToolPose place = tool != nullptr ? *tool : ToolPose(Eigen::Vector3d(0, 0, -1));
  if (tool != nullptr) place.tip -= view_m_;
  tool_.place(place);
  const NodeGrid& grid = nodes_.grid();
  // One picture takes a few milliseconds; simple partitions keep the scheduling out of it.
  tbb::parallel_for(tbb::blocked_range<int>(0, grid.size(), kNodesAtOnce),
                    [&](const tbb::blocked_range<int>& nodes) { nodes_.solve(state_, nodes.begin(), nodes.end()); });
  const ShadingConstants shading{texture_->texels(), texture_->size(),
                                 options_.light == "flat" ? 0.f : static_cast<float>(options_.specular_grey),
                                 static_cast<float>(1 / (options_.specular_roughness * options_.specular_roughness))};
  tbb::parallel_for(tbb::blocked_range<int>(0, camera_.height, kRowsAtOnce), [&](const tbb::blocked_range<int>& rows) {
    RowBuffers& b = workspace_->buffers.local();
    for (int v = rows.begin(); v < rows.end(); ++v) {
      grid.interpolate_row(nodes_.planes(), SurfaceNodes::kChannels, v, b.scratch.data(), b.channels.data());
      shade_row(shading, b.channels.data(), grid.padded_width(), camera_.width, b.light.data());
      const auto [first, last] = tool_.reach(v);
      if (first < last) {
        tool_.paint_row(v, b.cover.data(), b.grey.data(), b.work.data());
        for (int u = first; u < last; ++u) b.light[u] += b.cover[u - first] * (b.grey[u - first] - b.light[u]);
      }
      expose_row(b.light.data(), workspace_->noise.row(frame_index, v), static_cast<float>(workspace_->gain),
                 static_cast<float>(workspace_->bias), camera_.width, grey.ptr<std::uint8_t>(v));
    }
  });
}

}  // namespace heartservo::sim
