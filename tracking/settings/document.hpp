#pragma once
// Documentation and JSON schema of options, from the same field lists that are read and written, so they cannot
// disagree with the program. Both show the defaults that the options carry.
#include <functional>
#include <string>

namespace heartservo {

class FieldVisitor;

/// A Markdown table for the keys at the top and one per group and per list: key, type, unit, default, range, meaning.
/// Nested keys are written in full: `loop.latency_s`, `landmarks[].x_m`.
std::string markdown_of(const std::function<void(FieldVisitor&)>& fields);

/// A JSON schema (draft 2020-12) for editors and validators: types, ranges, choices, defaults; unknown keys refused.
std::string json_schema_of(const std::function<void(FieldVisitor&)>& fields, const std::string& title);

template <class Options>
std::string to_markdown(Options options) {
  return markdown_of([&](FieldVisitor& visitor) { options.fields(visitor); });
}

template <class Options>
std::string to_json_schema(Options options, const std::string& title) {
  return json_schema_of([&](FieldVisitor& visitor) { options.fields(visitor); }, title);
}

}  // namespace heartservo
