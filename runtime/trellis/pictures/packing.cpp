// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/pictures/packing.hpp>

#include <algorithm>
#include <string_view>

#include <trellis/base/error.hpp>
#include <trellis/pictures/base64.hpp>

namespace trellis {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint32_t no_row = LevelRows::no_row;

/// Reads what PackedNumbers wrote.
class NumberReader {
 public:
  explicit NumberReader(const Json& text) : bytes_(from_base64(text.get_ref<const std::string&>())) {}
  [[nodiscard]] bool more() const { return at_ < bytes_.size(); }
  std::uint64_t next() {
    std::uint64_t value = 0;
    for (unsigned shift = 0; shift < 64; shift += 7) {
      if (!more()) throw Error("packed samples end within a number");
      const auto byte = static_cast<unsigned char>(bytes_[at_++]);
      value |= std::uint64_t{byte & 127U} << shift;
      if (byte < 128U) return value;
    }
    throw Error("packed samples have a number of more than 64 bits");
  }
  std::int64_t next_signed() { return undone(next()); }
  /// Returns the difference of two rows, which have 32 bits.
  static std::int64_t undone(std::uint64_t zigzag) {
    if (zigzag > (std::uint64_t{1} << 33U)) throw Error("packed samples name a node that is not there");
    const auto half = static_cast<std::int64_t>(zigzag / 2);
    return zigzag % 2 == 0 ? half : -half - 1;
  }

 private:
  std::string bytes_;
  std::size_t at_ = 0;
};

/// \throws Error for a row that is none of `count`
std::uint32_t row_of(std::int64_t row, std::size_t count) {
  if (row < 0 || row >= static_cast<std::int64_t>(count)) throw Error("packed samples name a node that is not there");
  return static_cast<std::uint32_t>(row);
}

LevelRows rows_of(const Json& level) {
  LevelRows rows;
  rows.dimension = level.at("axes").size();
  const auto bytes = [&](const char* name) { return from_base64(level.at(name).get_ref<const std::string&>()); };
  rows.nodes = bytes("nodes");
  rows.proposals = bytes("proposals");
  rows.fates = bytes("fates");
  if (!level.at("classes").is_null()) rows.classes = bytes("classes");
  const std::size_t nodes = rows.node_count();
  if (rows.nodes.size() != 2 * rows.dimension * nodes ||
      rows.proposals.size() != 2 * rows.dimension * rows.fates.size() ||
      (!rows.classes.empty() && rows.classes.size() != nodes)) {
    throw Error("packed samples have lists of different lengths");
  }
  if (!level.at("parents").is_null()) {
    NumberReader parents(level.at("parents"));
    for (std::size_t i = 0; i < nodes; ++i) {
      rows.parents.push_back(row_of(static_cast<std::int64_t>(i) - parents.next_signed(), nodes));
    }
  }
  std::int64_t last = 0;
  for (NumberReader edges(level.at("edges")); edges.more();) {
    last = row_of(last + edges.next_signed(), nodes);
    const std::int64_t to = last + edges.next_signed();
    rows.edges.emplace_back(static_cast<std::uint32_t>(last), row_of(to, nodes));
  }
  NumberReader sources(level.at("source"));
  NumberReader near(level.at("near"));
  NumberReader added(level.at("added"));
  last = 0;
  for (std::size_t i = 0; i < rows.proposal_count(); ++i) {
    rows.sources.push_back(static_cast<std::uint32_t>(sources.next()));
    const std::uint64_t from = near.next();
    rows.near.push_back(from == 0 ? no_row : row_of(static_cast<std::int64_t>(from) - 1, nodes));
    const std::uint64_t to = added.next();
    if (to == 0) {
      rows.added.push_back(no_row);
      continue;
    }
    last = row_of(last + NumberReader::undone(to - 1), nodes);
    rows.added.push_back(static_cast<std::uint32_t>(last));
  }
  return rows;
}

/// The rows of a search that a thinned one keeps, in ascending order.
struct HeldRows {
  std::vector<std::uint32_t> proposals;
  std::vector<std::uint32_t> nodes;
};

/// Returns a `share` of the rows, evenly spaced, with the first and the last.
/// \param always  rows to include in any case
std::vector<std::uint32_t> spread(std::size_t rows, double share, const std::vector<char>& always = {}) {
  std::vector<std::uint32_t> held;
  double due = 1.0;
  for (std::size_t i = 0; i < rows; ++i) {
    if (due >= 1.0 || i + 1 == rows || (!always.empty() && always[i] != 0)) {
      held.push_back(static_cast<std::uint32_t>(i));
      due = std::max(0.0, due - 1.0);
    }
    due += share;
  }
  return held;
}

HeldRows held_rows(const LevelRows& rows, double share) {
  std::vector<char> roots(rows.node_count(), 0);
  for (std::size_t i = 0; i < rows.parents.size(); ++i) {
    if (rows.parents[i] == i) roots[i] = 1;
  }
  return {spread(rows.proposal_count(), share), spread(rows.node_count(), share, roots)};
}

/// Returns how many of the ascending rows are smaller than `row`.
std::uint32_t rows_before(const std::vector<std::uint32_t>& rows, std::uint32_t row) {
  return static_cast<std::uint32_t>(std::lower_bound(rows.begin(), rows.end(), row) - rows.begin());
}

/// Returns the search with the selected rows. A reference to an omitted node becomes one to its nearest selected
/// ancestor; an edge with an omitted end is removed.
LevelRows thinned(const LevelRows& rows, const HeldRows& held) {
  std::vector<std::uint32_t> at(rows.node_count(), no_row);
  for (std::size_t i = 0; i < held.nodes.size(); ++i) at[held.nodes[i]] = static_cast<std::uint32_t>(i);
  const auto ancestor = [&](std::uint32_t row) {
    // A path to a tree's root visits each node at most once.
    for (std::size_t steps = 0; row < at.size() && steps <= at.size(); ++steps) {
      if (at[row] != no_row) return at[row];
      if (row >= rows.parents.size() || rows.parents[row] == row) break;
      row = rows.parents[row];
    }
    return no_row;
  };
  const std::size_t width = 2 * rows.dimension;
  const auto copy = [&](const std::string& from, std::uint32_t row, std::string& to) {
    to.append(from, row * width, width);
  };
  LevelRows out;
  out.dimension = rows.dimension;
  for (std::size_t i = 0; i < held.nodes.size(); ++i) {
    const std::uint32_t row = held.nodes[i];
    copy(rows.nodes, row, out.nodes);
    if (!rows.classes.empty()) out.classes += rows.classes[row];
    if (rows.parents.empty()) continue;
    const std::uint32_t parent = rows.parents[row] == row ? at[row] : ancestor(rows.parents[row]);
    out.parents.push_back(parent == no_row ? static_cast<std::uint32_t>(i) : parent);
  }
  for (const std::uint32_t row : held.proposals) {
    copy(rows.proposals, row, out.proposals);
    out.fates += rows.fates[row];
    out.sources.push_back(rows.sources[row]);
    out.near.push_back(rows.near[row] == no_row ? no_row : ancestor(rows.near[row]));
    out.added.push_back(rows.added[row] == no_row ? no_row : at[rows.added[row]]);
  }
  for (const auto& [a, b] : rows.edges) {
    if (at[a] != no_row && at[b] != no_row) out.edges.emplace_back(at[a], at[b]);
  }
  return out;
}

}  // namespace

void PackedNumbers::add(std::uint64_t value) {
  for (; value > 127U; value >>= 7U) bytes_ += static_cast<char>((value & 127U) | 128U);
  bytes_ += static_cast<char>(value);
}

std::uint64_t PackedNumbers::zigzag(std::int64_t value) {
  return value < 0 ? 2U * static_cast<std::uint64_t>(-(value + 1)) + 1U : 2U * static_cast<std::uint64_t>(value);
}

std::string PackedNumbers::text() const { return base64(bytes_); }

void add_rows(const LevelRows& rows, Json& level) {
  level["nodes"] = base64(rows.nodes);
  // The difference of a node's index and its parent's: after a rewiring the parent may have a larger index.
  PackedNumbers parents;
  for (std::size_t i = 0; i < rows.parents.size(); ++i) {
    parents.add_signed(static_cast<std::int64_t>(i) - static_cast<std::int64_t>(rows.parents[i]));
  }
  level["parents"] = rows.parents.empty() ? Json(nullptr) : Json(parents.text());
  // The first end of an edge relative to that of the edge before, its second end relative to its first.
  PackedNumbers edges;
  std::int64_t last = 0;
  for (const auto& [a, b] : rows.edges) {
    edges.add_signed(static_cast<std::int64_t>(a) - last);
    edges.add_signed(static_cast<std::int64_t>(b) - static_cast<std::int64_t>(a));
    last = a;
  }
  level["edges"] = edges.text();
  level["classes"] = rows.classes.empty() ? Json(nullptr) : Json(base64(rows.classes));
  level["proposals"] = base64(rows.proposals);
  level["fates"] = base64(rows.fates);
  PackedNumbers sources;
  PackedNumbers near;
  PackedNumbers added;
  last = 0;
  for (std::size_t i = 0; i < rows.proposal_count(); ++i) {
    sources.add(rows.sources[i]);
    near.add(rows.near[i] == no_row ? 0 : rows.near[i] + std::uint64_t{1});
    if (rows.added[i] == no_row) {
      added.add(0);
      continue;
    }
    // The difference from the one before, plus one: 0 is none.
    added.add(PackedNumbers::zigzag(static_cast<std::int64_t>(rows.added[i]) - last) + 1);
    last = rows.added[i];
  }
  level["source"] = sources.text();
  level["near"] = near.text();
  level["added"] = added.text();
}

Json thinned_run(const Json& run, double share) try {
  Json out = run;
  std::vector<HeldRows> held;
  for (Json& level : out.at("levels")) {
    const LevelRows rows = rows_of(level);
    held.push_back(held_rows(rows, share));
    add_rows(thinned(rows, held.back()), level);
  }
  for (Json& turn : out.at("turns")) {
    const auto level = turn.at(0).get<std::size_t>();
    if (level >= held.size()) throw Error("packed samples have a turn of a level that is not there");
    const HeldRows& rows = held[level];
    turn.at(1) = rows_before(rows.proposals, turn.at(1).get<std::uint32_t>());
    turn.at(2) = rows_before(rows.nodes, turn.at(2).get<std::uint32_t>());
  }
  return out;
} catch (const Json::exception&) {
  throw Error("packed samples lack a part");
}

}  // namespace trellis
