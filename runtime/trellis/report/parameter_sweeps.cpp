// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/report/parameter_sweeps.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

namespace trellis {

namespace {

using Json = nlohmann::json;

constexpr std::size_t least_values = 3;

/// Returns "scale of shrink" for the number at a place in the description of a strategy.
std::string option_name(const Json& spec, Json::json_pointer place) {
  std::string name = place.back();
  while (!place.empty()) {
    place.pop_back();
    const Json& owner = spec.at(place);
    for (const char* kind : {"guide", "planner"}) {
      const auto found = owner.find(kind);
      if (owner.is_object() && found != owner.end() && found->is_string()) {
        return fmt::format("{} of {}", name, found->get<std::string>());
      }
    }
  }
  return name;
}

/// Returns a strategy's text with a word instead of the first number of this value; the text where it has none.
std::string with_word(const std::string& text, double value, const std::string& word) {
  const std::string number = fmt::format("{}", value);
  const auto part_of_word = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '.' || c == '_';
  };
  for (auto at = text.find(number); at != std::string::npos; at = text.find(number, at + 1)) {
    const std::size_t end = at + number.size();
    const bool whole = (at == 0 || !part_of_word(text[at - 1])) && (end == text.size() || !part_of_word(text[end]));
    if (whole) return text.substr(0, at) + word + text.substr(end);
  }
  return text;
}

}  // namespace

bool ParameterSweep::has(std::size_t strategy) const {
  return std::any_of(curves.begin(), curves.end(), [strategy](const ParameterCurve& curve) {
    return std::find(curve.strategies.begin(), curve.strategies.end(), strategy) != curve.strategies.end();
  });
}

std::vector<ParameterSweep> parameter_sweeps(const CostData& data) {
  // Strategies by the place of the number, then by all else, then by the number.
  std::map<std::string, std::map<std::string, std::map<double, std::size_t>>> places;
  for (std::size_t s = 0; s < data.strategies.size(); ++s) {
    if (data.strategies[s].spec.empty()) continue;
    const Json spec = Json::parse(data.strategies[s].spec);
    const Json flat = spec.flatten();
    for (const auto& [place, value] : flat.items()) {
      if (!value.is_number()) continue;
      Json rest = spec;
      rest[Json::json_pointer(place)] = nullptr;
      places[place][rest.dump()].emplace(value.get<double>(), s);
    }
  }
  std::vector<ParameterSweep> sweeps;
  for (const auto& [place, by_rest] : places) {
    ParameterSweep sweep;
    for (const auto& [rest, alike] : by_rest) {
      if (alike.size() < least_values) continue;
      const Json::json_pointer pointer(place);
      sweep.option = option_name(Json::parse(data.strategies[alike.begin()->second].spec), pointer);
      ParameterCurve curve;
      for (const auto& [value, strategy] : alike) {
        curve.values.push_back(value);
        curve.strategies.push_back(strategy);
      }
      // The text leaves out defaults: take the first that has the number.
      for (std::size_t i = 0; i < curve.values.size(); ++i) {
        const std::string& text = data.strategies[curve.strategies[i]].text;
        curve.name = with_word(text, curve.values[i], pointer.back());
        if (curve.name != text) break;
      }
      sweep.curves.push_back(std::move(curve));
    }
    if (!sweep.curves.empty()) sweeps.push_back(std::move(sweep));
  }
  return sweeps;
}

}  // namespace trellis
