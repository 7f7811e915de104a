// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <dsl/language/session.hpp>
#include <trellis/base/configurations.hpp>
#include <trellis/measure/target.hpp>
#include <trellis/space/space.hpp>

namespace trellis::command {

/// What `trellis measure` is asked: samples, the space that they lie in, and the path that they are measured against.
struct Case {
  std::string file;  ///< as typed
  Space space;
  Configurations path;
  std::vector<std::size_t> position;  ///< axes of the position, for the planar distance
  TubeSettings tube;
  std::string samples;  ///< the CSV file
  std::string free;     ///< what decides validity, as the file has it; "" without
  Target::Valid valid;  ///< empty without
  std::uint64_t seed = 1;
};

/// Reads a case (docs/formats.md), `scripts` for one that decides validity. Files that it names are found from its
/// folder; the samples are not read yet. Throws Error that names the file and the key for anything malformed.
Case read_case(const std::string& file, const dsl::SessionOptions& scripts);

}  // namespace trellis::command
