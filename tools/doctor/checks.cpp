#include "tools/doctor/checks.hpp"

#include <fmt/format.h>
#include <sched.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>
#include <visp3/core/vpConfig.h>

#include <Eigen/Core>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <opencv2/core/utility.hpp>
#include <opencv2/core/version.hpp>
#include <thread>

#include "tools/shipped.hpp"

namespace heartservo::tools {

namespace {

namespace fs = std::filesystem;
using State = Finding::State;

constexpr double kGiB = 1024.0 * 1024 * 1024;

Finding versions() {
  return {"versions", State::OK,
          fmt::format("heartservo {}, OpenCV {}, ViSP {}.{}.{}, Eigen {}.{}.{}, compiler {}", HEARTSERVO_VERSION,
                      CV_VERSION, VISP_VERSION_MAJOR, VISP_VERSION_MINOR, VISP_VERSION_PATCH, EIGEN_WORLD_VERSION,
                      EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION, __VERSION__)};
}

Finding processor() {
  const unsigned cores = std::thread::hardware_concurrency();
  std::string features;
#if defined(__x86_64__)
  __builtin_cpu_init();
  const auto add = [&](const char* name, bool has) { features += has ? std::string(" ") + name : ""; };
  add("SSE4.2", __builtin_cpu_supports("sse4.2"));
  add("AVX", __builtin_cpu_supports("avx"));
  add("AVX2", __builtin_cpu_supports("avx2"));
  add("FMA", __builtin_cpu_supports("fma"));
  add("AVX-512", __builtin_cpu_supports("avx512f"));
  if (!__builtin_cpu_supports("avx2"))
    return {"processor", State::NOTE, fmt::format("{} cores;{}", cores, features),
            "tracking is several times slower without AVX2; use a processor of 2013 or later"};
#endif
  if (cores < 2)
    return {"processor", State::NOTE, fmt::format("{} core;{}", cores, features),
            "a simulated run draws its pictures on a second core"};
  return {"processor", State::OK, fmt::format("{} cores;{}", cores, features)};
}

Finding memory() {
  const double bytes = static_cast<double>(::sysconf(_SC_PHYS_PAGES)) * static_cast<double>(::sysconf(_SC_PAGESIZE));
  const std::string found = fmt::format("{:.1f} GiB", bytes / kGiB);
  if (bytes < 2 * kGiB) return {"memory", State::NOTE, found, "2 GiB or more are wanted for long runs"};
  return {"memory", State::OK, found};
}

Finding disk() {
  std::error_code error;
  const fs::space_info space = fs::space(fs::current_path(error), error);
  if (error) return {"disk", State::LACK, error.message(), "work in a folder that can be read"};
  const double free = static_cast<double>(space.available) / kGiB;
  const std::string found = fmt::format("{:.1f} GiB free here", free);
  if (::access(".", W_OK) != 0)
    return {"disk", State::LACK, found + ", but this folder cannot be written", "name another with --out"};
  if (free < 1) return {"disk", State::NOTE, found, "a minute of recorded video takes up to 1 GiB; make room"};
  return {"disk", State::OK, found};
}

Finding scenes() {
  const fs::path folder = shipped_scenes();
  if (folder.empty())
    return {"scenes", State::LACK, "the shipped scenes are not beside the program",
            "install the program whole (cmake --install), or name scene files by their paths"};
  return {"scenes", State::OK, folder.string()};
}

Finding data() {
  const char* given = std::getenv("HEARTSERVO_DATA");
  const fs::path folder = given != nullptr && *given != '\0' ? given : "../shared/data";
  std::error_code error;
  if (fs::is_directory(folder, error)) return {"recorded data", State::OK, fs::absolute(folder).string()};
  return {"recorded data", State::NOTE, fmt::format("no folder {}", folder.string()),
          "only for tests and 'paper' on recordings: set HEARTSERVO_DATA to the folder"};
}

// Groups as well as rights of the file decide; opening it would switch some cameras on.
Finding cameras() {
  std::error_code error;
  int seen = 0, usable = 0;
  for (const auto& entry : fs::directory_iterator("/dev", error)) {
    const std::string name = entry.path().filename();
    if (name.rfind("video", 0) != 0 || name.find_first_not_of("0123456789", 5) != std::string::npos) continue;
    ++seen;
    usable += ::access(entry.path().c_str(), R_OK | W_OK) == 0;
  }
  if (seen == 0)
    return {"cameras", State::NOTE, "no /dev/video*", "only for live capture: plug the endoscope adapter in"};
  if (usable < seen)
    return {"cameras", State::LACK, fmt::format("{} of {} cannot be opened", seen - usable, seen),
            "join the group that owns them: sudo adduser $USER video, then log in again"};
  return {"cameras", State::OK, fmt::format("{} usable", seen)};
}

// The socket of a local X server; no window is opened.
Finding display() {
  const char* name = std::getenv("DISPLAY");
  if (name == nullptr || *name == '\0')
    return {"display", State::NOTE, "none (DISPLAY is not set)", "only for --show: run in a graphical session"};
  if (name[0] != ':') return {"display", State::OK, fmt::format("{} (not local, not tried)", name)};
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::string path = fmt::format("/tmp/.X11-unix/X{}", std::atoi(name + 1));
  std::strncpy(address.sun_path, path.c_str(), sizeof(address.sun_path) - 1);
  const int s = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const bool answers =
      s >= 0 && ::connect(s, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0;  // NOLINT
  if (s >= 0) ::close(s);
  if (!answers)
    return {"display", State::NOTE, fmt::format("{} does not answer", name), "only for --show: check DISPLAY"};
  return {"display", State::OK, name};
}

std::string limit_text(rlim_t limit, double unit, const char* name) {
  return limit == RLIM_INFINITY ? "unlimited" : fmt::format("{:.0f} {}", static_cast<double>(limit) / unit, name);
}

Finding real_time() {
  rlimit priority{}, locked{};
  ::getrlimit(RLIMIT_RTPRIO, &priority);
  ::getrlimit(RLIMIT_MEMLOCK, &locked);
  const int before = ::sched_getscheduler(0);
  sched_param param{}, old{};
  ::sched_getparam(0, &old);
  param.sched_priority = 1;
  const bool may = ::sched_setscheduler(0, SCHED_FIFO, &param) == 0;
  if (may) ::sched_setscheduler(0, before, &old);
  const std::string found = fmt::format("SCHED_FIFO {}, locked memory {}", may ? "allowed" : "refused",
                                        limit_text(locked.rlim_cur, 1024.0 * 1024, "MiB"));
  if (may) return {"real time", State::OK, found};
  return {"real time", State::NOTE, found,
          "only for a live loop: in /etc/security/limits.d/ give your user 'rtprio 80' and 'memlock unlimited', log in "
          "again"};
}

}  // namespace

std::vector<Finding> examine_machine() {
  return {versions(), processor(), memory(), disk(), scenes(), data(), cameras(), display(), real_time()};
}

}  // namespace heartservo::tools
