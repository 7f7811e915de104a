// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <trellis/reader/formats.hpp>
#include <trellis/reader/unused.hpp>

namespace trellis {

/// A node of a YAML file with the file's name and its name in messages, so that each message gives the line. It marks
/// the keys that its reader asks for, so that the others can be named. The file's text outlives it; the entries of a
/// file share its document.
class YamlEntry {
 public:
  /// \param expected  what the file would be: "a YAML map"
  /// \throws Error where the text is no map of YAML, or too large, or has a key twice in one map
  static YamlEntry root(const SourceText& text, const std::string& expected);

  [[nodiscard]] Error error(const std::string& fault) const { return text_->error(line_, fault); }
  [[nodiscard]] std::size_t line() const { return line_; }
  /// Returns "FILE:12: fault", for warnings.
  [[nodiscard]] std::string at_line(const std::string& fault) const { return error(fault).what(); }
  [[nodiscard]] bool is_map() const;
  [[nodiscard]] bool is_list() const;
  /// Whether it has no value, or is an empty list, map or word.
  [[nodiscard]] bool empty() const;
  [[nodiscard]] bool has(const std::string& key) const;
  [[nodiscard]] YamlEntry at(const std::string& key) const;
  [[nodiscard]] std::vector<YamlEntry> list() const;
  /// The list of a key; none where the key is missing or has no value.
  [[nodiscard]] std::vector<YamlEntry> list(const std::string& key) const;
  [[nodiscard]] std::vector<std::string> keys() const;
  [[nodiscard]] std::string word() const;
  /// The word of a key; "" where the key is missing or has no value.
  [[nodiscard]] std::string word(const std::string& key) const;
  [[nodiscard]] double number() const;
  /// Returns a list of numbers; `what` names their meaning: "x, y".
  [[nodiscard]] std::vector<double> numbers(std::size_t count, std::string_view what) const;
  /// The word must be `expected`: Trellis does not read the format's other options.
  void require(const std::string& expected) const;
  /// Marks everything in it: the reader knows it and has no use for it.
  void know() const;
  /// Marks everything in some of its keys.
  void know(const std::vector<std::string>& keys) const;
  /// Returns the keys in it that no reader asked for, but not those within them.
  [[nodiscard]] std::vector<Unused> unused() const;

 private:
  struct Node;
  YamlEntry(const SourceText& text, std::shared_ptr<const Node> document, const Node& node, std::string name,
            std::size_t parent_line);
  [[nodiscard]] const Node* find(const std::string& key) const;

  const SourceText* text_;
  std::shared_ptr<const Node> document_;
  const Node* node_;
  std::string name_;
  std::size_t line_ = 1;
};

}  // namespace trellis
