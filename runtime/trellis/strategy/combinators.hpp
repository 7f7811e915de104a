// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include <trellis/guide/claims.hpp>

namespace trellis {

/// A way of making a guide of guides.
struct Combinator {
  std::string name;     ///< "mixture"
  std::string written;  ///< "0.7*a + 0.3*b"
  std::string source;
  GuideClaims claims;
};

/// All of them, in the order of the catalogue.
const std::vector<Combinator>& combinators();

}  // namespace trellis
