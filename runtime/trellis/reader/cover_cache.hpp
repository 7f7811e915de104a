// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>

#include <trellis/scene/spatial/manipulator_scene.hpp>

namespace trellis {

/// Covers of links in files, so that a robot is covered once. A cover is the same with and without it.
///
/// The name of a file is a hash of shapes, options and the version of the method. Files are written under another name
/// and renamed, so that programs may share the folder. A damaged file is ignored and written anew. Where the folder
/// cannot be written, nothing is stored.
class CoverCache {
 public:
  /// The size of all files beyond which the oldest ones are removed.
  static constexpr std::uintmax_t most_bytes = 256U << 20U;

  /// \param folder  none: covers are made each time
  explicit CoverCache(std::optional<std::filesystem::path> folder) : folder_(std::move(folder)) {}

  /// Returns `medial_cover(solids, options)`.
  [[nodiscard]] MedialCover cover(std::span<const Solid> solids, const CoverOptions& options) const;
  /// Returns `link_covers(tree, options)`. Links with the same shapes are covered once.
  [[nodiscard]] LinkCovers covers(const KinematicTree& tree, const CoverOptions& options) const;

  /// Removes the oldest files where all have more than `most` bytes.
  void trim(std::uintmax_t most = most_bytes) const;

 private:
  std::optional<std::filesystem::path> folder_;
};

/// The folder of the user's covers: trellis/covers in XDG_CACHE_HOME, or in .cache in HOME. None without either, and
/// where TRELLIS_NO_CACHE is set to something other than 0.
std::optional<std::filesystem::path> user_cover_folder();

}  // namespace trellis
