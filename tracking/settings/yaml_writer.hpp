#pragma once
// Writes the resolved configuration: every field with its value, as YAML that yaml_reader.hpp reads back.
#include <functional>
#include <string>

namespace heartservo {

class FieldVisitor;

std::string write_fields(const std::function<void(FieldVisitor&)>& fields);

/// `options` is not changed; fields() is shared with reading and so is not const.
template <class Options>
std::string to_yaml(Options options) {
  return write_fields([&](FieldVisitor& visitor) { options.fields(visitor); });
}

}  // namespace heartservo
