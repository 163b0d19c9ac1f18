#include "servo/motion/motion_record.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "servo/motion/motion_file.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::servo {

namespace {

constexpr double kGapFrom = 1.5;  // steps longer than this many periods are gaps
constexpr std::size_t kNotesOfAKind = 3;

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// The first few of a kind, then how many more there are.
class Notes {
 public:
  explicit Notes(MotionRecord& record) : record_(record) {}
  ~Notes() {
    if (count_ > kNotesOfAKind)
      record_.notes.push_back(fmt::format("{}: and {} more such places", record_.file, count_ - kNotesOfAKind));
  }
  void add(int line, const std::string& what) {
    if (++count_ <= kNotesOfAKind) record_.notes.push_back(fmt::format("{}:{}: {}", record_.file, line, what));
  }

 private:
  MotionRecord& record_;
  std::size_t count_ = 0;
};

void note_gaps(MotionRecord& record) {
  Notes notes(record);
  for (std::size_t i = 1; i < record.rows(); ++i) {
    const double step = record.time_s[i] - record.time_s[i - 1];
    if (step > kGapFrom * record.period_s)
      notes.add(record.line[i], fmt::format("a gap of {:.4g} s before time {:.6g} s; rows come every {:.4g} s", step,
                                            record.time_s[i], record.period_s));
  }
}

void note_missing(MotionRecord& record) {
  Notes notes(record);
  for (std::size_t i = 0; i < record.rows(); ++i) {
    std::size_t end = i;
    while (end < record.rows() && !record.position[end].allFinite()) ++end;
    if (end == i) continue;
    notes.add(record.line[i], fmt::format("no position in {} row{} from here", end - i, end - i == 1 ? "" : "s"));
    i = end;
  }
}

void note_still_axes(MotionRecord& record) {
  for (int axis = 0; axis < 3; ++axis) {
    double low = INFINITY, high = -INFINITY;
    for (const auto& p : record.position)
      if (p.allFinite()) low = std::min(low, p[axis]), high = std::max(high, p[axis]);
    if (low == high)
      record.notes.push_back(fmt::format("{}:{}: {} is {:.6g} m in every row: nothing moves along it", record.file,
                                         record.line.front(), "xyz"[axis], low));
  }
}

}  // namespace

MotionRecord read_motion(const std::filesystem::path& path, const std::string& group) {
  MotionRecord record = read_rows(motion_file(path), group);
  if (record.rows() < 2)
    throw InputError(
        fmt::format("{}: {}; a motion needs two or more", record.file,
                    record.rows() == 0 ? "has no rows" : fmt::format("has one row, in line {}", record.line[0])));
  const auto known =
      std::count_if(record.position.begin(), record.position.end(), [](auto& p) { return p.allFinite(); });
  if (known < 2)
    throw InputError(fmt::format("{}:{}: only {} of {} rows have a position; a motion needs two or more", record.file,
                                 record.line[0], known, record.rows()));
  std::vector<double> steps;
  for (std::size_t i = 1; i < record.rows(); ++i) steps.push_back(record.time_s[i] - record.time_s[i - 1]);
  record.period_s = median(std::move(steps));
  note_gaps(record);
  note_missing(record);
  note_still_axes(record);
  return record;
}

}  // namespace heartservo::servo
