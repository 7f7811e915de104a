// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/reader/yaml_entry.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace trellis {

YamlEntry YamlEntry::root(const SourceText& text, const std::string& expected) {
  constexpr std::size_t most = std::size_t{2} << 20U;
  std::size_t bytes = 0;
  for (const std::string& line : text.lines) bytes += line.size() + 1;
  if (bytes > most) throw text.error(1, fmt::format("{} bytes, at most {} are read as YAML", bytes, most));
  try {
    const YAML::Node node = YAML::Load(text.joined());
    if (!node.IsMap()) throw text.error(1, fmt::format("no scene that can be read: expected {}", expected));
    return {text, node, "the file", 1};
  } catch (const YAML::Exception& e) {
    const auto line = static_cast<std::size_t>(std::max(e.mark.line, 0) + 1);
    throw text.error(line, fmt::format("no scene that can be read: expected {} ({})", expected, e.msg));
  }
}

YamlEntry YamlEntry::at(const std::string& key) const {
  if (!node_.IsMap()) throw error(fmt::format("{} is no map, expected one with '{}'", name_, key));
  const YAML::Node child = node_[key];
  if (!child) throw error(fmt::format("'{}' is missing, expected in {}", key, name_));
  return {*text_, child, fmt::format("'{}'", key), line_};
}

std::vector<YamlEntry> YamlEntry::list() const {
  if (!node_.IsSequence()) throw error(fmt::format("{} is no list, expected one", name_));
  std::vector<YamlEntry> entries;
  for (std::size_t i = 0; i < node_.size(); ++i) {
    entries.push_back({*text_, node_[i], fmt::format("entry {} of {}", i + 1, name_), line_});
  }
  return entries;
}

std::vector<std::string> YamlEntry::keys() const {
  std::vector<std::string> keys;
  for (const auto& entry : node_) {
    if (entry.first.IsScalar()) keys.push_back(entry.first.Scalar());
  }
  return keys;
}

std::string YamlEntry::word() const {
  if (!node_.IsScalar()) throw error(fmt::format("{} is no word, expected one", name_));
  return node_.Scalar();
}

double YamlEntry::number() const {
  double value = 0.0;
  if (!node_.IsScalar() || !YAML::convert<double>::decode(node_, value) || !std::isfinite(value)) {
    throw error(fmt::format("{} is {}, expected a finite number", name_,
                            node_.IsScalar() ? fmt::format("'{}'", node_.Scalar()) : "no scalar"));
  }
  return value;
}

std::vector<double> YamlEntry::numbers(std::size_t count, std::string_view what) const {
  if (!node_.IsSequence() || node_.size() != count) {
    throw error(fmt::format("{} is {}, expected {} numbers: {}", name_,
                            node_.IsSequence() ? fmt::format("a list of {}", node_.size()) : "no list", count, what));
  }
  std::vector<double> values;
  for (const YamlEntry& entry : list()) values.push_back(entry.number());
  return values;
}

void YamlEntry::require(const std::string& expected) const {
  if (word() != expected) throw error(fmt::format("{} is '{}', expected '{}'", name_, word(), expected));
}

YamlEntry::YamlEntry(const SourceText& text, const YAML::Node& node, std::string name, std::size_t parent_line)
    : text_(&text), node_(node), name_(std::move(name)) {
  const auto mark = node_.Mark();
  line_ = mark.is_null() ? parent_line : static_cast<std::size_t>(mark.line) + 1;
}

}  // namespace trellis
