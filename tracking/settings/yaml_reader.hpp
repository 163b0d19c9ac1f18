#pragma once
// Reads a struct with `fields(FieldVisitor&)` from YAML. Unknown keys, wrong types and values out of range throw
// ConfigError with file, line and key (and a suggestion); a missing file or broken YAML throws InputError.
#include <functional>
#include <string>
#include <vector>

namespace YAML {
class Node;
}

namespace heartservo {

class FieldVisitor;

/// Loads a YAML file. Throws InputError: missing, unreadable, malformed (with line), or not a map.
YAML::Node load_yaml(const std::string& file);

/// Reads `node` (a map) into the struct whose list of fields is `fields`; keys that are absent keep their value.
/// `where` names the file in messages, `path` the key that holds the map ("" for the whole file).
void read_fields(const YAML::Node& node, const std::string& where, const std::string& path,
                 const std::function<void(FieldVisitor&)>& fields);

template <class Options>
void read_fields(const YAML::Node& node, const std::string& where, Options& options, const std::string& path = "") {
  read_fields(node, where, path, [&](FieldVisitor& visitor) { options.fields(visitor); });
}

/// The name in `names` nearest to `word`, or "" if none is near: for "did you mean".
std::string nearest_name(const std::string& word, const std::vector<std::string>& names);

/// " (did you mean 'x'?)" or "".
std::string did_you_mean(const std::string& word, const std::vector<std::string>& names);

}  // namespace heartservo
