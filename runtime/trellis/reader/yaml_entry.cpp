// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/reader/yaml_entry.hpp>

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

namespace trellis {

struct YamlEntry::Node {
  enum class Kind : unsigned char { none, word, list, map };
  Kind kind = Kind::none;
  std::size_t line = 0;      ///< 0: it has none
  std::size_t key_line = 0;  ///< of its key, in a map
  std::string word;
  std::vector<std::string> keys;  ///< of a map, for each node
  std::vector<Node> nodes;        ///< of a list or a map
  mutable bool used = false;      ///< its reader asked for it
};

namespace {

/// Copies a document of yaml-cpp. An alias becomes a copy of what it refers to, so the copies are counted.
class Copier {
 public:
  explicit Copier(const SourceText& text) : text_(text) {}

  template <class Node>
  void copy(const YAML::Node& from, Node& to, std::size_t depth) {
    constexpr std::size_t most = 1'200'000;  // 2 MiB of "1,1,1,..."
    constexpr std::size_t deepest = 500;
    const auto mark = from.Mark();
    if (!mark.is_null()) to.line = static_cast<std::size_t>(mark.line) + 1;
    const std::size_t line = std::max<std::size_t>(to.line, 1);
    if (++count_ > most) throw text_.error(line, fmt::format("its aliases expand to more than {} entries", most));
    if (depth > deepest) throw text_.error(line, fmt::format("its entries are nested more than {} times", deepest));
    if (from.IsScalar()) {
      to.kind = Node::Kind::word;
      to.word = from.Scalar();
    } else if (from.IsSequence()) {
      to.kind = Node::Kind::list;
      to.nodes.resize(from.size());
      std::size_t i = 0;
      for (const auto& entry : from) copy(entry, to.nodes[i++], depth + 1);
    } else if (from.IsMap()) {
      to.kind = Node::Kind::map;
      std::set<std::string> known;
      for (const auto& entry : from) {
        if (!entry.first.IsScalar()) continue;
        const std::string& key = entry.first.Scalar();
        if (!known.insert(key).second) {
          throw text_.error(static_cast<std::size_t>(std::max(entry.first.Mark().line, 0)) + 1,
                            fmt::format("the key '{}' is here twice", key));
        }
        to.keys.push_back(key);
        copy(entry.second, to.nodes.emplace_back(), depth + 1);
        // A block begins below its key, where a reader of the message would not look for it.
        if (!entry.first.Mark().is_null()) {
          to.nodes.back().key_line = static_cast<std::size_t>(entry.first.Mark().line) + 1;
        }
      }
    }
  }

 private:
  const SourceText& text_;
  std::size_t count_ = 0;
};

}  // namespace

YamlEntry YamlEntry::root(const SourceText& text, const std::string& expected) {
  constexpr std::size_t most = std::size_t{2} << 20U;
  std::size_t bytes = 0;
  for (const std::string& line : text.lines) bytes += line.size() + 1;
  if (bytes > most) throw text.error(1, fmt::format("{} bytes, at most {} are read as YAML", bytes, most));
  try {
    const YAML::Node node = YAML::Load(text.joined());
    if (!node.IsMap()) throw text.error(1, fmt::format("no scene that can be read: expected {}", expected));
    const auto document = std::make_shared<Node>();
    Copier(text).copy(node, *document, 0);
    return {text, document, *document, "the file", 1};
  } catch (const YAML::Exception& e) {
    const auto line = static_cast<std::size_t>(std::max(e.mark.line, 0) + 1);
    throw text.error(line, fmt::format("no scene that can be read: expected {} ({})", expected, e.msg));
  }
}

bool YamlEntry::is_map() const { return node_->kind == Node::Kind::map; }

bool YamlEntry::is_list() const { return node_->kind == Node::Kind::list; }

bool YamlEntry::empty() const { return node_->word.empty() && node_->nodes.empty(); }

const YamlEntry::Node* YamlEntry::find(const std::string& key) const {
  if (!is_map()) return nullptr;
  const auto found = std::find(node_->keys.begin(), node_->keys.end(), key);
  if (found == node_->keys.end()) return nullptr;
  const Node& node = node_->nodes[static_cast<std::size_t>(found - node_->keys.begin())];
  node.used = true;
  return &node;
}

bool YamlEntry::has(const std::string& key) const { return find(key) != nullptr; }

YamlEntry YamlEntry::at(const std::string& key) const {
  if (!is_map()) throw error(fmt::format("{} is no map, expected one with '{}'", name_, key));
  const Node* node = find(key);
  if (node == nullptr) throw error(fmt::format("'{}' is missing, expected in {}", key, name_));
  return {*text_, document_, *node, fmt::format("'{}'", key), line_};
}

std::vector<YamlEntry> YamlEntry::list() const {
  if (!is_list()) throw error(fmt::format("{} is no list, expected one", name_));
  std::vector<YamlEntry> entries;
  entries.reserve(node_->nodes.size());
  for (std::size_t i = 0; i < node_->nodes.size(); ++i) {
    entries.push_back({*text_, document_, node_->nodes[i], fmt::format("entry {} of {}", i + 1, name_), line_});
  }
  return entries;
}

std::vector<YamlEntry> YamlEntry::list(const std::string& key) const {
  if (!has(key) || at(key).node_->kind == Node::Kind::none) return {};
  return at(key).list();
}

std::vector<std::string> YamlEntry::keys() const { return node_->keys; }

std::string YamlEntry::word() const {
  if (node_->kind != Node::Kind::word) throw error(fmt::format("{} is no word, expected one", name_));
  return node_->word;
}

std::string YamlEntry::word(const std::string& key) const {
  if (!has(key) || at(key).node_->kind == Node::Kind::none) return "";
  return at(key).word();
}

double YamlEntry::number() const {
  double value = 0.0;
  const bool scalar = node_->kind == Node::Kind::word;
  if (!scalar || !YAML::convert<double>::decode(YAML::Node(node_->word), value) || !std::isfinite(value)) {
    throw error(fmt::format("{} is {}, expected a finite number", name_,
                            scalar ? fmt::format("'{}'", node_->word) : "no scalar"));
  }
  return value;
}

std::vector<double> YamlEntry::numbers(std::size_t count, std::string_view what) const {
  if (!is_list() || node_->nodes.size() != count) {
    throw error(fmt::format("{} is {}, expected {} numbers: {}", name_,
                            is_list() ? fmt::format("a list of {}", node_->nodes.size()) : "no list", count, what));
  }
  std::vector<double> values;
  for (const YamlEntry& entry : list()) values.push_back(entry.number());
  return values;
}

void YamlEntry::require(const std::string& expected) const {
  if (word() != expected) throw error(fmt::format("{} is '{}', expected '{}'", name_, word(), expected));
}

void YamlEntry::know() const {
  std::vector<const Node*> open = {node_};
  while (!open.empty()) {
    const Node& node = *open.back();
    open.pop_back();
    node.used = true;
    for (const Node& one : node.nodes) open.push_back(&one);
  }
}

void YamlEntry::know(const std::vector<std::string>& keys) const {
  for (const std::string& key : keys) {
    if (has(key)) at(key).know();
  }
}

std::vector<Unused> YamlEntry::unused() const {
  std::vector<Unused> all;
  std::vector<const Node*> open = {node_};
  while (!open.empty()) {
    const Node& node = *open.back();
    open.pop_back();
    for (std::size_t i = 0; i < node.nodes.size(); ++i) {
      const Node& one = node.nodes[i];
      if (node.kind == Node::Kind::map && !one.used) {
        all.push_back({node.keys[i], std::max<std::size_t>(one.key_line, 1)});
      } else {
        open.push_back(&one);
      }
    }
  }
  return all;
}

YamlEntry::YamlEntry(const SourceText& text, std::shared_ptr<const Node> document, const Node& node, std::string name,
                     std::size_t parent_line)
    : text_(&text), document_(std::move(document)), node_(&node), name_(std::move(name)) {
  line_ = node.line == 0 ? parent_line : node.line;
}

}  // namespace trellis
