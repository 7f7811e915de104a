// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <trellis/guide/claims.hpp>

namespace trellis::dsl {

/// The guides and what each claims of itself, a page in Markdown. What is committed of it is made by scripts/reference.
std::string catalogue_markdown();

/// The claims of one guide, in lines for a terminal, each with its title.
std::vector<std::pair<std::string, std::string>> claim_lines(const GuideClaims& claims);

}  // namespace trellis::dsl
