// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <trellis/guide/claims.hpp>

namespace trellis::dsl {

/// Returns the page of guides and their claims, in Markdown. scripts/reference writes the committed copy.
std::string catalogue_markdown();

/// The claims of one guide, in lines for a terminal, each with its title.
std::vector<std::pair<std::string, std::string>> claim_lines(const GuideClaims& claims);

}  // namespace trellis::dsl
