// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>

#include <trellis/memory/forest.hpp>

namespace trellis {

// Model files: a header with the kind of model, its version and its training data, then the forest and a hash.

/// One kind of model.
struct ModelKind {
  std::string_view magic;    ///< the first bytes of its files
  std::string_view what;     ///< a noun phrase for messages
  std::string_view command;  ///< the options of `trellis experience` that train one
  std::uint64_t version = 1;
  std::size_t features = 0;
};

/// A classifier of cells, for the guide `learned` (Model).
extern const ModelKind cell_classifier;
/// A heuristic of a search of an explicit graph, for the planner `best_first` (SearchModel).
extern const ModelKind search_heuristic;

struct ModelFile {
  Forest forest;
  std::size_t cells = 0;  ///< along the longer side of the training worlds
  std::string description;
};

/// Returns the bytes of a file, the same on every machine.
std::string model_bytes(const ModelKind& kind, const Forest& forest, std::size_t cells, const std::string& description);
/// \throws Error for a file that is missing, no model, of another kind, damaged, or of another version.
ModelFile read_model(const ModelKind& kind, const std::string& file);

/// Returns the model in a file as of this process's first call; nullptr where there is no such file.
/// \throws Error as M::load does.
template <class M>
std::shared_ptr<const M> known_model_of(const std::string& file) {
  static std::mutex mutex;
  static std::map<std::string, std::shared_ptr<const M>> known;
  std::error_code ignored;
  const std::string key = std::filesystem::absolute(file, ignored).lexically_normal().string();
  const std::scoped_lock lock(mutex);
  const auto found = known.find(key);
  if (found != known.end()) return found->second;
  if (!std::filesystem::exists(file, ignored)) return nullptr;
  return known.emplace(key, std::make_shared<const M>(M::load(file))).first->second;
}

}  // namespace trellis
