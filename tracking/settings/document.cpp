#include "tracking/settings/document.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "tracking/settings/fields.hpp"

namespace heartservo {

namespace {

using Json = nlohmann::ordered_json;

std::string range_of(const FieldInfo& info) {
  if (std::isinf(info.min) && std::isinf(info.max)) return "";
  if (std::isinf(info.max)) return fmt::format("≥ {}", info.min);
  if (std::isinf(info.min)) return fmt::format("≤ {}", info.max);
  return fmt::format("{} to {}", info.min, info.max);
}

class MarkdownWriter final : public FieldVisitor {
 public:
  MarkdownWriter() { open(""); }

  void field(const FieldInfo& info, double& value) override {
    row(info, "number", std::isfinite(value) ? fmt::format("{}", value) : "", range_of(info));
  }
  void field(const FieldInfo& info, int& value) override {
    row(info, "whole number", fmt::format("{}", value), range_of(info));
  }
  void field(const FieldInfo& info, bool& value) override { row(info, "true or false", fmt::format("{}", value), ""); }
  void field(const FieldInfo& info, std::string& value) override {
    row(info, "text", value.empty() ? "" : fmt::format("\"{}\"", value), "");
  }
  void field(const FieldInfo& info, std::vector<double>& value, std::size_t size) override {
    row(info, size > 0 ? fmt::format("list of {} numbers", size) : "list of numbers",
        fmt::format("[{}]", fmt::join(value, ", ")), range_of(info));
  }
  void choice(const FieldInfo& info, std::string& value, const std::vector<std::string>& names) override {
    row(info, "name", value, fmt::format("{}", fmt::join(names, ", ")));
  }

  std::string finish() const {
    std::string text;
    for (const auto& group : groups_) {
      if (group.rows.empty() && group.doc.empty()) continue;
      if (!text.empty()) text += "\n";
      if (!group.path.empty()) text += fmt::format("### `{}`\n\n{}\n\n", group.path, group.doc);
      if (group.rows.empty()) continue;
      text += "| Key | Type | Unit | Default | Range | Meaning |\n|---|---|---|---|---|---|\n" + group.rows;
    }
    return text;
  }

 protected:
  void begin_group(const char* name, const char* doc) override { open(join(name), doc); }
  void end_group() override { open_.pop_back(); }
  std::size_t begin_list(const char* name, const char* doc, std::size_t) override {
    open(join(name) + "[]", doc);
    return 1;
  }
  void begin_item(std::size_t) override {}
  void end_item() override {}
  void end_list() override { open_.pop_back(); }
  bool describes_types() const override { return true; }

 private:
  struct Group {
    std::string path, doc, rows;
  };

  void open(std::string path, const char* doc = "") {
    open_.push_back(groups_.size());
    groups_.push_back({std::move(path), doc, ""});
  }
  Group& current() { return groups_[open_.back()]; }
  std::string join(const std::string& name) { return current().path.empty() ? name : current().path + "." + name; }

  // '|' would end a cell of the table
  static std::string cell(const std::string& text) {
    std::string result;
    for (const char c : text) result += c == '|' ? "\\|" : std::string(1, c == '\n' ? ' ' : c);
    return result;
  }

  void row(const FieldInfo& info, const std::string& type, const std::string& value, const std::string& range) {
    current().rows += fmt::format("| `{}` | {} | {} | {} | {} | {} |\n", join(info.name), type, cell(info.unit),
                                  value.empty() ? "" : fmt::format("`{}`", cell(value)), cell(range), cell(info.doc));
  }

  std::vector<Group> groups_;      // in the order of appearance
  std::vector<std::size_t> open_;  // from the top to the current one
};

class SchemaWriter final : public FieldVisitor {
 public:
  explicit SchemaWriter(const std::string& title) {
    Json root{{"$schema", "https://json-schema.org/draft/2020-12/schema"}, {"title", title}};
    root.update(object());
    open_.push_back(std::move(root));
  }

  void field(const FieldInfo& info, double& value) override {
    Json schema{{"type", "number"}};
    limit(schema, info);
    if (std::isfinite(value)) schema["default"] = value;  // NaN stands for "not given"
    add(info, std::move(schema));
  }
  void field(const FieldInfo& info, int& value) override {
    Json schema{{"type", "integer"}};
    limit(schema, info);
    schema["default"] = value;
    add(info, std::move(schema));
  }
  void field(const FieldInfo& info, bool& value) override { add(info, {{"type", "boolean"}, {"default", value}}); }
  void field(const FieldInfo& info, std::string& value) override {
    // 2007 and true are texts to the reader where it expects one, and numbers and booleans to an editor
    add(info, {{"type", {"string", "number", "boolean"}}, {"default", value}});
  }
  void field(const FieldInfo& info, std::vector<double>& value, std::size_t size) override {
    Json item{{"type", "number"}};
    limit(item, info);
    Json schema{{"type", "array"}, {"items", item}};
    if (size > 0) schema["minItems"] = schema["maxItems"] = size;
    schema["default"] = value;
    add(info, std::move(schema));
  }
  void choice(const FieldInfo& info, std::string& value, const std::vector<std::string>& names) override {
    Json schema{{"type", "string"}, {"enum", names}};
    // "" stands for "not given" and is no choice
    if (std::find(names.begin(), names.end(), value) != names.end()) schema["default"] = value;
    add(info, std::move(schema));
  }

  std::string finish() const { return open_.front().dump(2) + "\n"; }

 protected:
  void begin_group(const char* name, const char* doc) override { open(name, doc); }
  void end_group() override {
    close([](Json group) { return group; });
  }
  std::size_t begin_list(const char* name, const char* doc, std::size_t) override {
    open(name, doc);
    return 1;
  }
  void begin_item(std::size_t) override {}
  void end_item() override {}
  void end_list() override {
    close([](Json item) {
      Json list{{"description", item["description"]}, {"type", "array"}};
      item.erase("description");
      list["items"] = std::move(item);
      return list;
    });
  }
  bool describes_types() const override { return true; }

 private:
  static Json object() { return {{"type", "object"}, {"additionalProperties", false}, {"properties", Json::object()}}; }

  static void limit(Json& schema, const FieldInfo& info) {
    if (!std::isinf(info.min)) schema["minimum"] = info.min;
    if (!std::isinf(info.max)) schema["maximum"] = info.max;
  }

  void open(const char* name, const char* doc) {
    names_.emplace_back(name);
    Json group{{"description", doc}};
    group.update(object());
    open_.push_back(std::move(group));
  }

  template <class Wrap>
  void close(Wrap wrap) {
    Json group = wrap(std::move(open_.back()));
    open_.pop_back();
    open_.back()["properties"][names_.back()] = std::move(group);
    names_.pop_back();
  }

  void add(const FieldInfo& info, const Json& schema) {
    const std::string unit = info.unit;
    Json described{{"description", unit.empty() ? info.doc : fmt::format("{} [{}]", info.doc, unit)}};
    described.update(schema);
    open_.back()["properties"][info.name] = std::move(described);
  }

  std::vector<Json> open_;          // objects, from the root to the current one
  std::vector<std::string> names_;  // of all but the root
};

}  // namespace

std::string markdown_of(const std::function<void(FieldVisitor&)>& fields) {
  MarkdownWriter writer;
  fields(writer);
  return writer.finish();
}

std::string json_schema_of(const std::function<void(FieldVisitor&)>& fields, const std::string& title) {
  SchemaWriter writer(title);
  fields(writer);
  return writer.finish();
}

}  // namespace heartservo
