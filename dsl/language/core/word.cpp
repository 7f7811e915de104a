// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/language/core/word.hpp>

#include <cmath>
#include <variant>

#include <trellis/base/error.hpp>

namespace trellis::dsl {

std::string Word::module() const {
  const auto dot = name.rfind('.');
  return dot == std::string::npos ? "" : name.substr(0, dot);
}

std::vector<std::string> Word::named() const {
  std::vector<std::string> names;
  names.reserve(fields.size() + options.size());
  for (const auto& field : fields) names.push_back(field.name);
  for (const auto& option : options) names.push_back(option.name);
  return names;
}

std::string_view Word::kind_text() const {
  switch (kind) {
    case Kind::planner: return "planner";
    case Kind::guide: return "guide";
    case Kind::target: return "target";
    case Kind::estimator: return "estimator";
    case Kind::constructor: return "constructor";
    case Kind::function: return "function";
    case Kind::module: return "module";
  }
  throw Fault("unknown kind of word");
}

std::string default_text(const Option& option) {
  const auto* number = std::get_if<double>(&option.default_value);
  return number != nullptr && std::isinf(*number) ? "math.huge" : to_string(option.default_value);
}

}  // namespace trellis::dsl
