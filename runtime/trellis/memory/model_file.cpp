// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/memory/model_file.hpp>

#include <fmt/format.h>

#include <cstdint>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/base/input_file.hpp>
#include <trellis/base/random.hpp>
#include <trellis/memory/bytes.hpp>
#include <trellis/memory/grid.hpp>
#include <trellis/memory/search_state.hpp>

namespace trellis {

namespace {

constexpr std::size_t word = 8;

}  // namespace

const ModelKind cell_classifier = {.magic = "Trellis heuristic\n",
                                   .what = "a classifier of cells, for the guide 'learned'",
                                   .command = "trellis experience --data FOLDER",
                                   .version = 1,
                                   .features = cell_features};
const ModelKind search_heuristic = {.magic = "Trellis search heuristic\n",
                                    .what = "a search heuristic, for the planner 'best_first'",
                                    .command = "trellis experience --search --data FOLDER",
                                    .version = 1,
                                    .features = search_features};

std::string model_bytes(const ModelKind& kind, const Forest& forest, std::size_t cells,
                        const std::string& description) {
  const std::string trees = forest.bytes();
  std::string all(kind.magic);
  put_integer(all, kind.version);
  put_integer(all, kind.features);
  put_integer(all, cells);
  put_integer(all, description.size());
  put_integer(all, trees.size());
  all += description + trees;
  put_integer(all, stable_hash(all));
  return all;
}

ModelFile read_model(const ModelKind& kind, const std::string& file) {
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) {
    throw Error(fmt::format("{}: there is no such model; {} --out {} makes one", file, kind.command, file));
  }
  constexpr std::uintmax_t most = std::uintmax_t{4} << 30U;
  InputFile in(file, most);
  const std::string all = in.rest();
  if (!in.fault().empty()) throw Error(fmt::format("{}: the model cannot be read: {}", file, in.fault()));
  for (const ModelKind* other : {&cell_classifier, &search_heuristic}) {
    if (other->magic == kind.magic || !all.starts_with(other->magic)) continue;
    throw Error(fmt::format("{}: the model is {}; expected {}, which {} --out FILE makes", file, other->what, kind.what,
                            kind.command));
  }
  const std::size_t head = kind.magic.size() + 5 * word;
  if (!all.starts_with(kind.magic)) throw Error(fmt::format("{}: is no model of trellis experience", file));
  const auto damaged = [&](const char* how) { return Error(fmt::format("{}: the model is damaged: {}", file, how)); };
  if (all.size() < head + word) throw damaged("it ends too early");
  const auto number = [&](std::size_t i) { return integer_at(all, kind.magic.size() + i * word); };
  if (number(0) != kind.version || number(1) != kind.features) {
    throw Error(
        fmt::format("{}: the model is of version {} with {} features, and this trellis reads version {} with {}; "
                    "train it again",
                    file, number(0), number(1), kind.version, kind.features));
  }
  constexpr std::uint64_t most_cells = 1000;
  const std::uint64_t cells = number(2);
  const std::uint64_t described = number(3);
  const std::uint64_t forest = number(4);
  if (described > all.size() || forest > all.size() || head + described + forest + word != all.size()) {
    throw damaged("it is longer or shorter than it says");
  }
  const std::size_t end = head + described + forest;
  if (stable_hash(std::string_view(all).substr(0, end)) != integer_at(all, end)) {
    throw damaged("its bytes are not those written");
  }
  if (cells < 2 || cells > most_cells) throw damaged("its grid cannot be");
  try {
    return {Forest::from_bytes(all.substr(head + described, forest), kind.features), static_cast<std::size_t>(cells),
            all.substr(head, described)};
  } catch (const Error& error) {
    throw damaged(error.what());
  }
}

}  // namespace trellis
