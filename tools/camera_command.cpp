// heartservo camera: camera files of other programs, shown and converted.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>

#include "tools/command.hpp"
#include "tracking/camera/camera_file.hpp"
#include "tracking/camera/camera_fit.hpp"
#include "tracking/camera/stereo_camera.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tools {

namespace {

using nlohmann::json;
using tracking::CameraFormat;
using tracking::WideCamera;

constexpr double LARGEST_ERROR_PX = 0.5;  // of a lossy conversion, without --force

struct CameraOptions {
  std::string in, out, to, terms = "all";
  bool force = false, json = false, quiet = false;
};

// The terms that a file of this format can hold.
tracking::CameraTerms terms_of(CameraFormat format, bool paper_model) {
  tracking::CameraTerms terms{true, true, true, true};
  if (format == CameraFormat::VISP) return {false, false, false, false};
  if (format != CameraFormat::MATLAB) terms.skew = false;
  return paper_model ? tracking::PAPER_TERMS : terms;
}

CameraFormat target_format(const CameraOptions& o) {
  if (!o.to.empty()) return tracking::camera_format(o.to);
  if (const auto format = tracking::format_of_name(o.out)) return *format;
  throw ConfigError(fmt::format("{}: the name does not tell the format; add --to {}", o.out,
                                fmt::join(tracking::camera_format_names(), " or ")));
}

json error_json(const tracking::PictureError& e) {
  return {{"rms", e.rms_px}, {"max", e.max_px}, {"worst_px", {e.worst_px.x(), e.worst_px.y()}}};
}

std::string error_text(const tracking::PictureError& e) {
  return fmt::format("{:.3f} px RMS over the picture, {:.3f} px at most, at ({:.1f}, {:.1f})", e.rms_px, e.max_px,
                     e.worst_px.x(), e.worst_px.y());
}

int run_convert(const CameraOptions& o) {
  const CameraFormat format = target_format(o);
  const auto file = tracking::read_camera_file(o.in);
  const auto fit = tracking::fit_camera(file.camera, terms_of(format, o.terms == "4"));
  // ViSP has a term of its own for the way from pixels to rays
  tracking::BackwardFit backward;
  if (format == CameraFormat::VISP && fit.camera.camera.has_distortion())
    backward = tracking::fit_backward(fit.camera.camera, file.camera);
  const bool lossy = !fit.lost.empty();
  if (lossy && std::max(fit.error.max_px, backward.error.max_px) > LARGEST_ERROR_PX && !o.force)
    throw ConfigError(
        fmt::format("{}: {} cannot hold {}; the nearest camera is off by {}{}. Nothing was written; --force writes it",
                    o.in, tracking::name_of(format), fmt::join(fit.lost, ", "), error_text(fit.error),
                    backward.error.max_px > 0 ? "; from pixels to rays (kdu) by " + error_text(backward.error) : ""));
  tracking::write_camera(fit.camera, format, o.out, std::filesystem::path(o.in).stem().string(), backward.kdu);
  if (o.json) {
    const json result{{"command", "camera convert"},
                      {"version", HEARTSERVO_VERSION},
                      {"in", o.in},
                      {"from", tracking::name_of(file.format)},
                      {"out", o.out},
                      {"to", tracking::name_of(format)},
                      {"lossy", lossy},
                      {"lost", fit.lost},
                      {"error_px", error_json(fit.error)},
                      {"backward_error_px", error_json(backward.error)}};
    fmt::print("{}\n", result.dump(2));
  } else if (!o.quiet) {
    fmt::print(
        "{}: {}\n{}: {}, {}\n", o.in, tracking::name_of(file.format), o.out, tracking::name_of(format),
        lossy ? fmt::format("without {}: {}", fmt::join(fit.lost, ", "), error_text(fit.error)) : "nothing is lost");
    if (backward.error.max_px > 0)
      fmt::print("from pixels to rays ViSP has one term (kdu): {}\n", error_text(backward.error));
  }
  return DONE;
}

json camera_json(const WideCamera& wide) {
  const auto& c = wide.camera;
  double shift = 0;
  for (const auto& pixel : tracking::picture_grid(c.width, c.height)) {
    const Eigen::Vector2d n = wide.normalise(pixel);
    shift = std::max(shift, (c.to_pixel(n) + Eigen::Vector2d(wide.skew * n.y(), 0) - pixel).norm());
  }
  const auto angle = [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    const Eigen::Vector3d p = wide.normalise(a).homogeneous().normalized();
    return 180 / M_PI * std::acos(std::min(1.0, p.dot(wide.normalise(b).homogeneous().normalized())));
  };
  const double left = -0.5, right = c.width - 0.5, top = -0.5, bottom = c.height - 0.5;
  const double u = (left + right) / 2, v = (top + bottom) / 2;
  return {{"width", c.width},
          {"height", c.height},
          {"fx", c.fx},
          {"fy", c.fy},
          {"cx", c.cx},
          {"cy", c.cy},
          {"k1", c.k1},
          {"k2", c.k2},
          {"k3", c.k3},
          {"k4", c.k4},
          {"k5", wide.k5},
          {"skew", wide.skew},
          {"field_of_view_deg",
           {angle({left, v}, {right, v}), angle({u, top}, {u, bottom}), angle({left, top}, {right, bottom})}},
          {"largest_distortion_px", shift}};
}

std::string camera_text(const json& c) {
  std::string text = fmt::format("picture            {} x {} px\n", c["width"].get<int>(), c["height"].get<int>());
  text += fmt::format("focal length       fx {:.3f}, fy {:.3f} px\n", c["fx"].get<double>(), c["fy"].get<double>());
  text += fmt::format("principal point    cx {:.3f}, cy {:.3f} px\n", c["cx"].get<double>(), c["cy"].get<double>());
  text += fmt::format("radial             k1 {:.6g}, k2 {:.6g}{}\n", c["k1"].get<double>(), c["k2"].get<double>(),
                      c["k5"] != 0 ? fmt::format(", r^6 {:.6g} (beyond eq. 3)", c["k5"].get<double>()) : "");
  text += fmt::format("tangential         k3 {:.6g}, k4 {:.6g}\n", c["k3"].get<double>(), c["k4"].get<double>());
  if (c["skew"] != 0) text += fmt::format("skew               {:.6g} px (beyond eq. 2)\n", c["skew"].get<double>());
  const auto view = c["field_of_view_deg"].get<std::vector<double>>();
  text += fmt::format("field of view      {:.1f} x {:.1f} deg, diagonal {:.1f} deg\n", view[0], view[1], view[2]);
  return text +
         fmt::format("distortion         moves pixels by up to {:.1f} px\n", c["largest_distortion_px"].get<double>());
}

int run_show(const CameraOptions& o) {
  const auto file = tracking::read_camera_file(o.in);
  json result{{"command", "camera show"},
              {"file", o.in},
              {"format", tracking::name_of(file.format)},
              {"camera", camera_json(file.camera)}};
  std::string text = fmt::format("{}: {}\n", o.in, tracking::name_of(file.format)) + camera_text(result["camera"]);
  if (tracking::is_stereo_file(o.in)) {
    const auto stereo = tracking::read_stereo_camera(o.in);
    result["right"] = camera_json({stereo.right});
    result["baseline_mm"] = 1e3 * stereo.baseline_m();
    text += "\nright camera\n" + camera_text(result["right"]) +
            fmt::format("\nbaseline           {:.3f} mm\n", 1e3 * stereo.baseline_m());
  }
  if (o.json)
    fmt::print("{}\n", result.dump(2));
  else
    fmt::print("{}", text);
  return DONE;
}

}  // namespace

Command add_camera_command(CLI::App& program) {
  auto options = std::make_shared<CameraOptions>();
  CameraOptions& o = *options;
  CLI::App* app = program.add_subcommand("camera", "show camera files; convert them between programs");
  app->require_subcommand(1);

  CLI::App* convert = app->add_subcommand("convert", "ROS YAML, OpenCV YAML or XML, ViSP XML, Matlab toolbox .m");
  convert->add_option("IN", o.in, "camera file; its content tells the format")->required()->type_name("FILE");
  convert->add_option("OUT", o.out, "file to write; .yaml is ROS, .xml ViSP, .m Matlab, unless --to says otherwise")
      ->required()
      ->type_name("FILE");
  convert->add_option("--to", o.to, "format to write")->check(one_of(tracking::camera_format_names()));
  convert->add_option("--terms", o.terms, "4: k1 k2 k3 k4 only, as heartservo reads; all (default): what OUT can hold")
      ->check(one_of({"4", "all"}));
  convert->add_flag("--force", o.force, "write also what is off by more than 0.5 px");
  convert->add_flag("--json", o.json, "print what was done as JSON and nothing else");
  convert->add_flag("--quiet", o.quiet, "print nothing");
  convert->footer("Example: heartservo camera convert scenes/cameras/sauvee_2007.yaml Calib_Results.m");

  CLI::App* show = app->add_subcommand("show", "a camera file, legibly");
  show->add_option("FILE", o.in, "camera file")->required()->type_name("");
  show->add_flag("--json", o.json, "as JSON and nothing else");
  show->footer("Example: heartservo camera show scenes/cameras/sauvee_2007.yaml");
  app->footer("Example: heartservo camera show scenes/cameras/sauvee_2007.yaml");

  return {app, [options, convert] { return convert->parsed() ? run_convert(*options) : run_show(*options); }};
}

}  // namespace heartservo::tools
