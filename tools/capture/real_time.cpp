#include "tools/capture/real_time.hpp"

#include <fmt/format.h>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>

#include <cerrno>
#include <cstring>

namespace heartservo::tools {

namespace {

constexpr int PRIORITY = 50;  // below the kernel's interrupt threads' usual one or at it, above everything else

}  // namespace

RealTime::RealTime(bool wanted) : wanted_(wanted) {
  if (!wanted) return;
  locked_ = ::mlockall(MCL_CURRENT | MCL_FUTURE) == 0;
  memory_ = locked_ ? "locked" : fmt::format("not locked: {}", std::strerror(errno));
  sched_param old{};
  ::pthread_getschedparam(::pthread_self(), &old_policy_, &old);
  old_priority_ = old.sched_priority;
  sched_param parameters{};
  parameters.sched_priority = PRIORITY;
  const int error = ::pthread_setschedparam(::pthread_self(), SCHED_FIFO, &parameters);
  scheduled_ = error == 0;
  scheduling_ = scheduled_ ? fmt::format("SCHED_FIFO {}", PRIORITY) : fmt::format("as usual: {}", std::strerror(error));
}

RealTime::~RealTime() {
  if (locked_) ::munlockall();
  sched_param old{};
  old.sched_priority = old_priority_;
  if (scheduled_) ::pthread_setschedparam(::pthread_self(), old_policy_, &old);
}

nlohmann::json RealTime::granted() const {
  return {{"wanted", wanted_}, {"scheduling", scheduling_}, {"memory", memory_}};
}

}  // namespace heartservo::tools
