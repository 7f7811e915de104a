// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace trellis::dsl {

/// What can follow a piece of script.
struct Completions {
  std::size_t begin = 0;           ///< where what they replace begins: they stand for the text from there to its end
  std::vector<std::string> words;  ///< sorted, each once; each begins with the text from `begin`
  bool options = false;            ///< they are options of a table, behind which a sign of equality comes
};

/// The words that can follow `text`, from the registry: names of globals; after "scenes." the fields of a module; after
/// "strategy:" what can be asked of one; inside "rrt { " the options that are not given yet, and after their "=" the
/// values that are known; in the string after "help" or "require" words or modules. Nothing inside comments and other
/// strings, and after names that the registry does not know.
/// \param names  further names of globals, such as those that a session made
Completions completions(std::string_view text, std::span<const std::string> names = {});

}  // namespace trellis::dsl
