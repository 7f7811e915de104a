// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace trellis::dsl {

/// The words that may follow a piece of script.
struct Completions {
  std::size_t begin = 0;           ///< start of the text that they replace; it extends to the end
  std::vector<std::string> words;  ///< sorted, without duplicates; each begins with the text from `begin`
  bool options = false;            ///< they are options of a table, followed by "="
};

/// Returns the words that may follow `text`, from the registry: names of globals; after "scenes." the fields of a
/// module; after "strategy:" its methods; inside "rrt { " the options that are not set yet, and after their "=" the
/// possible values; in the string after "help" or "require", words or modules. Returns none inside comments and other
/// strings, and after names that are not in the registry.
/// \param names  further names of globals, such as those of a session
Completions completions(std::string_view text, std::span<const std::string> names = {});

}  // namespace trellis::dsl
