// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <yaml-cpp/yaml.h>

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include <trellis/reader/formats.hpp>

namespace trellis {

/// A node of a YAML file with the file's name and its name in messages, so that each message gives the line. The
/// file's text outlives it.
class YamlEntry {
 public:
  /// \param expected  what the file would be: "a YAML map"
  /// \throws Error where the text is no map of YAML, or too large
  static YamlEntry root(const SourceText& text, const std::string& expected);

  [[nodiscard]] Error error(const std::string& fault) const { return text_->error(line_, fault); }
  [[nodiscard]] std::size_t line() const { return line_; }
  [[nodiscard]] bool has(const std::string& key) const { return node_.IsMap() && node_[key]; }
  [[nodiscard]] YamlEntry at(const std::string& key) const;
  [[nodiscard]] std::vector<YamlEntry> list() const;
  [[nodiscard]] std::vector<std::string> keys() const;
  [[nodiscard]] std::string word() const;
  [[nodiscard]] double number() const;
  /// Returns a list of numbers; `what` names their meaning: "x, y".
  [[nodiscard]] std::vector<double> numbers(std::size_t count, std::string_view what) const;
  /// The word must be `expected`: Trellis does not read the format's other options.
  void require(const std::string& expected) const;

 private:
  YamlEntry(const SourceText& text, const YAML::Node& node, std::string name, std::size_t parent_line);

  const SourceText* text_;
  YAML::Node node_;
  std::string name_;
  std::size_t line_ = 1;
};

}  // namespace trellis
