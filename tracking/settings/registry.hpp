#pragma once
// Engines by name: each engine is one short file, and one line in the table of its room (registry.cpp there). An
// explicit table instead of self-registering objects: a linker drops those from a static library.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "tracking/settings/errors.hpp"
#include "tracking/settings/yaml_reader.hpp"

namespace heartservo {

template <class Interface, class... Arguments>
class Registry {
 public:
  struct Engine {
    std::string name;
    std::string summary;
    std::function<std::unique_ptr<Interface>(Arguments...)> make;
  };

  Registry(std::string kind, std::vector<Engine> engines) : kind_(std::move(kind)), engines_(std::move(engines)) {}

  const std::vector<Engine>& engines() const { return engines_; }

  std::vector<std::string> names() const {
    std::vector<std::string> result;
    for (const auto& engine : engines_) result.push_back(engine.name);
    return result;
  }

  std::unique_ptr<Interface> make(const std::string& name, Arguments... arguments) const {
    return require(name).make(arguments...);
  }

  /// Throws ConfigError for an unknown name, with a suggestion.
  const Engine& require(const std::string& name) const {
    for (const auto& engine : engines_)
      if (engine.name == name) return engine;
    throw ConfigError(fmt::format("{} '{}' is not known{}; choose one of {}", kind_, name, did_you_mean(name, names()),
                                  fmt::join(names(), ", ")));
  }

 private:
  std::string kind_;
  std::vector<Engine> engines_;
};

}  // namespace heartservo
