// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include <trellis/guide/claims.hpp>

namespace trellis {

/// An operator or function that combines guides into a guide.
struct Combinator {
  std::string name;     ///< "mixture"
  std::string written;  ///< "0.7*a + 0.3*b"
  std::string summary;  ///< one line
  std::string source;
  GuideClaims claims;
};

/// All combinators, in the order of the catalogue.
const std::vector<Combinator>& combinators();

}  // namespace trellis
