#include "tools/sweep/sweep_pool.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstring>
#include <list>

#include "sim/endoscope/painted_pattern.hpp"
#include "sim/endoscope/tool_view.hpp"
#include "tools/servo_run.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tools {

namespace {

using nlohmann::json;
using Clock = std::chrono::steady_clock;

// "residual.rms_mm" in a summary.
double metric_of(const json& summary, const std::string& path) {
  const json* at = &summary;
  for (std::size_t from = 0; from <= path.size();) {
    const auto dot = std::min(path.find('.', from), path.size());
    const std::string key = path.substr(from, dot - from);
    if (!at->is_object() || !at->contains(key)) return NAN;
    at = &(*at)[key];
    from = dot + 1;
  }
  return at->is_number() ? at->get<double>() : NAN;
}

// What a child says: JSON on its pipe.
json carry_out(const SweepPlan& plan, std::uint64_t run) {
  json answer{{"status", "done"}, {"error", ""}, {"metrics", json::array()}};
  try {
    ServoRequest request;
    request.scene = plan.scene_of(run);
    request.source = plan.scene;
    request.label = "sweep";
    request.quiet = true;
    request.pictures = false;
    const tbb::global_control one_core(tbb::global_control::max_allowed_parallelism, 1);
    const ServoOutcome outcome = run_loop(request);
    if (outcome.interrupted) return {{"status", "interrupted"}};
    if (!outcome.stop_reason.empty()) answer["status"] = "stopped", answer["error"] = outcome.stop_reason;
    for (const auto& metric : plan.metrics) {
      const double value = metric_of(outcome.summary, metric);
      answer["metrics"].push_back(std::isfinite(value) ? json(value) : json());
    }
  } catch (const std::exception& e) {
    answer = {{"status", "failed"}, {"error", e.what()}, {"metrics", json::array()}};
  }
  return answer;
}

struct Child {
  pid_t pid = 0;
  int pipe = -1;
  std::uint64_t run = 0;
  Clock::time_point begin;
  std::string said;
};

Child start(const SweepPlan& plan, std::uint64_t run) {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) throw ConfigError(fmt::format("no pipe can be made: {}", std::strerror(errno)));
  const pid_t pid = ::fork();
  if (pid < 0) throw ConfigError(fmt::format("no process can be made: {}; take fewer --jobs", std::strerror(errno)));
  if (pid == 0) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);  // nobody would take its answer, and it holds the folder's lock
    ::close(ends[0]);
    const std::string text = carry_out(plan, run).dump(-1, ' ', false, json::error_handler_t::replace);
    std::size_t sent = 0;
    while (sent < text.size()) {
      const ssize_t n = ::write(ends[1], text.data() + sent, text.size() - sent);
      if (n <= 0) break;
      sent += static_cast<std::size_t>(n);
    }
    ::_exit(0);  // nothing of the parent's is flushed or destroyed twice
  }
  ::close(ends[1]);
  return {pid, ends[0], run, Clock::now(), {}};
}

SweepResult result_of(const SweepPlan& plan, const Child& child, int status) {
  SweepResult r;
  r.run = child.run;
  r.seconds = std::chrono::duration<double>(Clock::now() - child.begin).count();
  r.metrics.assign(plan.metrics.size(), NAN);
  const json answer = json::parse(child.said, nullptr, false);
  if (!answer.is_object()) {
    r.status = "failed";
    r.error = WIFSIGNALED(status) ? fmt::format("killed by signal {}", WTERMSIG(status)) : "ended without an answer";
    return r;
  }
  r.status = answer["status"];
  r.error = answer.value("error", "");
  const json metrics = answer.value("metrics", json::array());
  for (std::size_t i = 0; i < metrics.size() && i < r.metrics.size(); ++i)
    if (metrics[i].is_number()) r.metrics[i] = metrics[i];
  return r;
}

}  // namespace

void run_pool(const SweepPlan& plan, const std::vector<std::uint64_t>& runs, int jobs,
              const std::function<void(const SweepResult&)>& done, const std::function<bool()>& goes_on) {
  std::list<Child> children;
  const auto end_all = [&] {
    for (auto& child : children) {
      ::kill(child.pid, SIGKILL);
      ::waitpid(child.pid, nullptr, 0);
      ::close(child.pipe);
    }
    children.clear();
  };
  if (runs.empty()) return;
  // What every run would paint anew, whatever its seed: the marker and the first landmark.
  for (const std::uint32_t id : {sim::kMarkerPattern, 0u}) sim::pattern_picture(id);
  try {
    std::size_t next = 0;
    while (next < runs.size() || !children.empty()) {
      if (!goes_on()) break;
      while (next < runs.size() && children.size() < static_cast<std::size_t>(jobs))
        children.push_back(start(plan, runs[next++]));
      std::vector<pollfd> waits;
      for (const auto& child : children) waits.push_back({child.pipe, POLLIN, 0});
      if (::poll(waits.data(), waits.size(), 200) < 0 && errno != EINTR) break;
      std::size_t i = 0;
      for (auto child = children.begin(); child != children.end(); ++i) {
        if ((waits[i].revents & (POLLIN | POLLHUP | POLLERR)) == 0) {
          ++child;
          continue;
        }
        char buffer[4096];
        const ssize_t n = ::read(child->pipe, buffer, sizeof(buffer));
        if (n > 0) {
          child->said.append(buffer, static_cast<std::size_t>(n));
          ++child;
          continue;
        }
        int status = 0;
        ::waitpid(child->pid, &status, 0);
        ::close(child->pipe);
        const SweepResult result = result_of(plan, *child, status);
        child = children.erase(child);
        if (result.status != "interrupted") done(result);
      }
    }
  } catch (...) {
    end_all();
    throw;
  }
  end_all();
}

}  // namespace heartservo::tools
