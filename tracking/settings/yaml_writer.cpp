#include "tracking/settings/yaml_writer.hpp"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>

#include "tracking/settings/fields.hpp"

namespace heartservo {

namespace {

class YamlWriter final : public FieldVisitor {
 public:
  YamlWriter() { out_ << YAML::BeginMap; }

  // fmt's shortest round-trip form; yaml-cpp's own would print 0.1 as 0.10000000000000001
  // NaN or infinity stand for "not given", which null says: the reader then keeps the default.
  void field(const FieldInfo& info, double& value) override {
    if (std::isfinite(value))
      key(info.name) << fmt::format("{}", value);
    else
      key(info.name) << YAML::Null;
  }
  void field(const FieldInfo& info, int& value) override { key(info.name) << value; }
  void field(const FieldInfo& info, bool& value) override { key(info.name) << value; }
  void field(const FieldInfo& info, std::string& value) override { key(info.name) << YAML::DoubleQuoted << value; }
  void field(const FieldInfo& info, std::vector<double>& value, std::size_t) override {
    key(info.name) << YAML::Flow << YAML::BeginSeq;
    for (const double v : value) out_ << fmt::format("{}", v);
    out_ << YAML::EndSeq;
  }
  void choice(const FieldInfo& info, std::string& value, const std::vector<std::string>& names) override {
    // so does a choice that nobody made: "" is no name that the reader would take
    if (value.empty() && std::find(names.begin(), names.end(), value) == names.end())
      key(info.name) << YAML::Null;
    else
      key(info.name) << value;
  }

  std::string finish() {
    out_ << YAML::EndMap;
    return std::string(out_.c_str()) + "\n";
  }

 protected:
  void begin_group(const char* name, const char*) override { key(name) << YAML::BeginMap; }
  void end_group() override { out_ << YAML::EndMap; }
  std::size_t begin_list(const char* name, const char*, std::size_t size) override {
    key(name) << YAML::BeginSeq;
    return size;
  }
  void begin_item(std::size_t) override { out_ << YAML::BeginMap; }
  void end_item() override { out_ << YAML::EndMap; }
  void end_list() override { out_ << YAML::EndSeq; }

 private:
  YAML::Emitter& key(const char* name) { return out_ << YAML::Key << name << YAML::Value; }

  YAML::Emitter out_;
};

}  // namespace

std::string write_fields(const std::function<void(FieldVisitor&)>& fields) {
  YamlWriter writer;
  fields(writer);
  return writer.finish();
}

}  // namespace heartservo
