#include "tracking/settings/yaml_reader.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "tracking/settings/errors.hpp"
#include "tracking/settings/fields.hpp"

namespace heartservo {

namespace {

class YamlReader final : public FieldVisitor {
 public:
  YamlReader(const YAML::Node& root, std::string where, std::string path) : where_(std::move(where)) {
    if (root.IsDefined() && !root.IsNull() && !root.IsMap()) fail_at(root.Mark().line, path, "must be a group of keys");
    open(root, std::move(path));
  }

  void field(const FieldInfo& info, double& value) override {
    if (const YAML::Node node = take(info.name)) value = number(node, info);
  }
  void field(const FieldInfo& info, int& value) override {
    const YAML::Node node = take(info.name);
    if (!node) return;
    const double v = number(node, info);
    if (v != std::floor(v) || std::abs(v) > 2e9) fail(node, info.name, "must be a whole number");
    value = static_cast<int>(v);
  }
  void field(const FieldInfo& info, bool& value) override {
    const YAML::Node node = take(info.name);
    if (node && !(node.IsScalar() && YAML::convert<bool>::decode(node, value)))
      fail(node, info.name, "must be true or false");
  }
  void field(const FieldInfo& info, std::string& value) override {
    const YAML::Node node = take(info.name);
    if (!node) return;
    if (!node.IsScalar()) fail(node, info.name, "must be a text");
    value = node.Scalar();
  }
  void field(const FieldInfo& info, std::vector<double>& value, std::size_t size) override {
    const YAML::Node node = take(info.name);
    if (!node) return;
    if (!node.IsSequence() || (size > 0 && node.size() != size))
      fail(node, info.name, size > 0 ? fmt::format("must be a list of {} numbers", size) : "must be a list of numbers");
    value.clear();
    for (const auto& item : node) value.push_back(number(item, info));
  }
  void choice(const FieldInfo& info, std::string& value, const std::vector<std::string>& names) override {
    const YAML::Node node = take(info.name);
    if (!node) return;
    if (!node.IsScalar()) fail(node, info.name, "must be a name");
    value = node.Scalar();
    if (std::find(names.begin(), names.end(), value) == names.end())
      fail(node, info.name,
           fmt::format("'{}' is not known{}; choose one of {}", value, did_you_mean(value, names),
                       fmt::join(names, ", ")));
  }

  void finish() const { check_unknown(levels_.back()); }

 protected:
  void begin_group(const char* name, const char*) override {
    const YAML::Node node = take(name);
    if (node && !node.IsMap()) fail(node, name, "must be a group of keys");
    open(node, join(name));
  }
  void end_group() override { close(); }
  std::size_t begin_list(const char* name, const char*, std::size_t size) override {
    const YAML::Node node = take(name);
    if (node && !node.IsSequence()) fail(node, name, "must be a list");
    open(node, join(name));
    return node ? node.size() : size;
  }
  void begin_item(std::size_t index) override {
    const Level& list = levels_.back();
    const std::string path = fmt::format("{}[{}]", list.path, index);
    const YAML::Node node = list.node.IsSequence() ? list.node[index] : YAML::Node(YAML::NodeType::Undefined);
    if (node.IsDefined() && !node.IsMap()) fail_at(node.Mark().line, path, "must be a group of keys");
    open(node, path);
  }
  void end_item() override { close(); }
  void end_list() override { levels_.pop_back(); }

 private:
  struct Level {
    YAML::Node node;
    std::string path;
    std::vector<std::string> known;
  };

  void open(const YAML::Node& node, std::string path) { levels_.push_back({node, std::move(path), {}}); }
  void close() {
    check_unknown(levels_.back());
    levels_.pop_back();
  }

  // The value of a key of the current map, or an undefined node; remembers the key as known.
  YAML::Node take(const char* name) {
    Level& level = levels_.back();
    level.known.emplace_back(name);
    if (!level.node.IsMap()) return YAML::Node(YAML::NodeType::Undefined);
    const YAML::Node node = std::as_const(level.node)[name];  // the non-const operator would insert the key
    return node.IsDefined() && !node.IsNull() ? node : YAML::Node(YAML::NodeType::Undefined);
  }

  std::string join(const std::string& name) const {
    return levels_.back().path.empty() ? name : levels_.back().path + "." + name;
  }

  [[noreturn]] void fail(const YAML::Node& node, const char* name, const std::string& what) const {
    fail_at(node.Mark().line, join(name), what);
  }
  [[noreturn]] void fail_at(int line, const std::string& key, const std::string& what) const {
    const std::string at = line >= 0 ? fmt::format(":{}", line + 1) : "";
    throw ConfigError(fmt::format("{}{}: {}{}{}", where_, at, key, key.empty() ? "" : ": ", what));
  }

  double number(const YAML::Node& node, const FieldInfo& info) const {
    double v = 0;
    if (!node.IsScalar() || !YAML::convert<double>::decode(node, v) || !std::isfinite(v))
      fail(node, info.name, "must be a finite number");
    if (v < info.min || v > info.max) {
      const std::string range = std::isinf(info.max)   ? fmt::format("at least {}", info.min)
                                : std::isinf(info.min) ? fmt::format("at most {}", info.max)
                                                       : fmt::format("from {} to {}", info.min, info.max);
      fail(node, info.name,
           fmt::format("{} is out of range; must be {}{}{}", v, range, *info.unit ? " " : "", info.unit));
    }
    return v;
  }

  void check_unknown(const Level& level) const {
    if (!level.node.IsMap()) return;
    std::vector<std::string> seen;
    for (const auto& entry : level.node) {
      const std::string key = entry.first.Scalar();
      const std::string path = level.path.empty() ? key : level.path + "." + key;
      if (std::find(level.known.begin(), level.known.end(), key) == level.known.end())
        fail_at(entry.first.Mark().line, path, "unknown key" + did_you_mean(key, level.known));
      // yaml-cpp would take the first and drop the second without a word
      if (std::find(seen.begin(), seen.end(), key) != seen.end())
        fail_at(entry.first.Mark().line, path, "is given twice; keep one");
      seen.push_back(key);
    }
  }

  std::string where_;
  std::vector<Level> levels_;
};

}  // namespace

YAML::Node load_yaml(const std::string& file) {
  if (!std::filesystem::is_regular_file(file)) throw InputError(file + ": no such file; check the path");
  try {
    YAML::Node node = YAML::LoadFile(file);
    if (!node.IsMap()) throw InputError(file + ": holds no keys; expected a YAML map");
    return node;
  } catch (const YAML::BadFile&) {
    throw InputError(file + ": cannot be read; check its permissions");
  } catch (const YAML::Exception& e) {
    throw InputError(fmt::format("{}:{}: not valid YAML: {}", file, e.mark.line + 1, e.msg));
  }
}

void read_fields(const YAML::Node& node, const std::string& where, const std::string& path,
                 const std::function<void(FieldVisitor&)>& fields) {
  YamlReader reader(node, where, path);
  fields(reader);
  reader.finish();
}

}  // namespace heartservo
