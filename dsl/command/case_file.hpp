// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <dsl/language/tools/session.hpp>
#include <trellis/base/configurations.hpp>
#include <trellis/measure/target.hpp>
#include <trellis/space/space.hpp>

namespace trellis::command {

/// The input of `trellis measure`: samples, their space, and the reference path.
struct Case {
  std::string file;  ///< as typed; the caller's name of a case without a file
  Space space;
  std::vector<std::string> coordinates;  ///< names of the columns
  Configurations path;
  std::vector<std::size_t> position;  ///< axes of the position, for the planar distance
  TubeSettings tube;
  std::string samples;  ///< the CSV file; of a case without a file their name in messages
  std::string free;     ///< the entry that decides validity, as in the file; "" without
  Target::Valid valid;  ///< empty without
  std::uint64_t seed = 1;
};

/// Brings the quaternions of a configuration, which files hold with few decimals, to norm 1. \return false, and no
/// change, where a norm differs from 1 by more than 1 %
bool normalise_rotations(const Space& space, MutableView q);

/// Reads a case (docs/formats.md); `scripts` are the options of a script that decides validity. Paths in the file are
/// relative to its folder. Does not read the samples yet.
/// \throws Error that names the file and the key for malformed content.
Case read_case(const std::string& file, const dsl::SessionOptions& scripts);

/// The same for a case that is no file, and whose samples are none: it has no key `samples`.
/// \param text    a JSON object
/// \param name    the case in messages
/// \param folder  paths in the case are relative to it
Case read_case_text(const std::string& text, const std::string& name, const std::string& folder,
                    const dsl::SessionOptions& scripts);

}  // namespace trellis::command
