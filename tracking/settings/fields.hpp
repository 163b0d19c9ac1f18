#pragma once
// A struct of options lists its fields once, in `void fields(FieldVisitor&)`. Reading from YAML (yaml_reader.hpp),
// writing the resolved configuration (yaml_writer.hpp), the key-by-key documentation and the JSON schema (document.hpp)
// all come from that one list, so they cannot disagree.
#include <Eigen/Core>
#include <limits>
#include <string>
#include <vector>

namespace heartservo {

/// What is said about one field. `unit` is "" for a pure number; the range is inclusive and checked on reading.
struct FieldInfo {
  const char* name;
  const char* unit;
  const char* doc;
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
};

class FieldVisitor {
 public:
  virtual ~FieldVisitor() = default;

  virtual void field(const FieldInfo& info, double& value) = 0;
  virtual void field(const FieldInfo& info, int& value) = 0;
  virtual void field(const FieldInfo& info, bool& value) = 0;
  virtual void field(const FieldInfo& info, std::string& value) = 0;
  /// A list of numbers; `size` > 0 asks for exactly that many, 0 for any number.
  virtual void field(const FieldInfo& info, std::vector<double>& value, std::size_t size) = 0;
  /// One of `names`; a reader refuses anything else, with a suggestion.
  virtual void choice(const FieldInfo& info, std::string& value, const std::vector<std::string>& names) = 0;

  void field(const FieldInfo& info, Eigen::Vector3d& value) {
    std::vector<double> v{value.x(), value.y(), value.z()};
    field(info, v, 3);
    value = Eigen::Vector3d(v.at(0), v.at(1), v.at(2));
  }

  /// A nested struct under its own key.
  template <class Options>
  void group(const char* name, const char* doc, Options& options) {
    begin_group(name, doc);
    options.fields(*this);
    end_group();
  }

  /// A list of structs; reading resizes it.
  template <class Options>
  void list(const char* name, const char* doc, std::vector<Options>& items) {
    if (describes_types()) {  // documentation and schema want to see one item, with its defaults
      begin_list(name, doc, 1);
      Options example;
      begin_item(0);
      example.fields(*this);
      end_item();
      end_list();
      return;
    }
    items.resize(begin_list(name, doc, items.size()));
    for (std::size_t i = 0; i < items.size(); ++i) {
      begin_item(i);
      items[i].fields(*this);
      end_item();
    }
    end_list();
  }

 protected:
  virtual void begin_group(const char* name, const char* doc) = 0;
  virtual void end_group() = 0;
  virtual std::size_t begin_list(const char* name, const char* doc, std::size_t size) = 0;
  virtual void begin_item(std::size_t index) = 0;
  virtual void end_item() = 0;
  virtual void end_list() = 0;
  virtual bool describes_types() const { return false; }
};

}  // namespace heartservo
